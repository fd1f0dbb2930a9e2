//! Form of the targets' input: a GLB, or JSON text, a zero byte, and the bytes of the binary buffer. The second has no
//! lengths that a mutation must keep right.

use serde_json::Value;
use svs::gltf::Document;

const GLB: &[u8] = b"glTF";

/// JSON text and binary buffer.
pub(crate) fn split(data: &[u8]) -> (&[u8], &[u8]) {
    if data.starts_with(GLB) && data.len() >= 20 {
        let length = u32::from_le_bytes([data[12], data[13], data[14], data[15]]) as usize;
        let json = &data[20..];
        let (json, rest) = json.split_at(length.min(json.len()));
        return (json, rest.get(8..).unwrap_or_default());
    }
    match data.iter().position(|&byte| byte == 0) {
        Some(end) => (&data[..end], &data[end + 1..]),
        None => (data, &[]),
    }
}

/// Puts together what [`split`] took apart, in the form that `like` has.
pub(crate) fn join(like: &[u8], json: &str, bin: &[u8]) -> Vec<u8> {
    if like.starts_with(GLB) { glb(json, bin) } else { [json.as_bytes(), &[0], bin].concat() }
}

/// A GLB file.
pub(crate) fn glb(json: &str, bin: &[u8]) -> Vec<u8> {
    let chunk = |kind: &[u8], bytes: &[u8], pad: u8| {
        let length = bytes.len().next_multiple_of(4);
        let mut chunk = [&(length as u32).to_le_bytes(), kind, bytes].concat();
        chunk.resize(8 + length, pad);
        chunk
    };
    let chunks = [chunk(b"JSON", json.as_bytes(), b' '), chunk(b"BIN\0", bin, 0)].concat();
    [GLB, &2_u32.to_le_bytes(), &(12 + chunks.len() as u32).to_le_bytes(), &chunks].concat()
}

/// The document of an input. The first buffer is as long as its bytes, or few mutations would get far.
pub(crate) fn document(data: &[u8]) -> Option<Document> {
    if data.starts_with(GLB) {
        return Document::from_glb(data).ok();
    }
    let (json, bin) = split(data);
    let mut json: Value = serde_json::from_slice(json).ok()?;
    if let Some(buffer) = json.pointer_mut("/buffers/0").and_then(Value::as_object_mut)
        && !buffer.contains_key("uri")
    {
        buffer.insert("byteLength".to_owned(), Value::from(bin.len()));
    }
    Document::from_parts(json, Some(bin.to_vec())).ok()
}
