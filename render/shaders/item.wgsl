// The id of the object.
#if TEXTURED
@group(2) @binding(0) var color_texture: texture_2d<f32>;
@group(2) @binding(1) var color_sampler: sampler;
#endif

@fragment
fn fragment(in: Varying) -> @location(0) u32 {
#if CUT
    var alpha = in.alpha.x;
#if TEXTURED
    alpha *= textureSample(color_texture, color_sampler, in.uv).w;
#endif
#if MASK
    if alpha < in.alpha.y {
        discard;
    }
#else
    // Blended, and not to be seen.
    if alpha < 1.0 / 512.0 {
        discard;
    }
#endif
#endif
    return in.object;
}
