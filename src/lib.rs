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
//! - With the feature `stage`, `stage` opens a file for drawing; with `render`, `view` shows it in a window.
//!
//! Without the feature `bake` only what reads and draws is there, and it compiles to WebAssembly.

// What only the bake needs of the modules it shares with the readers.
#![cfg_attr(not(feature = "bake"), allow(dead_code, unreachable_pub, reason = "for the bake"))]

pub mod appearance;
#[cfg(feature = "bake")]
pub mod bake;
#[cfg(any(feature = "bake", feature = "stage"))]
mod baked;
#[cfg(feature = "bake")]
pub mod camera_path;
#[cfg(feature = "render")]
pub mod evaluate;
#[cfg(feature = "bake")]
pub mod generate;
pub mod gltf;
#[cfg(feature = "bake")]
pub mod hidden;
mod parallel;
#[cfg(feature = "bake")]
pub mod proxies;
#[cfg(feature = "stage")]
pub mod rig;
pub mod scene;
#[cfg(feature = "bake")]
pub mod serve;
#[cfg(feature = "stage")]
pub mod stage;
#[cfg(feature = "stage")]
pub mod stream;
#[cfg(feature = "bake")]
pub mod validate;
#[cfg(feature = "bake")]
pub mod verify;
#[cfg(feature = "render")]
pub mod view;
pub mod volume;
