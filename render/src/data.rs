//! What is drawn, as plain data: no GPU in here.

use glam::DAffine3;

/// A scene ready to be uploaded. Objects refer to meshes, meshes to materials, materials to images, by index.
#[derive(Clone, Debug, Default)]
pub struct SceneData {
    /// Distinct meshes, each one once however often it is drawn.
    pub meshes: Vec<Mesh>,
    /// Materials in use.
    pub materials: Vec<Material>,
    /// Decoded images.
    pub images: Vec<Image>,
    /// Everything that can be drawn; the unit of culling. The index is the object's id everywhere.
    pub objects: Vec<Object>,
}

/// One object: a mesh at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Object {
    /// Index into [`SceneData::meshes`].
    pub mesh: u32,
    /// Mesh space to world space, metres.
    pub to_world: DAffine3,
}

/// The triangles of one mesh, by material.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Its parts; empty for a mesh of which nothing can be drawn.
    pub primitives: Vec<Primitive>,
}

/// Triangles of one material, in mesh space. All attributes have one entry per position or are empty.
#[derive(Clone, Debug, Default)]
pub struct Primitive {
    /// Finite positions, metres.
    pub positions: Vec<[f32; 3]>,
    /// Unit normals; empty: faces are flat.
    pub normals: Vec<[f32; 3]>,
    /// Linear colours and alpha, 0 to 255 for 0 to 1; empty: white.
    pub colors: Vec<[u8; 4]>,
    /// Texture coordinates of the base colour, its `KHR_texture_transform` applied; empty: no texture.
    pub uvs: Vec<[f32; 2]>,
    /// Triangles, three indices each, all in range.
    pub indices: Vec<u32>,
    /// Index into [`SceneData::materials`].
    pub material: u32,
}

/// How light meets a surface (glTF 2.0 metallic-roughness).
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Linear base colour and alpha, 0 to 1.
    pub base_color: [f32; 4],
    /// 0 (dielectric) to 1 (metal).
    pub metallic: f32,
    /// 0 (mirror) to 1.
    pub roughness: f32,
    /// Linear emitted colour.
    pub emissive: [f32; 3],
    /// What alpha means.
    pub alpha: AlphaMode,
    /// Both sides are drawn.
    pub double_sided: bool,
    /// `KHR_materials_unlit`: the base colour is shown as it is.
    pub unlit: bool,
    /// sRGB colours that multiply the base colour.
    pub base_color_texture: Option<TextureRef>,
    /// Linear; green multiplies roughness and blue metallic. Same texture coordinates as the base colour.
    pub metallic_roughness_texture: Option<TextureRef>,
    /// sRGB colours that multiply the emissive colour. Same texture coordinates as the base colour.
    pub emissive_texture: Option<TextureRef>,
}

impl Default for Material {
    /// glTF's defaults.
    fn default() -> Self {
        Self {
            base_color: [1.0; 4],
            metallic: 1.0,
            roughness: 1.0,
            emissive: [0.0; 3],
            alpha: AlphaMode::Opaque,
            double_sided: false,
            unlit: false,
            base_color_texture: None,
            metallic_roughness_texture: None,
            emissive_texture: None,
        }
    }
}

/// What alpha means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaMode {
    /// Nothing.
    Opaque,
    /// Below this cutoff there is no surface.
    Mask(f32),
    /// How much covers what is behind.
    Blend,
}

/// A use of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TextureRef {
    /// Index into [`SceneData::images`].
    pub image: u32,
    /// How it is looked up.
    pub sampler: Sampler,
}

/// How an image is looked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct Sampler {
    /// Beyond the left and right edges.
    pub wrap_u: Wrap,
    /// Beyond the upper and lower edges.
    pub wrap_v: Wrap,
    /// Between texels, when enlarged.
    pub magnify: Filter,
    /// Between texels, when made smaller.
    pub minify: Filter,
}

/// Beyond the edge of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Wrap {
    /// It starts anew.
    #[default]
    Repeat,
    /// Its edge goes on.
    Clamp,
    /// It goes back.
    Mirror,
}

/// Between texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Filter {
    /// Blends neighbours.
    #[default]
    Linear,
    /// Takes the nearest.
    Nearest,
}

/// A decoded image.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Image {
    /// Texels per row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Rows from the top, four bytes a texel.
    pub rgba: Vec<u8>,
}
