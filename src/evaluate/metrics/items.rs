//! What a draw list misses of the reference's item buffer, and what it draws for nothing.

use crate::stage::visible_objects;
use svs_render::ItemBuffer;

/// The reference of one frame: which object each pixel shows.
#[derive(Clone, Debug)]
pub struct Seen {
    items: ItemBuffer,
    /// Objects that at least one pixel shows, ascending.
    pub objects: Vec<u32>,
}

impl Seen {
    /// Of an item buffer: per pixel the nearest opaque object and the nearest transparent one before it.
    pub fn new(items: ItemBuffer) -> Self {
        Self { objects: visible_objects(&items), items }
    }

    /// Compares a draw list of objects, in any order, with what is seen.
    pub fn compare(&self, drawn: &[u32]) -> Compared {
        let mut sorted = drawn.to_vec();
        sorted.sort_unstable();
        let is_drawn = |object: &u32| sorted.binary_search(object).is_ok();
        let missing: Vec<u32> = self.objects.iter().copied().filter(|object| !is_drawn(object)).collect();
        let overdrawn = drawn.len() - (self.objects.len() - missing.len()).min(drawn.len());
        let mut result = Compared { missing: Vec::new(), pixels: 0, overdrawn };
        if missing.is_empty() {
            return result;
        }
        let mut counts = vec![0_u32; missing.len()];
        for (&nearest, &transparent) in self.items.nearest.iter().zip(&self.items.transparent) {
            let hits = [nearest, transparent].map(|object| missing.binary_search(&object).ok());
            result.pixels += u64::from(hits.iter().any(Option::is_some));
            for place in hits.into_iter().flatten() {
                counts[place] += 1;
            }
        }
        result.missing = missing.into_iter().zip(counts).collect();
        result.missing.sort_by_key(|&(object, pixels)| (std::cmp::Reverse(pixels), object));
        result
    }

    /// The item buffer.
    pub fn items(&self) -> &ItemBuffer {
        &self.items
    }

    /// Pixels that show one of these objects, which are ascending: one flag per pixel.
    pub fn mask(&self, objects: &[u32]) -> Vec<bool> {
        let holds = |object: &u32| objects.binary_search(object).is_ok();
        self.items.nearest.iter().zip(&self.items.transparent).map(|(a, b)| holds(a) || holds(b)).collect()
    }
}

/// A draw list beside the reference.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Compared {
    /// Objects that are seen but not drawn, with the pixels that show them; most pixels first.
    pub missing: Vec<(u32, u32)>,
    /// Pixels that show at least one missing object: each counts once.
    pub pixels: u64,
    /// Objects that are drawn but not seen.
    pub overdrawn: usize,
}
