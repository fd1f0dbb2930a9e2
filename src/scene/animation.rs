//! What animations change: nodes that move, materials whose look is animated.

use super::SceneError;
use super::json::{array, extension, optional_index};
use super::notes::Notes;
use serde_json::Value;

/// What the animations of a document target.
#[derive(Debug)]
pub(super) struct Animated {
    /// Per node: a channel changes its transform, weights or visibility.
    pub(super) nodes: Vec<bool>,
    /// Per material: a channel changes one of its properties (`KHR_animation_pointer`).
    pub(super) materials: Vec<bool>,
}

/// Reads the targets of all channels (glTF 2.0, 3.11; `KHR_animation_pointer`).
pub(super) fn read(json: &Value, notes: &mut Notes) -> Result<Animated, SceneError> {
    let nodes = array(json, "nodes", "")?.len();
    let materials = array(json, "materials", "")?.len();
    let mut animated = Animated { nodes: vec![false; nodes], materials: vec![false; materials] };
    for (a, animation) in array(json, "animations", "")?.iter().enumerate() {
        for (c, channel) in array(animation, "channels", &format!("/animations/{a}"))?.iter().enumerate() {
            let pointer = || format!("/animations/{a}/channels/{c}/target");
            // A channel without a target animates nothing.
            let Some(target) = channel.get("target") else { continue };
            // Only translation, rotation, scale and weights exist, and unknown paths may move the node too.
            if let Some(node) = optional_index(target, "node", "nodes", nodes, &pointer())? {
                animated.nodes[node] = true;
            }
            let Some(extension) = extension(target, "KHR_animation_pointer") else { continue };
            let path = extension.get("pointer").and_then(Value::as_str).unwrap_or_default();
            match parse(path) {
                Some(("nodes", node)) if node < nodes => animated.nodes[node] = true,
                Some(("materials", material)) if material < materials => animated.materials[material] = true,
                // Weights of a mesh deform it: meshes with morph targets are never baked anyway.
                // Cameras, lights and other extensions do not change what is visible.
                Some((kind, _)) if kind != "nodes" && kind != "materials" => {}
                _ => notes.add(
                    "ANIMATION_POINTER_UNKNOWN",
                    "animation channels target something the file does not have and are ignored",
                    pointer,
                ),
            }
        }
    }
    Ok(animated)
}

/// `/nodes/3/translation` to `("nodes", 3)`; array-less pointers give index 0.
fn parse(pointer: &str) -> Option<(&str, usize)> {
    let mut parts = pointer.strip_prefix('/')?.split('/');
    let kind = parts.next().filter(|kind| !kind.is_empty())?;
    match kind {
        "nodes" | "materials" => Some((kind, parts.next()?.parse().ok()?)),
        _ => Some((kind, 0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn channel(target: Value) -> Value {
        json!({"sampler": 0, "target": target})
    }

    fn pointer(path: &str) -> Value {
        channel(json!({"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": path}}}))
    }

    #[test]
    fn channels_and_pointers_mark_their_targets() {
        let json = json!({
            "nodes": [{}, {}, {}, {}],
            "materials": [{}, {}],
            "animations": [{"channels": [
                channel(json!({"node": 1, "path": "rotation"})),
                channel(json!({"path": "translation"})),
                pointer("/nodes/3/extensions/KHR_node_visibility/visible"),
                pointer("/materials/1/pbrMetallicRoughness/baseColorFactor"),
                pointer("/cameras/0/perspective/yfov"),
                pointer("/nodes/9/translation"),
                pointer("nonsense"),
            ]}, {}]
        });
        let mut notes = Notes::default();
        let animated = read(&json, &mut notes).unwrap();
        assert_eq!(animated.nodes, [false, true, false, true]);
        assert_eq!(animated.materials, [false, true]);
        let notes = notes.into_vec();
        assert_eq!((notes.len(), notes[0].code, notes[0].count), (1, "ANIMATION_POINTER_UNKNOWN", 2));
    }

    #[test]
    fn a_channel_on_a_missing_node_is_an_error() {
        let json = json!({"nodes": [{}], "animations": [{"channels": [channel(json!({"node": 1}))]}]});
        let error = read(&json, &mut Notes::default()).unwrap_err();
        assert!(error.to_string().starts_with("/animations/0/channels/0/target/node:"), "{error}");
    }
}
