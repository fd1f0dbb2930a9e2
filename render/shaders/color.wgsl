// The visible colour of a surface.
#if TEXTURED
@group(2) @binding(0) var color_texture: texture_2d<f32>;
@group(2) @binding(1) var color_sampler: sampler;
@group(2) @binding(2) var surface_texture: texture_2d<f32>;
@group(2) @binding(3) var surface_sampler: sampler;
@group(2) @binding(4) var emissive_texture: texture_2d<f32>;
@group(2) @binding(5) var emissive_sampler: sampler;
#endif

@fragment
fn fragment(in: Varying, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    var color = in.color;
#if TEXTURED
    color *= textureSample(color_texture, color_sampler, in.uv);
#endif
    var light = vec3<f32>(0.0);
#if EMISSIVE
    light = in.emissive;
#if FULL
    light *= textureSample(emissive_texture, emissive_sampler, in.uv).xyz;
#endif
#endif
#if MATERIAL_PER_PIXEL
    var surface = in.surface;
#if FULL
    surface *= textureSample(surface_texture, surface_sampler, in.uv).zy;
#endif
#endif
#if FLAT
    // Before anything is discarded: derivatives need the neighbours.
    let face = unit(cross(dpdx(in.direction), dpdy(in.direction)));
    let n = select(face, -face, dot(face, in.direction) > 0.0);
#endif
#if MASK
    if color.w < in.cutoff {
        discard;
    }
#endif
#if TINT_PER_PIXEL
    color = vec4<f32>(mix(color.xyz, in.tint.xyz, in.tint.w), color.w);
#if MATERIAL_PER_PIXEL
    surface.x *= 1.0 - in.tint.w;
#endif
#endif
#if UNLIT
    light = color.xyz;
#else
#if !FLAT
#if DOUBLE_SIDED
    let n = unit(select(-in.direction, in.direction, front));
#else
    let n = unit(in.direction);
#endif
#endif
#if MATERIAL_PER_PIXEL
    let diffuse = scattered(color.xyz, surface.x);
    let mirror = vec4<f32>(mirrored(color.xyz, surface.x), surface.y);
#else
    let diffuse = color.xyz;
    let mirror = in.mirror;
#endif
    light += shade(diffuse, mirror.xyz, mirror.w, n, -unit(ray(in.clip.xy)));
#endif
#if BLEND
    return vec4<f32>(encode(light), color.w);
#else
    return vec4<f32>(encode(light), 1.0);
#endif
}
