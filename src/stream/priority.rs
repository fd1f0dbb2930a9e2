//! Which meshes matter most for a view.

use crate::stage::{Extra, Method, Stage};
use glam::DVec3;
use svs_render::View;
use svs_runtime::Budget;

/// Meshes of the stage's data that are seen from here, those first that show most pixels per byte; `bytes` are those of each
/// mesh in the file.
///
/// Proxies come first of all, coarse ones before fine ones: each stands for many objects.
pub fn priorities(stage: &mut Stage, view: &View, width: u32, height: u32, bytes: &[u64]) -> Vec<u32> {
    let mut worth = vec![0.0; stage.data.meshes.len()];
    let settings = stage.recommended();
    let drawn = stage.cull(view, width, height, Method::Visibility, &settings, &Budget::Unlimited).to_vec();
    let scale = f64::from(height) / (2.0 * (view.vertical_fov * 0.5).tan());
    for object in drawn {
        let pixels = pixels(stage, object, view.eye, scale);
        if let Some(worth) = worth.get_mut(stage.data.objects[object as usize].mesh as usize) {
            *worth += pixels;
        }
    }
    let mut order: Vec<(u32, f64)> = (worth.iter().enumerate())
        .map(|(mesh, pixels)| (mesh as u32, pixels / bytes.get(mesh).copied().unwrap_or(0).max(64) as f64))
        .collect();
    for (object, depth) in stage.proxy_depths() {
        if let Some((_, worth)) = order.get_mut(stage.data.objects[object as usize].mesh as usize) {
            *worth = f64::MAX / f64::from(depth + 2);
        }
    }
    order.retain(|&(_, worth)| worth > 0.0);
    order.sort_by(|a, b| b.1.total_cmp(&a.1));
    order.into_iter().map(|(mesh, _)| mesh).collect()
}

/// Pixels that an object may show, were nothing before it: by its visible area where that is baked, else by its box.
fn pixels(stage: &Stage, object: u32, eye: DVec3, scale: f64) -> f64 {
    let (min, max) = stage.object_bounds(object);
    let size = max - min;
    let faces = DVec3::new(size.y * size.z, size.z * size.x, size.x * size.y);
    let distance = (eye - eye.clamp(min, max)).length().max(size.length() * 0.5);
    let area = stage.importance(object).map_or(f64::INFINITY, |area| area).min(faces.element_sum());
    let pixels = area * (scale / distance.max(f64::MIN_POSITIVE)).powi(2);
    if pixels.is_finite() { pixels } else { 0.0 }
}

impl Stage {
    /// Ids of all proxies, and how deep in the tree of proxies they are.
    fn proxy_depths(&self) -> Vec<(u32, u32)> {
        let own = self.scene.objects.len() as u32;
        let ids = own..self.data.objects.len() as u32;
        let depth = |id: u32| match self.extra(id)? {
            Extra::Proxy { tree, node, .. } => {
                let proxies = self.trees().get(tree as usize)?.proxies()?;
                Some((id, proxies.nodes().get(node as usize)?.depth))
            }
            Extra::Level { .. } => None,
        };
        ids.filter_map(depth).collect()
    }
}
