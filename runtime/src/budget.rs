//! How much may be drawn, and what was chosen.

use crate::cost::CostModel;

/// How much may be drawn in one frame.
#[derive(Clone, Copy, Debug, Default)]
#[non_exhaustive]
pub enum Budget<'a> {
    /// Everything that culling answers.
    #[default]
    Unlimited,
    /// At most this many triangles.
    Triangles(u64),
    /// At most this many milliseconds, as predicted by the model. If the model's base cost alone is more, nothing
    /// fits; feed it with [`CostModel::record`] after each frame.
    Milliseconds(f64, &'a CostModel),
    /// At most this many triangles, chosen as published (Eikel, *Spherical Visibility Sampling*, 2013): in order of
    /// pixels per triangle up to the first object that does not fit, without hysteresis. For comparison:
    /// [`Self::Triangles`] never gets less out of the same budget.
    StopAtFirstMisfit(u64),
}

/// What a frame was chosen from, see [`crate::SceneCuller::selection`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Selection {
    /// Objects that culling answered.
    pub candidates: usize,
    /// Their triangles.
    pub candidate_triangles: u64,
    /// Objects chosen.
    pub chosen: usize,
    /// Their triangles.
    pub chosen_triangles: u64,
    /// Estimated visible pixels of everything dropped for its size (see [`crate::Tau`]) or for the budget. Objects that
    /// overlap in the image count each, so the sum can exceed the image.
    pub dropped_pixels: f64,
}

/// What is drawn in sum.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Load {
    pub(crate) triangles: u64,
    pub(crate) draws: u64,
}

impl Load {
    pub(crate) fn plus(self, triangles: u32) -> Self {
        Self { triangles: self.triangles + u64::from(triangles), draws: self.draws + 1 }
    }
}

/// A budget as the selection wants it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Capacity<'a> {
    Triangles(u64),
    Milliseconds(f64, &'a CostModel),
}

/// A budget without the model it came with: to compare it with another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Price {
    Triangles(u64),
    /// And what things cost.
    Milliseconds(f64, [f64; 3]),
}

impl Capacity<'_> {
    pub(crate) fn price(&self) -> Price {
        match self {
            Self::Triangles(most) => Price::Triangles(*most),
            Self::Milliseconds(most, model) => Price::Milliseconds(*most, model.coefficients()),
        }
    }

    pub(crate) fn fits(&self, load: Load) -> bool {
        match self {
            Self::Triangles(most) => load.triangles <= *most,
            Self::Milliseconds(most, model) => model.predict(load.triangles, load.draws) <= *most,
        }
    }

    /// What one object costs.
    pub(crate) fn weight(&self, triangles: u32) -> f64 {
        match self {
            Self::Triangles(_) => f64::from(triangles),
            Self::Milliseconds(_, model) => model.predict_object(triangles),
        }
    }

    /// What so many more triangles and draws cost; negative if they cost less.
    pub(crate) fn difference(&self, triangles: i64, draws: i64) -> f64 {
        match self {
            Self::Triangles(_) => triangles as f64,
            Self::Milliseconds(_, model) => model.predict_difference(triangles, draws),
        }
    }

    /// A part of the budget less.
    pub(crate) fn less(self, part: f64) -> Self {
        match self {
            Self::Triangles(most) => Self::Triangles(most.saturating_sub((most as f64 * part) as u64)),
            Self::Milliseconds(most, model) => Self::Milliseconds(most - most.abs() * part, model),
        }
    }

    /// What is left after `load`, which fits.
    pub(crate) fn left(&self, load: Load) -> f64 {
        match self {
            Self::Triangles(most) => most.saturating_sub(load.triangles) as f64,
            Self::Milliseconds(most, model) => (most - model.predict(load.triangles, load.draws)).max(0.0),
        }
    }
}
