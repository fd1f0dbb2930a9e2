//! The twin of shaders/light.wgsl.

use glam::DVec3;

const SUN: DVec3 = DVec3::new(0.3491, 0.8479, 0.3990);
const SUN_COLOR: DVec3 = DVec3::new(0.85, 0.82, 0.77);
const SKY: DVec3 = DVec3::new(0.30, 0.34, 0.40);
const GROUND: DVec3 = DVec3::new(0.16, 0.15, 0.14);

/// What leaves a surface with unit normal `n` towards the unit vector `v`, linear.
pub(crate) fn shade(base: DVec3, metallic: f64, roughness: f64, n: DVec3, v: DVec3) -> DVec3 {
    let diffuse = base * (1.0 - metallic);
    let f0 = DVec3::splat(0.04).lerp(base, metallic);
    let h = (v + SUN).normalize();
    let (nh, lh) = (n.dot(h).max(0.0), SUN.dot(h).max(0.0));
    let a = (roughness * roughness).max(0.02);
    let d = nh * nh * (a * a - 1.0) + 1.0001;
    let highlight = (a * a / ((lh * lh).max(0.1) * (4.0 * roughness + 2.0) * d * d)).min(16.0);
    let sun = (diffuse + f0 * highlight) * SUN_COLOR * n.dot(SUN).max(0.0);
    let ambient = GROUND.lerp(SKY, n.y * 0.5 + 0.5);
    let mirrored = 2.0 * n.dot(v) * n.y - v.y;
    let around = GROUND.lerp(SKY, (mirrored * 1.5 + 0.5).clamp(0.0, 1.0)).lerp(ambient, roughness);
    sun + diffuse * ambient + f0 * around
}

/// Linear to sRGB, 0 to 255.
pub(crate) fn srgb(linear: f64) -> f64 {
    let c = linear.clamp(0.0, 1.0);
    255.0 * if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
}
