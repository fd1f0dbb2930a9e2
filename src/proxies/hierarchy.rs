//! The hierarchy of proxies: a bounding volume hierarchy over the objects, cut where a node has few triangles.
//!
//! Copies of a group get copies of its nodes, so that their proxies are built and stored once.

use super::repeats;
use crate::bake::hierarchy::{self, HierarchyKind, is_usable};
use crate::bake::subject::Subject;
use crate::bake::tree::{Aabb, Hierarchy, HierarchyNode, Member};
use std::ops::Range;

/// Nodes with less than this part of the triangles that are meant for one are not made: their objects hang on the parent.
const SMALLEST: u64 = 4;

/// Groups in groups in groups that are looked at for copies.
const DEEPEST: u32 = 8;

/// Nodes over the members of a tree.
#[derive(Clone, Debug, Default)]
pub(super) struct ProxyHierarchy {
    /// Members outside every node come first.
    pub(super) hierarchy: Hierarchy,
    /// For each node the node that it is a moved copy of: itself, or an earlier one.
    pub(super) original: Vec<u32>,
}

/// A node under construction.
#[derive(Clone, Debug, Default)]
struct Sketch {
    direct: Vec<u32>,
    children: Vec<u32>,
    triangles: u64,
    original: Option<u32>,
}

#[derive(Debug)]
struct Builder<'a> {
    subject: &'a Subject,
    /// Members that are drawn at all.
    drawn: &'a [bool],
    /// Copies of groups with fewer triangles are not looked for.
    triangles: u64,
    nodes: Vec<Sketch>,
}

/// The nodes before they are cut.
#[derive(Debug)]
pub(super) struct Uncut<'a> {
    builder: Builder<'a>,
    root: u32,
    /// Triangles of the originals, those of copies counted once.
    pub(super) distinct: u64,
}

/// Builds the nodes over members that are `drawn`; the others stay outside. Copies of groups with at least `triangles`
/// triangles share their nodes.
pub(super) fn build<'a>(subject: &'a Subject, drawn: &'a [bool], triangles: u32) -> Uncut<'a> {
    let mut builder = Builder { subject, drawn, triangles: u64::from(triangles.max(1)), nodes: Vec::new() };
    let root = builder.set(0..subject.members.len() as u32, DEEPEST);
    let distinct = builder.count(root);
    Uncut { builder, root, distinct }
}

impl Uncut<'_> {
    /// The tree whose leaves stand for about `triangles` triangles of originals.
    pub(super) fn cut(&self, triangles: u64) -> ProxyHierarchy {
        let builder = &self.builder;
        let mut out = ProxyHierarchy::default();
        let mut is_inside = vec![false; builder.subject.members.len()];
        for node in builder.preorder(self.root) {
            for &member in &builder.nodes[node as usize].direct {
                is_inside[member as usize] = true;
            }
        }
        out.hierarchy.order = (0..is_inside.len() as u32).filter(|&m| !is_inside[m as usize]).collect();
        if builder.nodes[self.root as usize].triangles > 0 {
            let mut places = vec![u32::MAX; builder.nodes.len()];
            builder.emit(self.root, None, triangles.max(1), &mut places, &mut out);
        }
        out
    }
}

