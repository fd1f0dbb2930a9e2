// One sun, sky above, ground below. The twin for tests is tests/common/light.rs.
const SUN = vec3<f32>(0.3491, 0.8479, 0.3990);
const SUN_COLOR = vec3<f32>(0.85, 0.82, 0.77);
const SKY = vec3<f32>(0.30, 0.34, 0.40);
const GROUND = vec3<f32>(0.16, 0.15, 0.14);

fn unit(v: vec3<f32>) -> vec3<f32> {
    return v * inverseSqrt(max(dot(v, v), 1e-30));
}

// What leaves a surface towards the unit vector `v`: `diffuse` scatters, `mirror` is the reflectance straight on. The
// highlight is GGX with the visibility term of Karis, "Optimizing PBR for Mobile" (SIGGRAPH 2015). The half vector h is
// never made: |v + SUN|^2 = 2 + 2 v.SUN = s, so that (n.h)^2 = (n.v + n.SUN)^2 / s and (SUN.h)^2 = s / 4.
fn shade(diffuse: vec3<f32>, mirror: vec3<f32>, roughness: f32, n: vec3<f32>, v: vec3<f32>) -> vec3<f32> {
    let nv = dot(n, v);
    let ns = dot(n, SUN);
    let s = max(2.0 + 2.0 * dot(v, SUN), 0.001);
    let nh = max(nv + ns, 0.0);
    let r2 = roughness * roughness;
    let a2 = max(r2 * r2, 0.0004);
    let d = nh * nh * (a2 - 1.0) + 1.0001 * s;
    let highlight = min(a2 * s * s / (max(0.25 * s, 0.1) * (4.0 * roughness + 2.0) * d * d), 16.0);
    let lit = max(ns, 0.0);
    let up = n.y * 0.5 + 0.5;
    let around = mix(clamp(3.0 * nv * n.y - 1.5 * v.y + 0.5, 0.0, 1.0), up, roughness);
    return diffuse * (SUN_COLOR * lit + GROUND + (SKY - GROUND) * up)
        + mirror * (SUN_COLOR * (lit * highlight) + GROUND + (SKY - GROUND) * around);
}

// Metallic-roughness to what `shade` takes.
fn scattered(base: vec3<f32>, metallic: f32) -> vec3<f32> {
    return base * (1.0 - metallic);
}

fn mirrored(base: vec3<f32>, metallic: f32) -> vec3<f32> {
    return mix(vec3<f32>(0.04), base, metallic);
}
