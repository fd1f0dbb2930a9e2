//! What is drawn in one frame: visible neighbours become one draw call, uses of one mesh another.

use glam::DVec3;

use crate::extent::Extent;
use crate::layout::{Layout, NONE, Spot};
use crate::vertex::Row;

/// One draw call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Draw {
    pub(crate) class: u32,
    pub(crate) mirrored: bool,
    pub(crate) chunk: u32,
    /// First row of instance data.
    pub(crate) row: u32,
    pub(crate) instances: u32,
    pub(crate) first_index: u32,
    pub(crate) index_count: u32,
}

/// What one frame draws.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DrawStatistics {
    /// Distinct objects.
    pub objects: usize,
    /// Their triangles.
    pub triangles: u64,
    /// Draw calls they took, lines and sky not counted.
    pub draw_calls: usize,
}

/// A blended part, to be sorted.
#[derive(Clone, Copy, Debug)]
struct Blended {
    /// Squared distance of the object's middle from the eye.
    distance: f64,
    object: u32,
    /// Position in the layout: parts of one object keep their order.
    position: u32,
    draw: Draw,
}

/// Buckets of distance: four per doubling of the squared distance.
const BUCKETS: usize = 1 << 11;

/// The bucket of a squared distance; NaN comes last.
fn bucket(squared: f64) -> usize {
    (squared as f32).abs().to_bits() as usize >> 21
}

/// Lists of the frame, kept between frames: no allocation once they have grown.
#[derive(Debug, Default)]
pub(crate) struct Batcher {
    /// Opaque and masked ones, then blended ones from far to near.
    pub(crate) draws: Vec<Draw>,
    /// Index of the first blended draw call.
    pub(crate) blended: usize,
    /// One per cluster, then one per visible instance.
    pub(crate) rows: Vec<Row>,
    pub(crate) statistics: DrawStatistics,
    objects: Vec<u64>,
    parts: Vec<u64>,
    /// Per group: first row, and the row after the last one.
    starts: Vec<u32>,
    ends: Vec<u32>,
    /// Visible instances with their buckets, and their ids from near to far.
    found: Vec<(u32, u16)>,
    near_first: Vec<u32>,
    buckets: Vec<u32>,
    /// Opaque and masked draw calls by class, then from near to far.
    opaque: Vec<(u64, Draw)>,
    sorted: Vec<Blended>,
}

fn set(bits: &mut [u64], index: u32) -> bool {
    let (word, bit) = (&mut bits[index as usize / 64], 1u64 << (index % 64));
    let new = *word & bit == 0;
    *word |= bit;
    new
}

/// Ends of the next run of set bits in `range`, from `from` on.
fn next_run(bits: &[u64], from: u32, end: u32) -> Option<(u32, u32)> {
    let first = next_bit(bits, from, end, 0)?;
    let last = next_bit(bits, first, end, u64::MAX).unwrap_or(end);
    Some((first, last))
}

/// The next bit from `from` on that differs from those of `flip`.
fn next_bit(bits: &[u64], from: u32, end: u32, flip: u64) -> Option<u32> {
    if from >= end {
        return None;
    }
    let mut word = from as usize / 64;
    let mut rest = (bits[word] ^ flip) & (u64::MAX << (from % 64));
    loop {
        if rest != 0 {
            let found = word as u32 * 64 + rest.trailing_zeros();
            return (found < end).then_some(found);
        }
        word += 1;
        if word as u32 * 64 >= end {
            return None;
        }
        rest = bits[word] ^ flip;
    }
}

impl Batcher {
    /// Plans the frame. Objects out of range are not drawn, repeated ones once; the order of `objects` does not matter.
    pub(crate) fn plan(&mut self, layout: &Layout, objects: &[u32], eye: DVec3) {
        self.draws.clear();
        self.opaque.clear();
        self.sorted.clear();
        self.statistics = DrawStatistics::default();
        self.mark(layout, objects);
        self.sort_instances(layout, eye);
        self.fill_rows(layout, eye);
        self.merged(layout, eye);
        self.instanced(layout, eye);
        // The sequence number makes keys differ: one frame is always drawn the same way.
        self.opaque.sort_unstable_by_key(|&(key, _)| key);
        self.draws.extend(self.opaque.iter().map(|&(_, draw)| draw));
        self.blended = self.draws.len();
        // From far to near.
        self.sorted.sort_unstable_by(|a, b| {
            b.distance.total_cmp(&a.distance).then((a.object, a.position).cmp(&(b.object, b.position)))
        });
        for i in 0..self.sorted.len() {
            let draw = self.sorted[i].draw;
            match self.draws.last_mut() {
                Some(last) if i > 0 && follows(last, &draw) => last.index_count += draw.index_count,
                _ => self.draws.push(draw),
            }
        }
        self.statistics.draw_calls = self.draws.len();
    }

    /// Notes visible objects and parts and counts instances.
    fn mark(&mut self, layout: &Layout, objects: &[u32]) {
        self.objects.clear();
        self.objects.resize(layout.spots.len().div_ceil(64), 0);
        self.parts.clear();
        self.parts.resize(layout.parts.len().div_ceil(64), 0);
        self.ends.clear();
        self.ends.resize(layout.mirrored.len(), 0);
        for &object in objects {
            let Some(&Spot { triangles, group, .. }) = layout.spots.get(object as usize) else { continue };
            if !set(&mut self.objects, object) {
                continue;
            }
            self.statistics.objects += 1;
            self.statistics.triangles += u64::from(triangles);
            if group == NONE {
                let parts = layout.part_start[object as usize]..layout.part_start[object as usize + 1];
                for &part in &layout.part_ids[parts.start as usize..parts.end as usize] {
                    set(&mut self.parts, part);
                }
            } else {
                self.ends[group as usize] += 1;
            }
        }
    }

