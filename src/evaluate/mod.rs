//! Evaluate.

mod figures;
mod machine;
pub mod metrics;
mod options;
mod report;
mod result;

pub use figures::{Figures, Likeness};
pub use machine::Machine;
pub use options::{EvaluateOptions, EvaluationMethod, FrameBudget, OptionError, Tour};
pub use report::{REPORT_FILES, ReportError};
pub use result::*;
