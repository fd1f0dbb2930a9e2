//! Loading a file bit by bit, what matters most for the present view first.
//!
//! [`Loader`] decides which bytes are fetched next and does nothing else: whoever has a network asks it what it wants and
//! tells it what has come. First come the header and the JSON, then the tables of the baked visibility and the proxies'
//! meshes, then meshes in the order of [`priorities`].
//!
//! Any GLB can be loaded so. [`arrange`] makes it fast: it moves the bytes in the BIN chunk into the order in which they are
//! wanted, and puts a compressed copy of the JSON before them, for JSON is a third of a file with many small objects and is
//! needed first. To every other loader such a file is an ordinary one.

#[cfg(feature = "bake")]
mod arrange;
mod error;
mod head;
mod index;
mod loader;
mod priority;
mod ranges;
#[cfg(all(test, feature = "render"))]
mod tests;

#[cfg(feature = "bake")]
pub use arrange::{Arranged, arrange, restore};
pub use error::StreamError;
pub use head::Head;
pub use loader::{Loader, Ready};
pub use priority::priorities;
