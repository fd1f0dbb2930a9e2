//! What to measure.

use super::method::EvaluationMethod;
use crate::camera_path::CameraPath;
use std::fmt;
use std::str::FromStr;
use svs_runtime::Detail;

/// How much a frame may draw or take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FrameBudget {
    /// Triangles.
    Triangles(u64),
    /// Share, 0 to 1, of the triangles that the same frame has with [`EvaluationMethod::Visibility`].
    Share(f64),
    /// Milliseconds, above 0, by the runtime's cost model.
    Milliseconds(f64),
}

impl FromStr for FrameBudget {
    type Err = OptionError;

    /// `200000`, `10%` or `8ms`.
    fn from_str(text: &str) -> Result<Self, OptionError> {
        let wrong = || OptionError::Budget(text.to_owned());
        let number = |digits: &str| digits.trim().parse::<f64>().ok().filter(|x| x.is_finite() && *x > 0.0);
        if let Some(share) = text.strip_suffix('%') {
            let share = number(share).filter(|&share| share <= 100.0).ok_or_else(wrong)?;
            return Ok(Self::Share(share / 100.0));
        }
        if let Some(milliseconds) = text.strip_suffix("ms") {
            return number(milliseconds).map(Self::Milliseconds).ok_or_else(wrong);
        }
        text.trim().parse().map(Self::Triangles).map_err(|_| wrong())
    }
}

impl fmt::Display for FrameBudget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Triangles(1) => write!(f, "1 triangle a frame"),
            Self::Triangles(most) => write!(f, "{most} triangles a frame"),
            // 0.07 * 100 is not 7.
            Self::Share(share) => {
                let percent = (share * 100.0 * 1e9).round() / 1e9;
                write!(f, "{percent} % of each frame's triangles with method visibility")
            }
            Self::Milliseconds(most) => write!(f, "{most} ms a frame"),
        }
    }
}

/// Which generated camera paths to fly where none is given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tour {
    /// A round trip about the scene.
    Outside,
    /// A walk through it.
    Inside,
    /// Outside and inside, one after the other.
    #[default]
    Both,
    /// Turns about the scene, from overview to close-up and back.
    Inspection,
}

/// What to measure. The default is what `svs evaluate` does.
#[derive(Clone, Debug, PartialEq)]
pub struct EvaluateOptions {
    /// Camera paths to fly; none: those of `tour`.
    pub paths: Vec<CameraPath>,
    /// Generated paths, where `paths` is empty.
    pub tour: Tour,
    /// Methods, in the order of the report.
    pub methods: Vec<EvaluationMethod>,
    /// Quality of the visibility query, 0 to 1; `None`: as the file recommends, else the runtime's default.
    pub quality: Option<f32>,
    /// For the methods with a budget, and for those that draw proxies.
    pub budget: Option<FrameBudget>,
    /// For the methods that draw proxies.
    pub detail: Detail,
    /// Whose pictures the others are compared with. Missing objects and holes are always those of
    /// [`EvaluationMethod::Frustum`].
    pub reference: EvaluationMethod,
    /// Frames of each path.
    pub frames: usize,
    /// How often each frame is timed with each method.
    pub passes: usize,
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Default for EvaluateOptions {
    fn default() -> Self {
        Self {
            paths: Vec::new(),
            tour: Tour::Both,
            methods: vec![EvaluationMethod::Frustum, EvaluationMethod::Visibility, EvaluationMethod::Exact],
            quality: None,
            budget: None,
            detail: Detail::default(),
            reference: EvaluationMethod::Frustum,
            frames: 48,
            passes: 3,
            width: 1280,
            height: 720,
        }
    }
}

/// Smallest picture: room for one window of the similarity.
const LEAST_SIZE: u32 = 16;
/// Largest picture, pixels a side.
const MOST_SIZE: u32 = 8192;
/// Most frames of a path.
const MOST_FRAMES: usize = 100_000;
/// Most passes.
const MOST_PASSES: usize = 1000;

impl EvaluateOptions {
    /// A method keeps within the budget.
    pub fn limits(&self, method: EvaluationMethod) -> bool {
        self.budget.is_some() && (method.is_budgeted() || method.draws_proxies().is_some())
    }