impl Builder<'_> {
    /// A node over a range of members; copied groups in it are made once.
    fn set(&mut self, within: Range<u32>, depth: u32) -> u32 {
        let copies = match depth {
            0 => Vec::new(),
            _ => repeats::find(self.subject, self.drawn, within.clone(), self.triangles).copies,
        };
        // Units: single members, then copies, in document order.
        let mut units: Vec<(Range<u32>, Option<u32>)> = Vec::new();
        let mut next = within.start;
        for (range, kind) in copies {
            units.extend((next..range.start).map(|member| (member..member + 1, None)));
            next = range.end;
            units.push((range, Some(kind)));
        }
        units.extend((next..within.end).map(|member| (member..member + 1, None)));
        units.retain(|(range, _)| range.clone().all(|member| self.is_usable(member)));

        let items: Vec<Member> = units.iter().map(|(range, _)| self.item(range.clone())).collect();
        let tree = hierarchy::build(HierarchyKind::Bvh, &items, &[]);
        // The kind, root and members of each first copy.
        let mut made: Vec<(u32, u32, Range<u32>)> = Vec::new();
        let first = self.nodes.len() as u32;
        for node in &tree.nodes {
            let index = self.nodes.len() as u32;
            self.nodes.push(Sketch::default());
            if let Some(parent) = node.parent {
                self.nodes[(first + parent) as usize].children.push(index);
            }
        }
        // Copies come before the nodes of the tree, as they do in its order: so an original comes before its copies.
        let mut groups: Vec<Vec<u32>> = vec![Vec::new(); tree.nodes.len()];
        for (place, parent) in tree.parents_of_members().into_iter().enumerate() {
            let parent = parent.unwrap_or(0);
            let (range, kind) = units[tree.order[place] as usize].clone();
            let Some(kind) = kind else {
                self.nodes[(first + parent) as usize].direct.push(range.start);
                continue;
            };
            let child = match made.iter().find(|(known, ..)| *known == kind).cloned() {
                Some((_, root, of)) => self.copy(root, range.start.wrapping_sub(of.start)),
                None => {
                    let root = self.set(range.clone(), depth - 1);
                    made.push((kind, root, range));
                    root
                }
            };
            groups[parent as usize].push(child);
        }
        for (node, mut groups) in groups.into_iter().enumerate() {
            let children = &mut self.nodes[first as usize + node].children;
            groups.append(children);
            *children = groups;
        }
        if tree.nodes.is_empty() {
            self.nodes.push(Sketch::default());
        }
        first
    }

    fn is_usable(&self, member: u32) -> bool {
        let is_drawn = self.drawn[member as usize];
        let member = &self.subject.members[member as usize];
        is_drawn && is_usable(&member.bounds) && member.triangles > 0
    }

    fn item(&self, range: Range<u32>) -> Member {
        let members = &self.subject.members[range.start as usize..range.end as usize];
        Member {
            bounds: members.iter().fold(Aabb::EMPTY, |all, member| all.union(&member.bounds)),
            triangles: members.iter().map(|member| member.triangles).fold(0, u32::saturating_add),
            parts: 0..0,
        }
    }

    /// The nodes below `root` again, for members that come `offset` later (wrapping).
    fn copy(&mut self, root: u32, offset: u32) -> u32 {
        let index = self.nodes.len() as u32;
        let source = self.nodes[root as usize].clone();
        self.nodes.push(Sketch {
            direct: source.direct.iter().map(|member| member.wrapping_add(offset)).collect(),
            original: Some(source.original.unwrap_or(root)),
            ..Sketch::default()
        });
        for child in source.children {
            let child = self.copy(child, offset);
            self.nodes[index as usize].children.push(child);
        }
        index
    }

    /// Counts the triangles below each node; returns those of the root, copies counted once.
    fn count(&mut self, root: u32) -> u64 {
        let mut distinct = 0;
        for &node in self.preorder(root).iter().rev() {
            let own = &self.nodes[node as usize];
            let direct = own.direct.iter().map(|&m| u64::from(self.subject.members[m as usize].triangles));
            let direct: u64 = direct.sum();
            let below = own.children.iter().map(|&child| self.nodes[child as usize].triangles);
            if own.original.is_none() {
                distinct += direct;
            }
            self.nodes[node as usize].triangles = direct + below.sum::<u64>();
        }
        distinct
    }

    fn preorder(&self, root: u32) -> Vec<u32> {
        let mut preorder = Vec::with_capacity(self.nodes.len());
        let mut stack = vec![root];
        while let Some(node) = stack.pop() {
            preorder.push(node);
            stack.extend(self.nodes[node as usize].children.iter().rev());
        }
        preorder
    }

    /// Depth is bounded by [`hierarchy::MAX_DEPTH`] for each of at most [`DEEPEST`] sets in one another.
    fn emit(
        &self,
        node: u32,
        parent: Option<u32>,
        triangles: u64,
        places: &mut [u32],
        out: &mut ProxyHierarchy,
    ) {
        let index = out.hierarchy.nodes.len() as u32;
        let start = out.hierarchy.order.len() as u32;
        out.hierarchy.nodes.push(HierarchyNode { parent, subtree: 0, members: start..start });
        // The first that is left of an original and its copies stands for them.
        let first = &mut places[self.nodes[node as usize].original.unwrap_or(node) as usize];
        *first = (*first).min(index);
        out.original.push(*first);
        let mut direct = Vec::new();
        let mut children = Vec::new();
        self.split(node, triangles, &mut direct, &mut children);
        direct.sort_unstable();
        out.hierarchy.order.extend(direct);
        for child in children {
            self.emit(child, Some(index), triangles, places, out);
        }
        let (nodes, places) = (out.hierarchy.nodes.len() as u32, out.hierarchy.order.len() as u32);
        let own = &mut out.hierarchy.nodes[index as usize];
        own.subtree = nodes - index;
        own.members.end = places;
    }

    /// What hangs on a node once it is cut: its own members with those of small nodes, and the nodes that stay.
    fn split(&self, node: u32, triangles: u64, direct: &mut Vec<u32>, children: &mut Vec<u32>) {
        let own = &self.nodes[node as usize];
        direct.extend(&own.direct);
        let is_leaf = own.triangles <= triangles;
        for &child in &own.children {
            if is_leaf || self.nodes[child as usize].triangles < triangles.div_ceil(SMALLEST) {
                for below in self.preorder(child) {
                    direct.extend(&self.nodes[below as usize].direct);
                }
            } else {
                children.push(child);
            }
        }
    }
}
