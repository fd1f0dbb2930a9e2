//! What the engine tells of proxies and levels.

use crate::bounds::BoundsError;
use crate::deviation::Deviation;
use crate::mesh_levels::MOST_LEVELS;
use crate::scene::{LOOSE, SceneCuller};

/// One simplified version of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// Triangles.
    pub triangles: u32,
    /// Geometric error, metres of tree space: that of [`crate::MeshLevel`] times the largest singular value of the linear
    /// part of the object's transform in its tree; for a loose object the same in world space.
    pub error: f32,
    /// How much of the original it shows wrong: that of [`crate::MeshLevel`], its lengths times the same.
    pub deviation: Deviation,
}

impl Level {
    /// A level of which only the error is known.
    pub fn new(triangles: u32, error: f32) -> Self {
        Self { triangles, error, deviation: Deviation::of_error(error) }
    }
}

/// Of all trees.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tables {
    /// Per tree, per proxy; empty where they are not known.
    proxies: Vec<Vec<u32>>,
    /// Per tree.
    levels: Vec<LevelTable>,
    /// Those of loose objects.
    loose: LevelTable,
}

/// Where each object's levels start, and one more; and all levels. Empty without levels.
type LevelTable = (Vec<u32>, Vec<Level>);

/// What is wrong with levels.
enum Wrong {
    Starts,
    Object(usize),
}

/// Checks the levels of so many objects.
fn check(starts: &[u32], levels: &[Level], objects: usize) -> Result<LevelTable, Wrong> {
    let whole = starts.first() == Some(&0) && starts.last().is_some_and(|&end| end as usize == levels.len());
    if starts.len() != objects + 1 || !whole {
        return Err(Wrong::Starts);
    }
    for (object, range) in starts.windows(2).enumerate() {
        let of_object = levels.get(range[0] as usize..range[1] as usize).ok_or(Wrong::Starts)?;
        let finite = of_object.iter().all(|level| level.deviation.is_valid(level.error));
        let coarser =
            |pair: &[Level]| pair[1].error >= pair[0].error && pair[1].triangles <= pair[0].triangles;
        if of_object.len() > MOST_LEVELS || !finite || !of_object.windows(2).all(coarser) {
            return Err(Wrong::Object(object));
        }
    }
    Ok((starts.to_vec(), levels.to_vec()))
}

impl Tables {
    pub(crate) fn proxy_triangles(&self, tree: u32, node: u32) -> u32 {
        self.proxies.get(tree as usize).and_then(|counts| counts.get(node as usize)).copied().unwrap_or(1)
    }

    /// First of an object's levels, and how many have fewer triangles than the original up to the coarsest.
    pub(crate) fn levels(&self, tree: u32, object: u32, original: u32) -> (u32, u8) {
        let Some((starts, levels)) = self.of_tree(tree) else { return (0, 0) };
        let (Some(&first), Some(&end)) = (starts.get(object as usize), starts.get(object as usize + 1))
        else {
            return (0, 0);
        };
        // Triangles never rise with the level: the coarsest has the fewest.
        let some = first < end && levels[end as usize - 1].triangles < original;
        if some { (first, (end - first) as u8) } else { (0, 0) }
    }

    /// `level` from 1, of an object whose first level is at `first`.
    pub(crate) fn level(&self, tree: u32, first: u32, level: u8) -> &Level {
        let table = if tree == LOOSE { &self.loose } else { &self.levels[tree as usize] };
        &table.1[first as usize + usize::from(level) - 1]
    }

    fn of_tree(&self, tree: u32) -> Option<&LevelTable> {
        if tree == LOOSE { Some(&self.loose) } else { self.levels.get(tree as usize) }
    }

    /// Other loose objects have come.
    pub(crate) fn forget_loose(&mut self) {
        self.loose = LevelTable::default();
    }
}

impl SceneCuller {
    /// Triangles of each proxy of a tree, in the order of [`crate::Proxies::nodes`]. Until they are known, each counts as
    /// one triangle.
    ///
    /// # Errors
    /// [`BoundsError`] if there is no such tree or there is not one count per proxy.
    pub fn set_proxy_triangles(&mut self, tree: u32, triangles: &[u32]) -> Result<(), BoundsError> {
        let index = tree as usize;
        let placed = self.find(tree, 0).ok_or(BoundsError::NoTree { tree: index })?;
        let proxies = self.placed[placed].instance.tree.proxies();
        let (found, expected) = (triangles.len(), proxies.map_or(0, |proxies| proxies.nodes().len()));
        if found != expected {
            return Err(BoundsError::ProxyTriangles { tree: index, found, expected });
        }
        self.detail.ask_again();
        let all = &mut self.detail.tables.proxies;
        all.resize(all.len().max(index + 1), Vec::new());
        all[index] = triangles.to_vec();
        Ok(())
    }

    /// Simplified versions of a tree's objects: those of the object at place `k` in tree order are
    /// `levels[starts[k]..starts[k + 1]]`, coarser and coarser, the original not included.
    ///
    /// # Errors
    /// [`BoundsError`] if there is no such tree, `starts` is not ascending from 0 to the number of levels with one entry per
    /// object and one more, or an object has more than 64 levels, or errors that are not finite or fall, or deviations out of order, or triangles that
    /// rise from one level to the next.
    pub fn set_levels(&mut self, tree: u32, starts: &[u32], levels: &[Level]) -> Result<(), BoundsError> {
        let index = tree as usize;
        let placed = self.find(tree, 0).ok_or(BoundsError::NoTree { tree: index })?;
        let objects = self.placed[placed].instance.tree.object_count();
        let table = check(starts, levels, objects).map_err(|wrong| match wrong {
            Wrong::Starts => BoundsError::LevelStarts { tree: index },
            Wrong::Object(object) => BoundsError::Levels { tree: index, object },
        })?;
        self.detail.ask_again();
        let all = &mut self.detail.tables.levels;
        all.resize(all.len().max(index + 1), Default::default());
        all[index] = table;
        Ok(())
    }

    /// Simplified versions of loose objects, in their order of [`Self::set_loose`], as of a tree's in [`Self::set_levels`];
    /// errors in metres of world space. They are forgotten when other loose objects are set. Objects that deform must have
    /// none.
    ///
    /// # Errors
    /// [`BoundsError`] for the same as in [`Self::set_levels`]; the levels are then those of before.
    pub fn set_loose_levels(&mut self, starts: &[u32], levels: &[Level]) -> Result<(), BoundsError> {
        let table = check(starts, levels, self.loose.order().len()).map_err(|wrong| match wrong {
            Wrong::Starts => BoundsError::LooseLevelStarts,
            Wrong::Object(object) => BoundsError::LooseLevels { object },
        })?;
        self.detail.ask_again();
        self.detail.tables.loose = table;
        Ok(())
    }
}
