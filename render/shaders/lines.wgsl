// Lines of the overlay.
struct LineVarying {
    @builtin(position) clip: vec4<f32>,
    @location(0) color: vec4<f32>,
}

@vertex
fn vertex(@location(0) position: vec3<f32>, @location(1) color: vec4<f32>) -> LineVarying {
    // sRGB to linear.
    let c = color.xyz;
    let linear = select(pow((c + 0.055) / 1.055, vec3<f32>(2.4)), c / 12.92, c <= vec3<f32>(0.04045));
    return LineVarying(to_clip(position), vec4<f32>(linear, color.w));
}

@fragment
fn fragment(in: LineVarying) -> @location(0) vec4<f32> {
    return vec4<f32>(encode(in.color.xyz), in.color.w);
}
