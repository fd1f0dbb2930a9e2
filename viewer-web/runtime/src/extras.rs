//! What is drawn in place of objects: proxies, and simplified levels of meshes. They are numbered after the objects.

use crate::describe::{Description, Graph};
use crate::places::{Places, is_nested, triangles};
use svs_runtime::{BoundsError, Level, MeshLevel, SceneCuller, Selected, SelectedKind, stretch};

/// No id, object or node.
pub(crate) const NONE: u32 = u32::MAX;

/// Something drawn in place of objects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extra {
    /// glTF mesh.
    pub mesh: u32,
    /// The object that it is a level of; `u32::MAX` for a proxy, which stands for many.
    pub object: u32,
    /// Place of the node in whose space it is: the object's, or a proxy's anchor. `u32::MAX` for the scene's.
    pub node: u32,
    /// Added to a proxy's positions.
    pub origin: [f32; 3],
}

/// All of them.
#[derive(Debug, Default)]
pub(crate) struct Extras {
    own: u32,
    pub(crate) list: Vec<Extra>,
    /// Per tree, per anchor: the id of its first proxy, or [`NONE`].
    proxies: Vec<Vec<u32>>,
    /// Per object: the id of its first level, or [`NONE`].
    levels: Vec<u32>,
}

impl Extras {
    /// Numbers them, and tells the culler what they cost.
    pub(crate) fn new(
        description: &Description,
        graph: &Graph,
        places: &Places,
        culler: &mut SceneCuller,
    ) -> Result<Self, BoundsError> {
        let own = graph.objects.len() as u32;
        let mut extras = Self { own, levels: vec![NONE; graph.objects.len()], ..Self::default() };
        let mesh_triangles = |mesh: u32| description.mesh_triangles.get(mesh as usize).copied().unwrap_or(0);
        let all_levels = places.visibility.mesh_levels();
        let levels_of = |object: u32| -> &[MeshLevel] {
            let mesh = graph.objects[object as usize].mesh;
            all_levels.iter().find(|entry| entry.mesh == mesh).map_or(&[], |entry| &entry.levels)
        };
        for (index, tree) in places.visibility.trees().iter().enumerate() {
            let Some(shown) = places.anchors[index].iter().position(|anchor| anchor.shown) else { continue };
            let anchor = &places.anchors[index][shown];
            if let Some(proxies) = tree.proxies() {
                let counts: Vec<u32> = proxies.nodes().iter().map(|node| mesh_triangles(node.mesh)).collect();
                culler.set_proxy_triangles(index as u32, &counts)?;
            }
            if all_levels.is_empty() {
                continue;
            }
            let from_world = places.to_world(graph, anchor).inverse();
            // What stands for a tree has no mesh of its own.
            let is_nested = is_nested(tree);
            let (mut starts, mut levels) = (vec![0], Vec::new());
            for (place, &is_nested) in is_nested.iter().enumerate() {
                let object = anchor.objects.start + tree.document_index(place);
                if !is_nested && triangles(description, graph, object) > 0 {
                    let to_tree = from_world * graph.object_world(&graph.objects[object as usize]);
                    let stretch = stretch(&to_tree);
                    levels.extend(levels_of(object).iter().map(|level| Level {
                        triangles: mesh_triangles(level.mesh),
                        error: (f64::from(level.error) * stretch).min(f64::from(f32::MAX)) as f32,
                        deviation: level.deviation.stretched(stretch),
                    }));
                }
                starts.push(levels.len() as u32);
            }
            if !levels.is_empty() {
                culler.set_levels(index as u32, &starts, &levels)?;
            }
        }
        for (_, object) in places.draws() {
            let levels = levels_of(object);
            if levels.is_empty() || extras.levels[object as usize] != NONE {
                continue;
            }
            extras.levels[object as usize] = extras.next_id();
            let node = graph.objects[object as usize].node;
            let of_level = |level: &MeshLevel| Extra { mesh: level.mesh, object, node, origin: [0.0; 3] };
            extras.list.extend(levels.iter().map(of_level));
        }
        for (index, tree) in places.visibility.trees().iter().enumerate() {
            let mut ids = vec![NONE; tree.placement().count()];
            if let Some(proxies) = tree.proxies() {
                for (id, anchor) in ids.iter_mut().zip(&places.anchors[index]).filter(|(_, a)| a.shown) {
                    *id = extras.next_id();
                    let node = anchor.node.unwrap_or(NONE);
                    extras.list.extend(proxies.nodes().iter().map(|proxy| Extra {
                        mesh: proxy.mesh,
                        object: NONE,
                        node,
                        origin: proxy.origin.to_array(),
                    }));
                }
            }
            extras.proxies.push(ids);
        }
        Ok(extras)
    }

    fn next_id(&self) -> u32 {
        self.own + self.list.len() as u32
    }

    /// The id that draws what the culler has selected.
    pub(crate) fn id(&self, selected: &Selected, places: &Places) -> Option<u32> {
        let draw = selected.draw;
        match selected.kind {
            SelectedKind::Object => places.object_of(draw),
            SelectedKind::Level(level) => {
                let first =
                    self.levels.get(places.object_of(draw)? as usize).filter(|&&first| first != NONE)?;
                Some(first + u32::from(level.checked_sub(1)?))
            }
            SelectedKind::Proxy => {
                let first = self.proxies.get(draw.tree as usize)?.get(draw.anchor as usize)?;
                (*first != NONE).then(|| first + draw.object)
            }
        }
    }
}