    /// Whether they make sense together.
    ///
    /// # Errors
    /// See [`OptionError`].
    pub fn check(&self) -> Result<(), OptionError> {
        if self.methods.is_empty() {
            return Err(OptionError::NoMethod);
        }
        for (place, &method) in self.methods.iter().enumerate() {
            if self.methods[..place].contains(&method) {
                return Err(OptionError::Twice(method));
            }
            match self.budget {
                None if method.is_budgeted() => return Err(OptionError::NoBudget(method)),
                Some(FrameBudget::Milliseconds(_)) if method == EvaluationMethod::FirstMisfit => {
                    return Err(OptionError::MisfitMilliseconds);
                }
                _ => {}
            }
        }
        let range = |what, value: u64, least: u64, most: u64| {
            let inside = (least..=most).contains(&value);
            if inside { Ok(()) } else { Err(OptionError::Range { what, value, least, most }) }
        };
        range("frames", self.frames as u64, 1, MOST_FRAMES as u64)?;
        range("passes", self.passes as u64, 1, MOST_PASSES as u64)?;
        for side in [self.width, self.height] {
            range("pixels a side", side.into(), LEAST_SIZE.into(), MOST_SIZE.into())?;
        }
        if !(self.detail.tau.is_finite() && self.detail.tau >= 0.0) {
            return Err(OptionError::Detail);
        }
        if self.reference.is_budgeted() && self.budget.is_none() {
            return Err(OptionError::NoBudget(self.reference));
        }
        match self.quality {
            Some(quality) if !(0.0..=1.0).contains(&quality) => Err(OptionError::Quality),
            _ => Ok(()),
        }
    }
}

/// Options that make no sense.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum OptionError {
    /// No such method.
    #[error(
        "there is no method {0:?}; there are nothing, frustum, visibility, exact, budget, first-misfit, proxies, proxies-sse, \
         proxies-linear and proxies-frustum"
    )]
    Method(String),
    /// No method at all.
    #[error("at least one method is needed")]
    NoMethod,
    /// A method is named twice.
    #[error("method {0} is named twice")]
    Twice(EvaluationMethod),
    /// No such budget.
    #[error("{0:?} is no budget; write a number of triangles (200000), a share (10%) or milliseconds (8ms)")]
    Budget(String),
    /// A method with a budget, without one.
    #[error("method {0} needs --budget")]
    NoBudget(EvaluationMethod),
    /// The published rule knows no milliseconds.
    #[error("method first-misfit needs a budget in triangles or percent, not in milliseconds")]
    MisfitMilliseconds,
    /// A number out of its range.
    #[error("{value} {what}: a number from {least} to {most} is needed")]
    Range {
        /// What it counts.
        what: &'static str,
        /// The number.
        value: u64,
        /// Smallest allowed.
        least: u64,
        /// Largest allowed.
        most: u64,
    },
    /// Quality is out of its range.
    #[error("the quality must be a number from 0 to 1")]
    Quality,
    /// The error in pixels is none.
    #[error("the error in pixels must be a finite number, 0 or more")]
    Detail,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_budgets_are_read() {
        for method in EvaluationMethod::ALL {
            assert_eq!(method.to_string().parse(), Ok(method));
        }
        assert!("Frustum".parse::<EvaluationMethod>().is_err());
        assert_eq!("200000".parse(), Ok(FrameBudget::Triangles(200_000)));
        assert_eq!("10%".parse(), Ok(FrameBudget::Share(0.1)));
        assert_eq!("2.5 %".parse(), Ok(FrameBudget::Share(0.025)));
        assert_eq!("8ms".parse(), Ok(FrameBudget::Milliseconds(8.0)));
        for wrong in ["", "-1", "0%", "101%", "ms", "0ms", "-2ms", "nan%", "infms", "1e9x", "1.5"] {
            assert!(wrong.parse::<FrameBudget>().is_err(), "{wrong}");
        }
        let text = FrameBudget::Share(0.07).to_string();
        assert!(text.starts_with("7 %"), "{text}");
    }

    #[test]
    fn options_are_checked() {
        let good = EvaluateOptions::default();
        assert_eq!(good.check(), Ok(()));
        let with = |change: &dyn Fn(&mut EvaluateOptions)| {
            let mut options = good.clone();
            change(&mut options);
            options.check()
        };
        assert!(with(&|o| o.frames = 0).is_err());
        assert!(with(&|o| o.passes = 0).is_err());
        assert!(with(&|o| o.width = 0).is_err());
        assert!(with(&|o| o.height = 10_000).is_err());
        assert!(with(&|o| o.quality = Some(f32::NAN)).is_err());
        assert!(with(&|o| o.detail.tau = f32::NAN).is_err());
        assert!(with(&|o| o.reference = EvaluationMethod::Budget).is_err());
        assert!(with(&|o| o.methods.clear()).is_err());
        assert!(with(&|o| o.methods.push(EvaluationMethod::Frustum)).is_err());
        assert!(with(&|o| o.methods.push(EvaluationMethod::Budget)).is_err());
        let budget = |budget| {
            with(&|o| {
                o.budget = Some(budget);
                o.methods.extend([EvaluationMethod::Budget, EvaluationMethod::FirstMisfit]);
            })
        };
        assert_eq!(budget(FrameBudget::Share(0.1)), Ok(()));
        assert_eq!(budget(FrameBudget::Milliseconds(3.0)), Err(OptionError::MisfitMilliseconds));
    }
}
