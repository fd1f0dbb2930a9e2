//! Exact visible sets, from item buffers.

use svs_render::{ItemBuffer, NO_ITEM};

/// The objects that at least one pixel shows, ascending: nearest ones, and nearest transparent ones before them. What is
/// seen only through two transparent objects is left out.
pub fn visible_objects(items: &ItemBuffer) -> Vec<u32> {
    let mut objects: Vec<u32> = Vec::new();
    // Neighbouring pixels mostly show the same: dropping repetitions first leaves little to sort.
    for layer in [&items.nearest, &items.transparent] {
        objects.extend(layer.chunk_by(|a, b| a == b).map(|run| run[0]).filter(|&object| object != NO_ITEM));
    }
    objects.sort_unstable();
    objects.dedup();
    objects
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_layers_count_and_each_object_once() {
        let nearest = vec![3, 3, NO_ITEM, 1, 3, 7];
        let transparent = vec![NO_ITEM, 9, 9, NO_ITEM, 1, NO_ITEM];
        let items = ItemBuffer { width: 3, height: 2, nearest, transparent };
        assert_eq!(visible_objects(&items), [1, 3, 7, 9]);
        assert!(visible_objects(&ItemBuffer::default()).is_empty());
    }
}
