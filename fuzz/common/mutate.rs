//! Changes an input without breaking its form: values of the JSON, and bytes of the buffer.

use super::input::{join, split};
use serde_json::{Value, json};

/// splitmix64: the same numbers everywhere.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }
}

/// For libFuzzer: half of the time its own mutation of the bytes, else [`mutate`]. Returns the new size.
pub(crate) fn in_place(
    data: &mut [u8],
    size: usize,
    max_size: usize,
    seed: u32,
    bytes: fn(&mut [u8], usize, usize) -> usize,
) -> usize {
    if seed % 2 == 1
        && let Some(new) = mutate(&data[..size], &mut Random(u64::from(seed)))
        && new.len() <= max_size
    {
        data[..new.len()].copy_from_slice(&new);
        return new.len();
    }
    bytes(data, size, max_size)
}

/// One to four changes; `None` if the input holds no JSON.
pub(crate) fn mutate(data: &[u8], random: &mut Random) -> Option<Vec<u8>> {
    let (text, bin) = split(data);
    let mut json: Value = serde_json::from_slice(text).ok()?;
    let mut bin = bin.to_vec();
    for _ in 0..=random.below(4) {
        if random.below(4) == 0 {
            change_bytes(&mut bin, random);
        } else {
            change_value(&mut json, random);
        }
    }
    // A GLB knows the length of its buffer.
    if data.starts_with(b"glTF")
        && random.below(8) > 0
        && let Some(length) = json.pointer_mut("/buffers/0/byteLength")
    {
        *length = json!(bin.len());
    }
    Some(join(data, &json.to_string(), &bin))
}

/// Flips bytes that may be anything: as noise in the input's own form.
pub(crate) fn scramble(data: &[u8], random: &mut Random) -> Vec<u8> {
    let mut data = data.to_vec();
    for _ in 0..=random.below(4) {
        change_bytes(&mut data, random);
    }
    data
}

fn change_bytes(bytes: &mut Vec<u8>, random: &mut Random) {
    let at = random.below(bytes.len() + 1);
    match random.below(8) {
        0 => bytes.truncate(at),
        1 => bytes.extend((0..=random.below(64)).map(|_| random.next() as u8)),
        2 => {
            let special = [
                [0, 0, 0x80, 0x7F],
                [0, 0, 0xC0, 0x7F],
                [0xFF; 4],
                [0, 0, 0, 0x80],
                [0xFF, 0xFF, 0x7F, 0x7F],
            ];
            let at = at & !3;
            if let Some(word) = bytes.get_mut(at..at + 4) {
                word.copy_from_slice(&special[random.below(special.len())]);
            }
        }
        _ => {
            if let Some(byte) = bytes.get_mut(at) {
                *byte = [random.next() as u8, 0, 1, 0xFF, byte.wrapping_add(1)][random.below(5)];
            }
        }
    }
}

/// Changes a value of the JSON, of any depth.
pub(crate) fn change_value(json: &mut Value, random: &mut Random) {
    let mut all = Vec::new();
    pointers(json, String::new(), &mut all);
    let other = json.pointer(&all[random.below(all.len())]).cloned().unwrap_or_default();
    let at = &all[random.below(all.len())];
    let Some(place) = json.pointer_mut(at) else { return };
    match random.below(10) {
        // A value from elsewhere in the document; no large ones, or the document would grow and grow.
        0..=2 if other.to_string().len() < 400 => *place = other,
        3 => match place {
            Value::Array(items) => drop(items.pop()),
            Value::Object(members) => {
                let key = members.keys().nth(random.below(members.len())).cloned();
                key.and_then(|key| members.remove(&key));
            }
            _ => *place = Value::Null,
        },
        4 => {
            if let Value::Array(items) = place
                && !items.is_empty()
                && items.len() < 200
            {
                let copy = items[random.below(items.len())].clone();
                items.insert(random.below(items.len() + 1), copy);
            }
        }
        // A neighbour of the value there.
        5 | 6 if place.is_u64() => *place = json!(place.as_u64().unwrap_or(0) ^ (1 << random.below(8))),
        _ => *place = special(random),
    }
}

fn special(random: &mut Random) -> Value {
    const NUMBERS: [&str; 20] = [
        "0",
        "1",
        "2",
        "3",
        "-1",
        "255",
        "256",
        "65535",
        "65536",
        "4294967295",
        "4294967296",
        "18446744073709551615",
        "123456789012345678901234567890",
        "-0.0",
        "0.5",
        "1e-40",
        "1e38",
        "1e300",
        "1e999",
        "5126",
    ];
    match random.below(6) {
        0 => [json!(null), json!(true), json!([]), json!({}), json!([[[0]]]), json!("")][random.below(6)]
            .clone(),
        1 => json!(
            ["icosahedron-1", "1.0", "POSITION", "MASK", "data:,", "VEC3", "~0/~1", "é\u{0}"]
                [random.below(8)]
        ),
        2 => json!(random.below(40)),
        _ => serde_json::from_str(NUMBERS[random.below(NUMBERS.len())]).unwrap_or_default(),
    }
}

/// Every place in a JSON value, as pointers.
fn pointers(value: &Value, at: String, out: &mut Vec<String>) {
    match value {
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(k, v)| pointers(v, format!("{at}/{k}"), out))
        }
        Value::Object(members) => members.iter().for_each(|(key, v)| {
            let key = key.replace('~', "~0").replace('/', "~1");
            pointers(v, format!("{at}/{key}"), out);
        }),
        _ => {}
    }
    out.push(at);
}