    /// A counting sort of the visible instances by group, near ones first.
    fn fill_rows(&mut self, layout: &Layout, eye: DVec3) {
        self.starts.clear();
        let mut next = layout.clusters.len() as u32;
        for count in &mut self.ends {
            self.starts.push(next);
            next += *count;
            *count = next - *count;
        }
        let none = Row { columns: [[0.0; 3]; 4], object: 0 };
        self.rows.resize(next as usize, none);
        for (row, &origin) in self.rows.iter_mut().zip(&layout.clusters) {
            let place = (origin - eye).as_vec3().to_array();
            *row = Row { columns: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], place], object: 0 };
        }
        for &object in &self.near_first {
            let place = &layout.places[object as usize];
            let [x, y, z] = place.columns;
            let origin = (place.origin - eye).as_vec3().to_array();
            let end = &mut self.ends[layout.spots[object as usize].group as usize];
            self.rows[*end as usize] = Row { columns: [x, y, z, origin], object };
            *end += 1;
        }
    }

    /// Visible instances from near to far, by a counting sort; those of one bucket in the order of their ids.
    fn sort_instances(&mut self, layout: &Layout, eye: DVec3) {
        self.found.clear();
        self.buckets.clear();
        self.buckets.resize(BUCKETS, 0);
        for (word, &bits) in self.objects.iter().enumerate() {
            let mut rest = bits;
            while rest != 0 {
                let object = word * 64 + rest.trailing_zeros() as usize;
                rest &= rest - 1;
                let spot = &layout.spots[object];
                if spot.group != NONE {
                    let bucket = bucket(spot.center.distance_squared(eye));
                    self.buckets[bucket] += 1;
                    self.found.push((object as u32, bucket as u16));
                }
            }
        }
        let mut next = 0;
        for count in &mut self.buckets {
            next += std::mem::replace(count, next);
        }
        self.near_first.resize(self.found.len(), 0);
        for &(object, bucket) in &self.found {
            let slot = &mut self.buckets[bucket as usize];
            self.near_first[*slot as usize] = object;
            *slot += 1;
        }
    }

    /// Adds an opaque or masked draw call of objects within `extent`.
    fn push_opaque(&mut self, extent: &Extent, eye: DVec3, draw: Draw) {
        let near = bucket(extent.distance_squared(eye)) as u64;
        let key = u64::from(draw.class) << 44
            | u64::from(draw.mirrored) << 43
            | near << 32
            | self.opaque.len() as u64;
        self.opaque.push((key, draw));
    }

    fn merged(&mut self, layout: &Layout, eye: DVec3) {
        for segment in &layout.segments {
            let mut from = segment.parts.start;
            while let Some((first, end)) = next_run(&self.parts, from, segment.parts.end) {
                from = end;
                let draw = |first: u32, end: u32| {
                    let (a, b) = (&layout.parts[first as usize], &layout.parts[end as usize - 1]);
                    Draw {
                        class: segment.class,
                        mirrored: false,
                        chunk: segment.chunk,
                        row: segment.cluster,
                        instances: 1,
                        first_index: a.first_index,
                        index_count: b.first_index + b.index_count - a.first_index,
                    }
                };
                if !layout.is_blended(segment.class) {
                    let mut first = first;
                    while first < end {
                        let parts = &layout.parts[first as usize..end as usize];
                        let block = parts[0].block;
                        let count = parts.partition_point(|part| part.block == block) as u32;
                        self.push_opaque(&layout.blocks[block as usize], eye, draw(first, first + count));
                        first += count;
                    }
                    continue;
                }
                for part in first..end {
                    let object = layout.parts[part as usize].object;
                    let distance = layout.spots[object as usize].center.distance_squared(eye);
                    self.sorted.push(Blended {
                        distance,
                        object,
                        position: part,
                        draw: draw(part, part + 1),
                    });
                }
            }
        }
    }

    fn instanced(&mut self, layout: &Layout, eye: DVec3) {
        for (position, piece) in layout.pieces.iter().enumerate() {
            let (row, end) = (self.starts[piece.group as usize], self.ends[piece.group as usize]);
            if row == end {
                continue;
            }
            let mut draw = Draw {
                class: piece.class,
                mirrored: layout.mirrored[piece.group as usize],
                chunk: piece.chunk,
                row,
                instances: end - row,
                first_index: piece.first_index,
                index_count: piece.index_count,
            };
            if !layout.is_blended(piece.class) {
                self.push_opaque(&layout.groups[piece.group as usize], eye, draw);
                continue;
            }
            draw.instances = 1;
            for row in row..end {
                let object = self.rows[row as usize].object;
                let distance = layout.spots[object as usize].center.distance_squared(eye);
                draw.row = row;
                self.sorted.push(Blended { distance, object, position: position as u32, draw });
            }
        }
    }
}

/// Whether `next` goes on where `last` ends.
fn follows(last: &Draw, next: &Draw) -> bool {
    (last.class, last.mirrored, last.chunk, last.row, last.instances)
        == (next.class, next.mirrored, next.chunk, next.row, next.instances)
        && last.first_index + last.index_count == next.first_index
}

#[cfg(test)]
#[path = "batch_tests.rs"]
mod tests;
