//! A subtree of nodes that is designed once and placed many times.

use super::builder::{Builder, MeshId, NodeId, Transform};

/// Objects and sub-assemblies in the assembly's own coordinates.
#[derive(Clone, Debug, Default)]
pub(super) struct Assembly {
    objects: Vec<(String, MeshId, Transform)>,
    groups: Vec<(String, Transform, Assembly)>,
}

impl Assembly {
    /// Adds an object.
    pub(super) fn object(&mut self, name: impl Into<String>, mesh: MeshId, at: Transform) {
        self.objects.push((name.into(), mesh, at));
    }

    /// Adds a sub-assembly; an empty one is left out, as empty nodes serve nobody.
    pub(super) fn group(&mut self, name: impl Into<String>, at: Transform, group: Assembly) {
        if !group.is_empty() {
            self.groups.push((name.into(), at, group));
        }
    }

    fn is_empty(&self) -> bool {
        self.objects.is_empty() && self.groups.is_empty()
    }

    /// Makes the nodes: one for the assembly itself, named `name`, the rest below it. Nesting is a handful deep.
    pub(super) fn place(
        &self,
        builder: &mut Builder,
        parent: Option<NodeId>,
        name: &str,
        at: Transform,
    ) -> NodeId {
        let node = builder.group(parent, name, at);
        for (name, mesh, at) in &self.objects {
            builder.object(node, name.as_str(), *mesh, *at);
        }
        for (name, at, group) in &self.groups {
            group.place(builder, Some(node), name, *at);
        }
        node
    }
}
