//! The geometry of proxies: pure functions over plain data, no glTF.
//!
//! [`simplify_node`] makes the stand-in of a group of objects: gather → visible only → weld → simplify → measure.
//! [`simplify_mesh_levels`] makes a chain of simplified versions of one mesh. Lengths are metres, positions are relative
//! to an origin near the geometry. Results do not depend on the number of threads.

mod class;
mod fidelity;
mod gather;
mod levels;
mod likeness;
mod measure;
mod node;
mod palette;
mod reduce;
mod sequence;
mod soup;
#[cfg(test)]
mod tests;
mod texture;
mod tree;
mod visible;
mod weld;

pub use class::{Class, ClassMesh, PlainClass};
pub use fidelity::Fidelity;
pub use gather::Part;
pub use levels::{LevelOptions, MeshLevel, simplify_mesh_levels};
pub use measure::{Deviation, Surface, measure};
pub use node::{NodeOptions, ProxyGeometry, simplify_node};
pub use palette::Palette;
pub use reduce::Strategy;
