//! Bakes direction-dependent visibility into glTF scenes.
//!
//! A bake finds, for groups of objects and a set of directions, which objects are visible from outside the group, and
//! stores it in the glTF extension `EXT_spherical_visibility`. A viewer can then skip what cannot be seen without any
//! occlusion query; the crate `svs-runtime` answers, per camera, what to draw. The method goes back to Spherical
//! Visibility Sampling (Benjamin Eikel, dissertation, Paderborn 2013).
//!
//! ```no_run
//! use svs::bake::{self, BakeOptions, Silent};
//! use svs::gltf::Document;
//!
//! let mut document = Document::read("plant.glb".as_ref())?;
//! let report = bake::build(&mut document, &BakeOptions::default(), &Silent)?;
//! document.write("plant.svs.glb".as_ref())?;
//! println!("{} bytes added", report.bytes_added);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The stages, in the order in which they run:
//!
//! - [`gltf`] reads and writes files without losing anything of them, and attaches what is baked.
//! - [`scene`] finds the objects, their geometry and the nodes above them.
//! - [`hidden`] drops, if asked to, what no camera can ever see.
//! - [`bake`] groups the objects, samples their visibility with rays, drops what does not pay and encodes the rest.
//! - [`proxies`] makes simplified stand-ins for groups of objects, if they are asked for.
//! - [`verify`] measures the result on cameras that the bake has not seen, beside the published method.
//! - [`validate`] checks a file against the extension's schema and its scene.
//! - [`generate`] makes the sample scenes.
//! - [`camera_path`] is where a camera goes.
//! - [`appearance`] reads how a scene looks.
//! - With the feature `render`, `stage` opens a file for drawing, and `view` shows it
//!   in a window.

pub mod appearance;
pub mod bake;
mod baked;
pub mod camera_path;
#[cfg(feature = "render")]
pub mod evaluate;
pub mod generate;
pub mod gltf;
pub mod hidden;
pub mod proxies;
pub mod scene;
#[cfg(feature = "render")]
pub mod stage;
pub mod validate;
pub mod verify;
#[cfg(feature = "render")]
pub mod view;
