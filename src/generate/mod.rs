//! Sample scenes: deterministic generators of glTF files.
//!
//! `plant`, `city` and `cubes` are the scenes the method was measured on, `boxes` and `shells` have exactly known
//! visible sets. The same options give the same bytes on every machine: random numbers are integers (SplitMix64),
//! sine, cosine and logarithm are computed with `+ - * /` only, and every stream of random numbers belongs to one
//! machine, lot or run of pipes. Lengths are metres, y is up.
//!
//! [`grid`] repeats a real scene instead.

mod assembly;
mod boxes;
mod builder;
mod city;
mod cubes;
mod grid;
mod paint;
mod plant;
mod portable;
mod random;
mod sample;
mod shape;
mod shells;

#[cfg(test)]
mod tests;

pub use grid::{GridError, GridOptions, GridReport, grid};
pub use sample::Sample;
pub use shells::{ShellOptions, shells};

/// Which sample scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, clap::ValueEnum)]
#[non_exhaustive]
pub enum SampleKind {
    /// A factory hall full of machines in housings, sub-assemblies and parts, pipes, crates and handrails:
    /// hides much, deeply nested, many identical subtrees.
    Plant,
    /// Buildings with open windows and furnished interiors.
    City,
    /// Unit cubes with normally distributed centres, as in the dissertation: 1,000 cubes, standard deviation 5 m.
    Cubes,
    /// A row of 512 unit boxes along x in binary nested groups: from -x each group shows its first box only.
    Boxes,
    /// Closed boxes inside one another, each with a group of its own: nothing inside is seen from outside.
    Shells,
}

impl SampleKind {
    /// All kinds.
    pub const ALL: [SampleKind; 5] =
        [SampleKind::Plant, SampleKind::City, SampleKind::Cubes, SampleKind::Boxes, SampleKind::Shells];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            SampleKind::Plant => "plant",
            SampleKind::City => "city",
            SampleKind::Cubes => "cubes",
            SampleKind::Boxes => "boxes",
            SampleKind::Shells => "shells",
        }
    }
}

/// What to generate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleOptions {
    /// Which scene.
    pub kind: SampleKind,
    /// Size relative to the default of 1; the number of objects grows about linearly with it. A scale near 0
    /// gives one machine, one lot, one cube, two boxes or one shell.
    ///
    /// Allowed: above 0, at most [`SampleOptions::MAX_SCALE`]; see [`SampleOptions::check`].
    pub scale: f64,
    /// Seed of the random numbers. `boxes` and `shells` use none.
    pub seed: u64,
}

impl SampleOptions {
    /// The largest [`SampleOptions::scale`]: about a million objects of `city`, 270,000 of `plant`.
    pub const MAX_SCALE: f64 = 64.0;

    /// Default size with the seed 7.
    pub fn new(kind: SampleKind) -> Self {
        SampleOptions { kind, scale: 1.0, seed: 7 }
    }

    /// Whether the options are in range.
    ///
    /// # Errors
    /// [`ScaleError`] if the scale is not a number above 0 and at most [`SampleOptions::MAX_SCALE`].
    pub fn check(&self) -> Result<(), ScaleError> {
        let allowed = self.scale > 0.0 && self.scale <= Self::MAX_SCALE;
        if allowed { Ok(()) } else { Err(ScaleError { scale: self.scale }) }
    }

    /// `at_one` things at scale 1, at least `least`; out-of-range scales are clamped, NaN counts as the least.
    fn count(&self, at_one: usize, least: usize) -> usize {
        let scale = self.scale.clamp(0.0, Self::MAX_SCALE);
        ((at_one as f64 * scale).round() as usize).max(least)
    }
}

/// A scale that no sample is made at.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("--scale {scale} is out of range: use a number above 0, at most {}", SampleOptions::MAX_SCALE)]
pub struct ScaleError {
    /// The scale asked for.
    pub scale: f64,
}

/// Makes a sample scene. The same options give the same bytes on every machine.
///
/// A scale outside the range of [`SampleOptions::check`] is clamped to it. Memory and time grow with the number
/// of objects (about 1 kB each while the document is built); triangles are shared between instances.
pub fn generate(options: &SampleOptions) -> Sample {
    match options.kind {
        SampleKind::Plant => plant::plant(options),
        SampleKind::City => city::city(options),
        SampleKind::Cubes => cubes::cubes(options),
        SampleKind::Boxes => boxes::boxes(options.count(512, 2)),
        SampleKind::Shells => shells(&ShellOptions { depth: options.count(3, 1), hole: false }),
    }
}
