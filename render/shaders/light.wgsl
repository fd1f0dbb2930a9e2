// One sun, sky above, ground below. The twin for tests is tests/common/light.rs.
const SUN = vec3<f32>(0.3491, 0.8479, 0.3990);
const SUN_COLOR = vec3<f32>(0.85, 0.82, 0.77);
const SKY = vec3<f32>(0.30, 0.34, 0.40);
const GROUND = vec3<f32>(0.16, 0.15, 0.14);

fn unit(v: vec3<f32>) -> vec3<f32> {
    return v * inverseSqrt(max(dot(v, v), 1e-30));
}

// What leaves a surface towards the unit vector `v`. The highlight is GGX with the visibility term of Karis, "Optimizing
// PBR for Mobile" (SIGGRAPH 2015): no square roots.
fn shade(base: vec3<f32>, metallic: f32, roughness: f32, n: vec3<f32>, v: vec3<f32>) -> vec3<f32> {
    let diffuse = base * (1.0 - metallic);
    let f0 = mix(vec3<f32>(0.04), base, metallic);
    let h = unit(v + SUN);
    let nh = max(dot(n, h), 0.0);
    let lh = max(dot(SUN, h), 0.0);
    let a = max(roughness * roughness, 0.02);
    let d = nh * nh * (a * a - 1.0) + 1.0001;
    let highlight = min(a * a / (max(lh * lh, 0.1) * (4.0 * roughness + 2.0) * d * d), 16.0);
    let sun = (diffuse + f0 * highlight) * SUN_COLOR * max(dot(n, SUN), 0.0);
    let ambient = mix(GROUND, SKY, n.y * 0.5 + 0.5);
    let mirrored = 2.0 * dot(n, v) * n.y - v.y;
    let around = mix(mix(GROUND, SKY, clamp(mirrored * 1.5 + 0.5, 0.0, 1.0)), ambient, roughness);
    return sun + diffuse * ambient + f0 * around;
}
