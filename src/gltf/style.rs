//! How the JSON of a .gltf file looks.

use serde::Serialize;
use serde_json::Value;
use serde_json::ser::PrettyFormatter;

/// How the JSON of a .gltf file is laid out, so that a written file looks like the one that was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct JsonStyle {
    /// Indentation of one level; `None` for JSON on a single line.
    indent: Option<String>,
    final_newline: bool,
}

impl Default for JsonStyle {
    /// Two spaces, as most exporters write it.
    fn default() -> Self {
        Self { indent: Some("  ".to_owned()), final_newline: true }
    }
}

impl JsonStyle {
    /// The style of a JSON object: what stands between its brace and its first key.
    pub(super) fn detect(text: &[u8]) -> Self {
        let brace = text.iter().position(|&byte| byte == b'{').map_or(0, |at| at + 1);
        let blank = text[brace..].iter().take_while(|byte| byte.is_ascii_whitespace());
        let blank: String = blank.take(64).map(|&byte| char::from(byte)).collect();
        let indent = blank.rsplit_once('\n').map(|(_, indent)| indent.to_owned());
        Self { indent, final_newline: text.ends_with(b"\n") }
    }

    /// The JSON in this style.
    pub(super) fn text(&self, json: &Value) -> Result<Vec<u8>, serde_json::Error> {
        let mut text = Vec::new();
        match &self.indent {
            None => serde_json::to_writer(&mut text, json)?,
            Some(indent) => {
                let formatter = PrettyFormatter::with_indent(indent.as_bytes());
                json.serialize(&mut serde_json::Serializer::with_formatter(&mut text, formatter))?;
            }
        }
        if self.final_newline {
            text.push(b'\n');
        }
        Ok(text)
    }
}
