//! A tree under construction, and its tidying into a [`Hierarchy`].

use super::MAX_DEPTH;
use crate::bake::tree::{Hierarchy, HierarchyNode};

/// What hangs on a draft node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Child {
    /// Index of a member.
    Member(u32),
    /// Index of a draft node.
    Node(u32),
}

/// Nodes in any order, each child below one node only; empty nodes and chains are allowed.
#[derive(Debug, Default)]
pub(super) struct Draft {
    children: Vec<Vec<Child>>,
}

enum Task {
    Open { node: u32, parent: Option<u32>, depth: u32 },
    Close(u32),
}

impl Draft {
    /// Adds a node and returns its index.
    pub(super) fn add(&mut self, children: Vec<Child>) -> u32 {
        self.children.push(children);
        (self.children.len() - 1) as u32
    }

    /// Hangs something on a node.
    pub(super) fn push(&mut self, node: u32, child: Child) {
        self.children[node as usize].push(child);
    }

    /// Puts the nodes below `root` in depth-first order, without empty nodes, nodes with one child and nodes below
    /// [`MAX_DEPTH`]. `outcasts` are members that hang on the root. The tree must hold each of the `count` members
    /// once, outcasts included.
    pub(super) fn finish(mut self, root: u32, outcasts: &[u32], count: usize) -> Hierarchy {
        let mut hierarchy = Hierarchy { nodes: Vec::new(), order: Vec::with_capacity(count) };
        if count == 0 {
            return hierarchy;
        }
        let mut sizes = self.sizes(root);
        let root = self.skip_chain(root, &sizes);
        sizes[root as usize] += outcasts.len() as u32;
        self.children[root as usize].extend(outcasts.iter().map(|&member| Child::Member(member)));

        let mut tasks = vec![Task::Open { node: root, parent: None, depth: 0 }];
        let mut below = Vec::new();
        while let Some(task) = tasks.pop() {
            match task {
                Task::Open { node, parent, depth } => {
                    let index = hierarchy.nodes.len() as u32;
                    let start = hierarchy.order.len() as u32;
                    tasks.push(Task::Close(index));
                    below.clear();
                    for &child in &self.children[node as usize] {
                        match child {
                            Child::Member(member) => hierarchy.order.push(member),
                            Child::Node(child) => match sizes[child as usize] {
                                0 => {}
                                size if size == 1 || depth + 1 >= MAX_DEPTH => {
                                    self.members_below(child, &mut hierarchy.order);
                                }
                                _ => below.push(self.skip_chain(child, &sizes)),
                            },
                        }
                    }
                    hierarchy.order[start as usize..].sort_unstable();
                    let open = |&node: &u32| Task::Open { node, parent: Some(index), depth: depth + 1 };
                    tasks.extend(below.iter().rev().map(open));
                    hierarchy.nodes.push(HierarchyNode { parent, subtree: 0, members: start..start });
                }
                Task::Close(index) => {
                    let nodes = hierarchy.nodes.len() as u32;
                    let node = &mut hierarchy.nodes[index as usize];
                    node.subtree = nodes - index;
                    node.members.end = hierarchy.order.len() as u32;
                }
            }
        }
        debug_assert_eq!(hierarchy.order.len(), count, "each member is in the draft once");
        hierarchy
    }

    /// Members below each node.
    fn sizes(&self, root: u32) -> Vec<u32> {
        // Pre-order, then backwards: children are added up before their parents.
        let mut preorder = Vec::with_capacity(self.children.len());
        let mut stack = vec![root];
        while let Some(node) = stack.pop() {
            preorder.push(node);
            stack.extend(self.children[node as usize].iter().filter_map(|child| match *child {
                Child::Node(node) => Some(node),
                Child::Member(_) => None,
            }));
        }
        let mut sizes = vec![0; self.children.len()];
        for &node in preorder.iter().rev() {
            let size = |child: &Child| match *child {
                Child::Member(_) => 1,
                Child::Node(node) => sizes[node as usize],
            };
            sizes[node as usize] = self.children[node as usize].iter().map(size).sum();
        }
        sizes
    }

    /// The first node at or below `node` that has more than one child.
    fn skip_chain(&self, mut node: u32, sizes: &[u32]) -> u32 {
        loop {
            let mut children = self.children[node as usize].iter().filter(|child| match **child {
                Child::Member(_) => true,
                Child::Node(node) => sizes[node as usize] > 0,
            });
            match (children.next(), children.next()) {
                (Some(&Child::Node(child)), None) => node = child,
                _ => return node,
            }
        }
    }

    fn members_below(&self, node: u32, out: &mut Vec<u32>) {
        let mut stack = vec![node];
        while let Some(node) = stack.pop() {
            for &child in &self.children[node as usize] {
                match child {
                    Child::Member(member) => out.push(member),
                    Child::Node(node) => stack.push(node),
                }
            }
        }
    }
}
