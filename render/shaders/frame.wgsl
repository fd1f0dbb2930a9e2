// The camera; must be kept in sync with `FrameUniform` in frame.rs. Everything is relative to the eye.
struct Frame {
    // Rows of the projection: x, y and w of clip space. Its z is `near` everywhere: depth = near / distance, 0 at infinity.
    right_near: vec4<f32>,
    up: vec4<f32>,
    forward: vec4<f32>,
    // The ray through a pixel: corner + x * step_x + y * step_y; its length along forward is 1.
    corner: vec4<f32>,
    step_x: vec4<f32>,
    step_y: vec4<f32>,
}

@group(0) @binding(0) var<uniform> frame: Frame;

fn to_clip(p: vec3<f32>) -> vec4<f32> {
    return vec4<f32>(
        dot(frame.right_near.xyz, p),
        dot(frame.up.xyz, p),
        frame.right_near.w,
        dot(frame.forward.xyz, p),
    );
}

fn ray(pixel: vec2<f32>) -> vec3<f32> {
    return frame.corner.xyz + pixel.x * frame.step_x.xyz + pixel.y * frame.step_y.xyz;
}

// Linear colour to what the target stores.
fn encode(color: vec3<f32>) -> vec3<f32> {
#if SRGB_TARGET
    return color;
#else
    let c = clamp(color, vec3<f32>(0.0), vec3<f32>(1.0));
    return select(1.055 * pow(c, vec3<f32>(1.0 / 2.4)) - 0.055, 12.92 * c, c <= vec3<f32>(0.0031308));
#endif
}
