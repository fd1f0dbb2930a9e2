//! From a document to a [`Scene`].

use super::json::array;
use super::notes::Notes;
use super::{Role, Scene, SceneError, animation, materials, meshes, nodes, outline, primitives, transform};
use crate::gltf::Document;
use serde_json::Value;

/// What to read, and how.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// Index of the scene; `None`: the file's default scene, else its first, else, in a file without scenes,
    /// all nodes that are nobody's child.
    pub scene: Option<usize>,
    /// What alpha-tested surfaces hide.
    pub mask: MaskMode,
    /// Reads no vertex: meshes have their boxes (as the file states them) and counts of triangles, but no triangles. Enough
    /// to decide what to draw, before the geometry is there.
    pub outline: bool,
}

/// What surfaces with `alphaMode` MASK and an alpha texture hide.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum MaskMode {
    /// What their texture covers.
    #[default]
    Test,
    /// Nothing.
    Transparent,
}

/// Extensions that may be required without changing what is where: they are read here, or change only how
/// surfaces look.
const KNOWN_REQUIRED: [&str; 27] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_spherical_visibility",
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
];

/// Reads one scene: its node tree, its objects in depth-first document order (a node's own mesh before its
/// children's) and each mesh in use once. What is repaired or left out is counted in [`Scene::notes`].
///
/// # Errors
/// [`SceneError`] names the first fault, in file order, that leaves it open what the scene is: broken
/// references, cycles, compressed geometry, undecodable accessors.
pub fn read_scene(doc: &Document, options: &ReadOptions) -> Result<Scene, SceneError> {
    let mut notes = Notes::default();
    note_unknown_extensions(&doc.json, &mut notes)?;
    let animated = animation::read(&doc.json, &mut notes)?;
    let walk = nodes::walk(doc, options.scene, &animated, &mut notes)?;
    let plan = primitives::plan(doc, &walk.meshes, &mut notes)?;
    let meshes = if options.outline {
        outline::read(doc, &plan)?
    } else {
        let materials = materials::read(doc, &plan.materials, &animated, options.mask, &mut notes)?;
        meshes::read(doc, &plan, &materials, &mut notes)?
    };
    let has_morph_targets: Vec<bool> = plan.meshes.iter().map(|mesh| mesh.has_morph_targets).collect();
    let mut scene =
        Scene { index: walk.scene, meshes, objects: walk.objects, nodes: walk.nodes, notes: Vec::new() };
    exclude(&mut scene, &has_morph_targets, options.outline, &mut notes);
    scene.notes = notes.into_vec();
    Ok(scene)
}

/// Leaves objects out of the bake whose mesh deforms, is empty or is placed too far away.
fn exclude(scene: &mut Scene, has_morph_targets: &[bool], outline: bool, notes: &mut Notes) {
    for object in scene.objects.iter_mut().filter(|object| object.role == Role::Static) {
        let mesh = &scene.meshes[object.mesh as usize];
        let (code, message) = if has_morph_targets[object.mesh as usize] {
            ("MORPHED", "objects with morph targets deform and are left out of the bake")
        } else if if outline { mesh.drawn_triangles == 0 } else { mesh.is_empty() } {
            ("NO_TRIANGLES", "objects have no triangle that can be seen and are left out of the bake")
        } else if !transform::box_in_range(&object.to_world, mesh.min, mesh.max) {
            transform::OUT_OF_RANGE
        } else {
            continue;
        };
        object.role = Role::Excluded;
        notes.add(code, message, || format!("/nodes/{}", object.node));
    }
}

fn note_unknown_extensions(json: &Value, notes: &mut Notes) -> Result<(), SceneError> {
    for (i, name) in array(json, "extensionsRequired", "")?.iter().enumerate() {
        if !name.as_str().is_some_and(|name| KNOWN_REQUIRED.contains(&name)) {
            notes.add(
                "REQUIRED_EXTENSION_UNKNOWN",
                "required extensions are not known here: the scene is read as if they were not there",
                || format!("/extensionsRequired/{i}"),
            );
        }
    }
    Ok(())
}
