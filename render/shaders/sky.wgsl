// Where nothing is: one triangle over the whole image, at infinity.
@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) pixel: vec4<f32>) -> @location(0) vec4<f32> {
    // Along the vertical of the image, not of the sphere: a square root less in every pixel.
    let height = clamp(ray(pixel.xy).y, -1.0, 1.0);
    let above = mix(vec3<f32>(0.62, 0.70, 0.78), vec3<f32>(0.24, 0.38, 0.60), max(height, 0.0));
    let below = mix(vec3<f32>(0.38, 0.37, 0.36), vec3<f32>(0.20, 0.19, 0.18), max(-height, 0.0));
    return vec4<f32>(encode(mix(below, above, clamp(height * 20.0 + 0.5, 0.0, 1.0))), 1.0);
}
