//! Groups a mesh's triangles by what they do to what is behind them.

use super::materials::{Cover, MaskTexture};
use super::{AlphaMask, Opacity, Surface};
use std::sync::Arc;

impl Cover {
    /// The alpha texture, if any.
    pub(super) fn mask(&self) -> Option<&MaskTexture> {
        match self {
            Cover::Mask(mask) => Some(mask),
            Cover::Opaque | Cover::Transparent | Cover::Nothing => None,
        }
    }
}

/// Triangles of one surface.
#[derive(Debug)]
pub(super) struct Group {
    double_sided: bool,
    opacity: Opacity,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// The surfaces of one mesh, by first use.
#[derive(Debug, Default)]
pub(super) struct Groups(Vec<Group>);

impl Groups {
    /// The group for a surface, `None` if it is nowhere.
    pub(super) fn group(&mut self, double_sided: bool, cover: &Cover) -> Option<&mut Group> {
        let opacity = match cover {
            Cover::Opaque => Opacity::Opaque,
            Cover::Transparent => Opacity::Transparent,
            Cover::Mask(texture) => Opacity::Mask(Arc::clone(&texture.mask)),
            Cover::Nothing => return None,
        };
        let found = self.0.iter().position(|g| g.double_sided == double_sided && same(&g.opacity, &opacity));
        let place = found.unwrap_or_else(|| {
            self.0.push(Group { double_sided, opacity, triangles: Vec::new() });
            self.0.len() - 1
        });
        self.0.get_mut(place)
    }

    /// All triangles that `keep` accepts, and the surfaces as consecutive ranges of them. Empty surfaces are
    /// left out.
    pub(super) fn into_surfaces(self, keep: impl Fn(&[u32; 3]) -> bool) -> (Vec<[u32; 3]>, Vec<Surface>) {
        let mut triangles: Vec<[u32; 3]> = Vec::with_capacity(self.0.iter().map(|g| g.triangles.len()).sum());
        let mut surfaces = Vec::with_capacity(self.0.len());
        for group in self.0 {
            // A mesh has at most u32::MAX triangles, which the caller checks.
            let start = triangles.len() as u32;
            triangles.extend(group.triangles.into_iter().filter(|triangle| keep(triangle)));
            let end = triangles.len() as u32;
            if end > start {
                let Group { double_sided, opacity, .. } = group;
                surfaces.push(Surface { triangles: start..end, double_sided, opacity });
            }
        }
        (triangles, surfaces)
    }
}

fn same(a: &Opacity, b: &Opacity) -> bool {
    match (a, b) {
        (Opacity::Opaque, Opacity::Opaque) | (Opacity::Transparent, Opacity::Transparent) => true,
        (Opacity::Mask(a), Opacity::Mask(b)) => Arc::<AlphaMask>::ptr_eq(a, b),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_surfaces_share_a_range_and_empty_ones_vanish() {
        let mut groups = Groups::default();
        let mut add = |double_sided, cover, triangle| {
            if let Some(group) = groups.group(double_sided, &cover) {
                group.triangles.push(triangle);
            }
        };
        add(false, Cover::Opaque, [0, 1, 2]);
        add(true, Cover::Opaque, [9, 9, 9]);
        add(false, Cover::Transparent, [3, 4, 5]);
        add(false, Cover::Opaque, [6, 7, 8]);
        add(false, Cover::Nothing, [1, 2, 3]);
        let (triangles, surfaces) = groups.into_surfaces(|triangle| triangle[0] != 9);
        assert_eq!(triangles, [[0, 1, 2], [6, 7, 8], [3, 4, 5]]);
        let ranges: Vec<_> = surfaces.iter().map(|s| s.triangles.clone()).collect();
        assert_eq!(ranges, [0..2, 2..3]);
        assert!(surfaces.iter().all(|s| !s.double_sided));
    }
}
