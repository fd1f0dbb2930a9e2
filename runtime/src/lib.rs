//! tmp
pub mod decode; pub mod directions; pub mod encode; pub mod error; pub mod format; pub mod tables; pub mod tree;
pub use decode::*; pub use directions::DirectionSet; pub use error::*; pub use tree::*; pub use tables::*;
