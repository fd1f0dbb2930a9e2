//! Nodes in depth-first order with skip pointers: their subtrees and object ranges must nest.

use crate::error::TreeError;

/// Names of the three tables, for messages.
pub(crate) struct Names {
    pub(crate) subtree: &'static str,
    pub(crate) first_object: &'static str,
    pub(crate) object_count: &'static str,
}

/// Depths of `count` nodes whose subtrees and object ranges nest: an object directly on a node comes before those of its
/// children, and children use up the rest without gaps. Linear, without recursion.
pub(crate) fn depths(
    count: usize,
    names: &Names,
    [subtrees, firsts, counts]: [&[u32]; 3],
    objects: u32,
) -> Result<Vec<u32>, TreeError> {
    /// An ancestor of the node being looked at.
    struct Open {
        /// One past its last node and its last object.
        end: u32,
        objects_end: u32,
        /// Where the objects of its next child must begin; for its first child, at or after.
        next_object: u32,
        has_child: bool,
        node: usize,
    }
    expect_length(names.subtree, subtrees.len(), count as u64)?;
    expect_length(names.first_object, firsts.len(), count as u64)?;
    expect_length(names.object_count, counts.len(), count as u64)?;
    let Ok(end) = u32::try_from(count) else { return Err(TreeError::Subtree { node: 0 }) };
    // Objects of no node may lie between roots, so the outermost level is as if it had no child yet.
    let mut open = vec![Open { end, objects_end: objects, next_object: 0, has_child: false, node: count }];
    // Children must use up their parent's objects.
    let close = |done: &Open| {
        if done.has_child && done.next_object != done.objects_end {
            Err(TreeError::ObjectRange { node: done.node })
        } else {
            Ok(())
        }
    };
    let mut depths = Vec::with_capacity(count);
    for node in 0..count {
        while open.len() > 1 && open[open.len() - 1].end == node as u32 {
            if let Some(done) = open.pop() {
                close(&done)?;
            }
        }
        let depth = open.len() as u32 - 1;
        let Some(parent) = open.last_mut() else { return Err(TreeError::Subtree { node }) };
        let subtree = subtrees[node];
        let node_end = (node as u32).checked_add(subtree).filter(|&e| subtree > 0 && e <= parent.end);
        let node_end = node_end.ok_or(TreeError::Subtree { node })?;
        let first_object = firsts[node];
        let objects_end = first_object.checked_add(counts[node]).filter(|&e| e <= parent.objects_end);
        let objects_end = objects_end.ok_or(TreeError::ObjectRange { node })?;
        let in_order = if parent.has_child {
            first_object == parent.next_object
        } else {
            first_object >= parent.next_object
        };
        if !in_order {
            return Err(TreeError::ObjectRange { node });
        }
        parent.has_child = depth > 0;
        parent.next_object = objects_end;
        depths.push(depth);
        open.push(Open { end: node_end, objects_end, next_object: first_object, has_child: false, node });
    }
    open.iter().try_for_each(close)?;
    Ok(depths)
}

pub(crate) fn expect_length(table: &'static str, found: usize, expected: u64) -> Result<(), TreeError> {
    if found as u64 == expected { Ok(()) } else { Err(TreeError::TableLength { table, found, expected }) }
}

/// The parent of each node, from their depths.
pub(crate) fn parents(depths: impl Iterator<Item = u32>) -> Vec<Option<u32>> {
    let mut open: Vec<u32> = Vec::new();
    depths
        .enumerate()
        .map(|(index, depth)| {
            open.truncate(depth as usize);
            let parent = open.last().copied();
            open.push(index as u32);
            parent
        })
        .collect()
}
