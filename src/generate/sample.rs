//! A finished sample scene and its GLB container.

use serde_json::Value;

/// A glTF 2.0 document with one buffer.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// The JSON part; `buffers[0]` has no URI and stands for [`Sample::bin`].
    pub json: Value,
    /// The bytes of buffer 0.
    pub bin: Vec<u8>,
}

impl Sample {
    /// The binary glTF file (glTF 2.0 specification, chapter 4): header, JSON chunk, BIN chunk.
    pub fn to_glb(&self) -> Vec<u8> {
        let mut json = self.json.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let padded_bin = self.bin.len().next_multiple_of(4);
        let total = 12 + 8 + json.len() + 8 + padded_bin;
        let mut glb = Vec::with_capacity(total);
        // Lengths are below 4 GiB: SampleOptions::MAX_SCALE bounds the JSON, shared meshes bound the buffer.
        let word = |glb: &mut Vec<u8>, word: usize| glb.extend((word as u32).to_le_bytes());
        glb.extend(b"glTF");
        word(&mut glb, 2);
        word(&mut glb, total);
        word(&mut glb, json.len());
        glb.extend(b"JSON");
        glb.extend(json);
        word(&mut glb, padded_bin);
        glb.extend(b"BIN\0");
        glb.extend(&self.bin);
        glb.resize(total, 0);
        glb
    }
}
