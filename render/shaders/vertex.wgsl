// Vertices of merged objects (row: their cluster) and of instances (row: the instance). In sync with vertex.rs.
struct Input {
    @location(0) position: vec3<f32>,
    @location(1) normal: vec4<f32>,
    @location(2) color: vec4<f32>,
    @location(3) surface: vec4<f32>,
    @location(4) emissive: vec4<f32>,
    @location(5) object: u32,
    @location(6) column_x: vec3<f32>,
    @location(7) column_y: vec3<f32>,
    @location(8) column_z: vec3<f32>,
    @location(9) place: vec3<f32>,
    @location(10) row_object: u32,
#if TEXTURED
    @location(11) uv: vec2<f32>,
#endif
}

struct Varying {
    @builtin(position) clip: vec4<f32>,
#if ITEM
    @location(0) @interpolate(flat, either) object: u32,
    @location(1) @interpolate(flat, either) alpha: vec2<f32>,
#else
#if !UNLIT
    // A normal, or relative to the eye the place of a flat face.
    @location(0) direction: vec3<f32>,
#endif
    // With textures or unlit, the base colour; else what scatters, so that fragments need not work it out. And alpha.
#if COLORS
    @location(1) color: vec4<f32>,
#else
    @location(1) @interpolate(flat, either) color: vec4<f32>,
#endif
#if MATERIAL_PER_PIXEL
    // Metallic, roughness.
    @location(2) @interpolate(flat, either) surface: vec2<f32>,
#else
#if !UNLIT
    // Reflectance straight on, roughness.
#if COLORS
    @location(2) mirror: vec4<f32>,
#else
    @location(2) @interpolate(flat, either) mirror: vec4<f32>,
#endif
#endif
#endif
#if EMISSIVE
    @location(3) @interpolate(flat, either) emissive: vec3<f32>,
#endif
#if TINT_PER_PIXEL
    @location(4) @interpolate(flat, either) tint: vec4<f32>,
#endif
#if MASK
    @location(6) @interpolate(flat, either) cutoff: f32,
#endif
#endif
#if TEXTURED
    @location(5) uv: vec2<f32>,
#endif
}

// Colour per object, 2048 a row.
@group(1) @binding(0) var tints: texture_2d<f32>;

@vertex
fn vertex(input: Input) -> Varying {
    var out: Varying;
    let p = input.column_x * input.position.x + input.column_y * input.position.y + input.column_z * input.position.z
        + input.place;
    out.clip = to_clip(p);
#if TEXTURED
    out.uv = input.uv;
#endif
#if ITEM
    out.object = input.object + input.row_object;
    out.alpha = vec2<f32>(input.color.w, input.surface.z);
#else
#if !UNLIT
#if FLAT
    out.direction = p;
#else
    // Transposed cofactors, with the sign of the determinant taken out, turn normals.
    let n = input.normal.xyz * 2.0 - 1.0;
    let cx = cross(input.column_y, input.column_z);
    let cofactors = cx * n.x + cross(input.column_z, input.column_x) * n.y + cross(input.column_x, input.column_y) * n.z;
    out.direction = unit(cofactors) * sign(dot(input.column_x, cx));
#endif
#endif
    var base = input.color.xyz * input.color.xyz;
    var metallic = input.surface.x;
    var light = input.emissive.xyz * input.emissive.xyz * (input.emissive.w * (255.0 / 8.0));
#if TINTED
    let id = input.object + input.row_object;
    let tint = textureLoad(tints, vec2<u32>(id & 2047u, id >> 11u), 0);
#if TINT_PER_PIXEL
    out.tint = tint;
#else
    base = mix(base, tint.xyz, tint.w);
    metallic *= 1.0 - tint.w;
#endif
    light *= 1.0 - tint.w;
#endif
#if EMISSIVE
    out.emissive = light;
#endif
#if MASK
    out.cutoff = input.surface.z;
#endif
#if MATERIAL_PER_PIXEL
    out.surface = vec2<f32>(metallic, input.surface.y);
#else
#if !UNLIT
    out.mirror = vec4<f32>(mirrored(base, metallic), input.surface.y);
    base = scattered(base, metallic);
#endif
#endif
    out.color = vec4<f32>(base, input.color.w);
#endif
    return out;
}
