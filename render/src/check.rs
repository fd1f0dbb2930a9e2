//! Refuses what cannot be drawn before anything of it reaches the GPU.

use crate::{AlphaMode, Material, Primitive, RenderError, SceneData};

fn bad(what: &'static str, index: usize, problem: &'static str) -> RenderError {
    RenderError::Data { what, index, problem }
}

/// Every index is in range and every number finite.
pub(crate) fn check(data: &SceneData, order: &[u32]) -> Result<(), RenderError> {
    for (index, image) in data.images.iter().enumerate() {
        let texels = u64::from(image.width) * u64::from(image.height);
        if texels == 0 || image.rgba.len() as u64 != texels * 4 {
            return Err(bad("image", index, "its size and its texels disagree"));
        }
    }
    for (index, material) in data.materials.iter().enumerate() {
        check_material(material, data.images.len()).map_err(|problem| bad("material", index, problem))?;
    }
    for (index, mesh) in data.meshes.iter().enumerate() {
        for primitive in &mesh.primitives {
            check_primitive(primitive, data.materials.len())
                .map_err(|problem| bad("mesh", index, problem))?;
        }
    }
    for (index, object) in data.objects.iter().enumerate() {
        if object.mesh as usize >= data.meshes.len() {
            return Err(bad("object", index, "its mesh does not exist"));
        }
        if !object.to_world.is_finite() {
            return Err(bad("object", index, "its transform is not finite"));
        }
    }
    match order.iter().position(|&object| object as usize >= data.objects.len()) {
        Some(index) => Err(bad("order", index, "it names an object that does not exist")),
        None => Ok(()),
    }
}

fn check_material(material: &Material, images: usize) -> Result<(), &'static str> {
    let cutoff = if let AlphaMode::Mask(cutoff) = material.alpha { cutoff } else { 0.0 };
    let mut numbers = material.base_color.iter().chain(&material.emissive);
    if !numbers.all(|x| x.is_finite())
        || ![material.metallic, material.roughness, cutoff].iter().all(|x| x.is_finite())
    {
        return Err("a factor is not finite");
    }
    let textures =
        [&material.base_color_texture, &material.metallic_roughness_texture, &material.emissive_texture];
    if textures.into_iter().flatten().any(|texture| texture.image as usize >= images) {
        return Err("a texture's image does not exist");
    }
    Ok(())
}

fn check_primitive(primitive: &Primitive, materials: usize) -> Result<(), &'static str> {
    let vertices = primitive.positions.len();
    if primitive.material as usize >= materials {
        return Err("its material does not exist");
    }
    for length in [primitive.normals.len(), primitive.colors.len(), primitive.uvs.len()] {
        if length != 0 && length != vertices {
            return Err("an attribute has another length than the positions");
        }
    }
    if !primitive.indices.len().is_multiple_of(3) {
        return Err("the number of its indices is no multiple of three");
    }
    if primitive.indices.iter().any(|&index| index as usize >= vertices) {
        return Err("an index is out of range");
    }
    let finite = |list: &[[f32; 3]]| list.iter().flatten().all(|x| x.is_finite());
    if !finite(&primitive.positions) || !finite(&primitive.normals) {
        return Err("a position or a normal is not finite");
    }
    if !primitive.uvs.iter().flatten().all(|x| x.is_finite()) {
        return Err("a texture coordinate is not finite");
    }
    Ok(())
}
