//! Turning a document from one container into the other, in memory.

use super::buffers::BufferStorage;
use super::document::{Container, Document};
use super::json;
use serde_json::{Map, Value};

impl Document {
    /// Makes the document one of the given container; nothing happens if it is one already.
    ///
    /// - To GLB: all buffers with data go into the BIN chunk one after the other, each on a multiple of 4 bytes, and
    ///   `bufferViews` (and extensions of buffer views that name a buffer) are adjusted. Buffers that carry
    ///   `extensions` or `extras` stay as they are, except the first: merged ones keep only their bytes.
    /// - To .gltf: the BIN chunk becomes a file `<stem of the output>.bin`. Chunks that glTF does not define have no
    ///   place there; [`Document::write`] reports how many were dropped.
    ///
    /// Convert *before* attaching a payload: then stripping it gives exactly the converted file.
    pub fn convert(&mut self, container: Container) {
        if self.container == container {
            return;
        }
        match container {
            Container::Glb => self.merge_buffers(),
            Container::Gltf => self.split_bin(),
        }
        self.container = container;
    }

    fn split_bin(&mut self) {
        for storage in &mut self.storage {
            if *storage == BufferStorage::Bin {
                *storage = BufferStorage::Beside(".bin");
            }
        }
        let tail = usize::from(!self.bin_tail.is_empty());
        self.dropped_chunks += self.extra_chunks.len() + tail + usize::from(self.loose_bin.is_some());
        self.extra_chunks.clear();
        self.bin_tail.clear();
        self.loose_bin = None;
    }

    fn merge_buffers(&mut self) {
        let objects = json::array(&self.json, "buffers");
        // Only what was loaded: code may have added JSON without bytes, which `write` will refuse.
        let loaded = objects.len().min(self.buffers.len()).min(self.storage.len());
        let has_data = |&i: &usize| self.storage[i] != BufferStorage::Absent;
        let plain = |i: usize| objects[i].get("extensions").is_none() && objects[i].get("extras").is_none();
        let Some(first) = (0..loaded).find(has_data) else { return };
        let merged: Vec<usize> =
            (first..loaded).filter(has_data).filter(|&i| i == first || plain(i)).collect();

        let mut bin = std::mem::take(&mut self.buffers[first]);
        // New place of each old buffer: index, and offset within.
        let mut places = vec![(0, 0); loaded];
        for &i in &merged[1..] {
            bin.resize(bin.len().next_multiple_of(4), 0);
            places[i].1 = bin.len();
            bin.append(&mut self.buffers[i]);
        }
        let length = bin.len();
        let mut is_kept = vec![true; loaded];
        merged.iter().for_each(|&i| is_kept[i] = false);
        let kept: Vec<usize> = (0..loaded).filter(|&i| is_kept[i]).collect();
        for (position, &i) in kept.iter().enumerate() {
            places[i].0 = position + 1;
        }

        self.buffers =
            std::iter::once(bin).chain(kept.iter().map(|&i| std::mem::take(&mut self.buffers[i]))).collect();
        self.storage = std::iter::once(BufferStorage::Bin)
            .chain(kept.iter().map(|&i| self.storage[i].clone()))
            .collect();
        if let Some(Value::Array(objects)) = self.json.get_mut("buffers") {
            let mut head = objects[first].take();
            if let Value::Object(head) = &mut head {
                head.shift_remove("uri");
                if merged.len() > 1 {
                    head.insert("byteLength".into(), length.into());
                }
            }
            *objects = std::iter::once(head).chain(kept.iter().map(|&i| objects[i].take())).collect();
        }
        if places.iter().enumerate().any(|(i, &place)| place != (i, 0)) {
            self.repoint_views(&places);
        }
    }

    fn repoint_views(&mut self, places: &[(usize, usize)]) {
        let Some(Value::Array(views)) = self.json.get_mut("bufferViews") else { return };
        for view in views.iter_mut().filter_map(Value::as_object_mut) {
            repoint(view, places);
            if let Some(Value::Object(extensions)) = view.get_mut("extensions") {
                extensions
                    .values_mut()
                    .filter_map(Value::as_object_mut)
                    .for_each(|object| repoint(object, places));
            }
        }
    }
}

/// Moves an object's `buffer` and `byteOffset` to where the buffer's bytes are now.
fn repoint(object: &mut Map<String, Value>, places: &[(usize, usize)]) {
    let buffer = object.get("buffer").and_then(json::index);
    let Some(&(index, shift)) = buffer.and_then(|buffer| places.get(buffer)) else { return };
    object.insert("buffer".into(), index.into());
    if shift > 0 {
        let offset = object.get("byteOffset").and_then(json::index).unwrap_or(0);
        object.insert("byteOffset".into(), offset.saturating_add(shift).into());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gltf::uri;
    use serde_json::json;

    fn gltf(json: &Value) -> Document {
        Document::from_slice(json.to_string().as_bytes(), None).unwrap()
    }

    #[test]
    fn several_buffers_become_one() {
        let (a, b, c) = (vec![1, 2, 3], vec![4, 5], vec![6, 7, 8, 9]);
        let buffer = |bytes: &[u8]| json!({"byteLength": bytes.len(), "uri": uri::encode_data(bytes)});
        let mut kept = buffer(&b);
        kept["extras"] = json!("mine");
        let fallback = json!({"byteLength": 1000});
        let view = |buffer: usize, offset: usize, length: usize| json!({"buffer": buffer, "byteOffset": offset, "byteLength": length});
        let mut compressed = view(0, 0, 100);
        compressed["extensions"] =
            json!({"EXT_meshopt_compression": {"buffer": 3, "byteOffset": 1, "byteLength": 3}});
        let mut document = gltf(&json!({"asset": {"version": "2.0"},
            "buffers": [fallback, buffer(&a), kept, buffer(&c)],
            "bufferViews": [compressed, view(1, 1, 2), view(2, 0, 2), view(3, 1, 3)]}));
        let before: Vec<Vec<u8>> = (1..4).map(|i| document.buffer_view(i).unwrap().to_vec()).collect();
        document.convert(Container::Glb);
        assert_eq!(document.buffers, [vec![1, 2, 3, 0, 6, 7, 8, 9], vec![], vec![4, 5]]);
        let after: Vec<Vec<u8>> = (1..4).map(|i| document.buffer_view(i).unwrap().to_vec()).collect();
        assert_eq!(before, after);
        assert_eq!(document.json["bufferViews"][0]["buffer"], json!(1));
        let extension = &document.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"];
        assert_eq!((&extension["buffer"], &extension["byteOffset"]), (&json!(0), &json!(5)));
        assert_eq!(document.json["buffers"][0], json!({"byteLength": 8}));
        let back = Document::from_glb(&document.to_glb().unwrap()).unwrap();
        assert_eq!(back.json, document.json);
        assert_eq!(back.buffers, document.buffers);
    }

    #[test]
    fn one_buffer_changes_nothing_but_its_uri() {
        let text = "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"data:,abc\",\"byteLength\":3.0,\"extras\":1}],\
            \"bufferViews\":[{\"buffer\":0,\"byteLength\":3}]}";
        let mut document = Document::from_slice(text.as_bytes(), None).unwrap();
        document.convert(Container::Glb);
        assert_eq!(document.json.to_string(), text.replace("\"uri\":\"data:,abc\",", ""));
        assert_eq!(document.buffers, [b"abc".to_vec()]);
    }
}
