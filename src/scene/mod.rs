//! What is baked: the objects of one glTF scene, their geometry, and the node tree above them.

pub(crate) mod accessors;
pub(crate) mod alpha_mask;
mod animation;
mod bounds;
mod error;
mod instancing;
pub(crate) mod json;
pub(crate) mod materials;
mod meshes;
mod nodes;
pub(crate) mod notes;
pub(crate) mod outline;
pub(crate) mod pixels;
pub(crate) mod places;
pub(crate) mod primitives;
pub mod read;
mod shared;
mod surfaces;
#[cfg(test)]
mod tests;
mod transform;
pub(crate) mod triangulate;
mod vertices;

pub use error::SceneError;
pub use read::{MaskMode, ReadOptions, read_scene};

use glam::{DAffine3, DVec3, Vec2, Vec3};
use std::ops::Range;
use std::sync::Arc;

/// Everything of one glTF scene that the bake needs.
#[derive(Debug, Default)]
pub struct Scene {
    /// Index of the glTF scene; `None` for a file without scenes, whose nodes are then read as one.
    pub index: Option<usize>,
    /// Distinct meshes in use, each one once however often it is drawn.
    pub meshes: Vec<Mesh>,
    /// Every mesh-bearing node the scene reaches (one entry per instance of `EXT_mesh_gpu_instancing`),
    /// in depth-first document order.
    pub objects: Vec<Object>,
    /// The nodes the scene reaches, depth-first; parents come before children.
    pub nodes: Vec<SceneNode>,
    /// Counted notes on what was not understood or was repaired, for the report.
    pub notes: Vec<Note>,
}

/// One drawable: a mesh node, the unit of culling.
#[derive(Clone, Debug)]
pub struct Object {
    /// Index of the glTF node.
    pub node: usize,
    /// Instance of `EXT_mesh_gpu_instancing`, if the node has that extension.
    pub instance: Option<u32>,
    /// Index into [`Scene::meshes`].
    pub mesh: u32,
    /// Index into [`Scene::nodes`].
    pub scene_node: u32,
    /// Mesh space to world space, metres. The identity where the file's transform is not finite
    /// ([`Role::Excluded`] then).
    pub to_world: DAffine3,
    /// How the object takes part in the bake.
    pub role: Role,
    /// Not to be drawn: hidden (`KHR_node_visibility`), or its transform is not finite.
    pub hidden: bool,
}

/// How an object takes part in the bake.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Role {
    /// Stands still relative to its anchor: occludes and is culled.
    Static,
    /// Deforms (skin, morph targets) or has no usable transform or geometry: never baked, always drawn.
    Excluded,
}

/// A node the scene reaches.
#[derive(Clone, Debug)]
pub struct SceneNode {
    /// Index of the glTF node.
    pub node: usize,
    /// Index into [`Scene::nodes`]; `None` for a root of the scene.
    pub parent: Option<u32>,
    /// Node space to world space; the identity where the file's transform is not finite.
    pub to_world: DAffine3,
    /// An animation moves this very node: what is below it is a tree of its own.
    pub moving: bool,
    /// One past the last node of this node's subtree, in [`Scene::nodes`].
    pub subtree_end: u32,
    /// The objects of this node's subtree, in [`Scene::objects`].
    pub objects: Range<u32>,
}

/// Something counted while reading, for the report: "3 primitives are lines or points".
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Stable code, upper snake case.
    pub code: &'static str,
    /// How often.
    pub count: usize,
    /// Sentence for people, without the count.
    pub message: String,
    /// JSON pointer of the first occurrence.
    pub pointer: String,
}

/// The triangles of one glTF mesh, all primitives together, in mesh space.
#[derive(Debug, Default)]
pub struct Mesh {
    /// Finite vertex positions, relative to [`Mesh::origin`] so that far-away coordinates keep their precision.
    pub positions: Vec<Vec3>,
    /// Mesh-space position that `positions` are relative to (the centre of the mesh's box).
    pub origin: DVec3,
    /// Triangles with three distinct, finite corners and a non-zero area, grouped by surface.
    pub triangles: Vec<[u32; 3]>,
    /// Texture coordinates per vertex for surfaces with an alpha texture, else empty.
    pub uvs: Vec<Vec2>,
    /// What the triangles are made of: consecutive ranges that cover `triangles`.
    pub surfaces: Vec<Surface>,
    /// Triangles a renderer is asked to draw for this mesh, degenerate ones included.
    pub drawn_triangles: u32,
    /// Bytes of this mesh's vertex and index data in the file.
    pub bytes: u64,
    /// Box of the mesh in mesh space as a loader sees it: union of the primitives' POSITION `min`/`max`
    /// (of the finite positions if those are wrong or missing). Empty meshes have `min > max`.
    pub min: DVec3,
    /// See `min`.
    pub max: DVec3,
}

/// A range of a mesh's triangles with one material behaviour.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Range in [`Mesh::triangles`].
    pub triangles: Range<u32>,
    /// Both sides are drawn.
    pub double_sided: bool,
    /// How it hides what is behind it.
    pub opacity: Opacity,
}

/// How a surface hides what is behind it.
#[derive(Clone, Debug)]
pub enum Opacity {
    /// Hides.
    Opaque,
    /// Blended or transmitting: seen, but hides nothing.
    Transparent,
    /// Hides, and is seen, only where its texture's alpha passes.
    Mask(Arc<AlphaMask>),
}

/// Where a MASK material's texture is there: one bit per texel.
#[derive(Debug)]
pub struct AlphaMask {
    /// Texels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Row-major, `true` where alpha passes the cutoff.
    pub passes: Vec<bool>,
    /// glTF wrap modes of the sampler (10497 repeat, 33071 clamp, 33648 mirror).
    pub wrap: [u32; 2],
}

impl Mesh {
    /// No triangle can be hit.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }
}

impl AlphaMask {
    /// Whether the texel at a texture coordinate passes (nearest texel, glTF's origin at the upper left).
    /// An empty mask always passes.
    pub fn passes_at(&self, uv: Vec2) -> bool {
        let wrap = |x: f32, size: u32, mode: u32| -> u32 {
            let x = if x.is_finite() { x } else { 0.0 };
            let unit = match mode {
                33071 => x.clamp(0.0, 1.0),
                33648 => 1.0 - (x.rem_euclid(2.0) - 1.0).abs(),
                _ => x.rem_euclid(1.0),
            };
            ((unit * size as f32) as u32).min(size.saturating_sub(1))
        };
        let x = wrap(uv.x, self.width, self.wrap[0]);
        let y = wrap(uv.y, self.height, self.wrap[1]);
        self.passes.get(y as usize * self.width as usize + x as usize).copied().unwrap_or(true)
    }
}
