//! Camera path files.

use super::spline::direction;
use super::{CameraPath, CameraPathError, DEFAULT_FOV, Pose};
use glam::DVec3;
use serde_json::{Map, Value, json};
use std::io::{self, Write};
use std::path::Path;

/// Largest file read, in bytes: about half a million poses.
const MAX_BYTES: u64 = 64 << 20;

/// Coordinates beyond this are of no scene.
const MAX_COORDINATE: f64 = 1e18;

impl CameraPath {
    /// Reads a camera or camera path file.
    ///
    /// # Errors
    /// [`CameraPathError`] names what is wrong and where.
    pub fn read(path: &Path) -> Result<CameraPath, CameraPathError> {
        let read = |source| CameraPathError::Read { path: path.to_owned(), source };
        let bytes = std::fs::metadata(path).map_err(read)?.len();
        if bytes > MAX_BYTES {
            return Err(CameraPathError::TooLarge { bytes, limit: MAX_BYTES });
        }
        Self::from_json(&serde_json::from_slice(&std::fs::read(path).map_err(read)?)?)
    }

    /// Writes the path as a file; what was there before stays until the new one is complete.
    ///
    /// # Errors
    /// [`CameraPathError::Write`].
    pub fn write(&self, path: &Path) -> Result<(), CameraPathError> {
        let text = format!("{:#}\n", self.to_json());
        let write = || -> io::Result<()> {
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
            let mut file = tempfile::NamedTempFile::new_in(folder.unwrap_or(Path::new(".")))?;
            file.write_all(text.as_bytes())?;
            file.persist(path).map(drop).map_err(io::Error::from)
        };
        write().map_err(|source| CameraPathError::Write { path: path.to_owned(), source })
    }

    /// The path as the JSON of its file.
    pub fn to_json(&self) -> Value {
        let pose = |pose: &Pose| json!({"eye": pose.eye.to_array(), "forward": pose.forward.to_array()});
        let mut json =
            json!({"version": 1, "name": self.name, "vertical_fov": self.vertical_fov.to_degrees()});
        if let Some(near) = self.near {
            json["near"] = json!(near);
        }
        json["poses"] = self.poses.iter().map(pose).collect();
        json
    }

    /// The path of a file's JSON.
    ///
    /// # Errors
    /// [`CameraPathError::Malformed`] with the JSON pointer of what is wrong.
    pub fn from_json(json: &Value) -> Result<CameraPath, CameraPathError> {
        let file = members(json, "", &["version", "name", "vertical_fov", "near", "poses"])?;
        if file.get("version").and_then(Value::as_u64) != Some(1) {
            return Err(malformed("/version", "1"));
        }
        let name = match file.get("name") {
            None => "",
            Some(name) => name.as_str().ok_or_else(|| malformed("/name", "a string"))?,
        };
        let vertical_fov = match file.get("vertical_fov") {
            None => DEFAULT_FOV,
            Some(value) => {
                let degrees = value.as_f64().filter(|degrees| (0.01..=179.0).contains(degrees));
                degrees
                    .ok_or_else(|| malformed("/vertical_fov", "an angle of 0.01 to 179 degrees"))?
                    .to_radians()
            }
        };
        let near = file.get("near").map(|value| {
            let near = value.as_f64().filter(|near| (1e-12..=MAX_COORDINATE).contains(near));
            near.ok_or_else(|| malformed("/near", "a distance in metres above 0"))
        });
        let poses = file.get("poses").and_then(Value::as_array).filter(|poses| !poses.is_empty());
        let poses = poses.ok_or_else(|| malformed("/poses", "an array of at least one pose"))?;
        let poses: Result<Vec<Pose>, _> =
            poses.iter().enumerate().map(|(index, json)| pose(json, &format!("/poses/{index}"))).collect();
        Ok(CameraPath { name: name.to_owned(), vertical_fov, near: near.transpose()?, poses: poses? })
    }
}

fn pose(json: &Value, pointer: &str) -> Result<Pose, CameraPathError> {
    let pose = members(json, pointer, &["eye", "forward"])?;
    let eye = vector(pose.get("eye"), &format!("{pointer}/eye"))?;
    let place = format!("{pointer}/forward");
    let forward = vector(pose.get("forward"), &place)?;
    // Scaled first: a long vector's length may be infinite, a short one's zero.
    let forward = direction(forward / forward.abs().max_element());
    Ok(Pose { eye, forward: forward.ok_or_else(|| malformed(&place, "a vector that is not zero"))? })
}

fn vector(json: Option<&Value>, pointer: &str) -> Result<DVec3, CameraPathError> {
    let numbers = json.and_then(Value::as_array).filter(|numbers| numbers.len() == 3);
    let component = |index: usize| {
        let number = numbers.and_then(|numbers| numbers[index].as_f64());
        number.filter(|number| number.abs() <= MAX_COORDINATE)
    };
    match [0, 1, 2].map(component) {
        [Some(x), Some(y), Some(z)] => Ok(DVec3::new(x, y, z)),
        _ => Err(malformed(pointer, "three numbers of at most 1e18")),
    }
}

/// An object with none but these members.
fn members<'a>(
    json: &'a Value,
    pointer: &str,
    known: &[&str],
) -> Result<&'a Map<String, Value>, CameraPathError> {
    let object = json.as_object().ok_or_else(|| malformed(pointer, "an object"))?;
    match object.keys().find(|key| !known.contains(&key.as_str())) {
        None => Ok(object),
        Some(key) => {
            let key = key.replace('~', "~0").replace('/', "~1");
            Err(malformed(&format!("{pointer}/{key}"), &format!("no such member, only {}", known.join(", "))))
        }
    }
}

fn malformed(pointer: &str, expected: &str) -> CameraPathError {
    CameraPathError::Malformed { pointer: pointer.to_owned(), expected: expected.to_owned() }
}
