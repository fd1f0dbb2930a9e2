//! Paths as frames.

use super::options::{EvaluateOptions, Tour};
use crate::camera_path::{CameraPath, near_plane};
use crate::stage::Stage;
use svs_render::View;

/// The frames of one path.
pub(super) struct Flight {
    pub(super) name: String,
    pub(super) views: Vec<View>,
}

/// The paths of the options, or generated ones. No two have the same name.
pub(super) fn flights(stage: &Stage, options: &EvaluateOptions) -> Vec<Flight> {
    let around = stage.surroundings();
    let paths = match (options.paths.as_slice(), options.tour) {
        ([], Tour::Outside) => vec![CameraPath::outside(&around)],
        ([], Tour::Inspection) => vec![CameraPath::inspection(&around)],
        ([], Tour::Inside) => vec![CameraPath::inside(&around)],
        ([], Tour::Both) => vec![CameraPath::outside(&around), CameraPath::inside(&around)],
        (paths, _) => paths.to_vec(),
    };
    let mut flights: Vec<Flight> = Vec::new();
    for path in paths {
        let wanted = if path.name.is_empty() { "path" } else { &path.name };
        let mut name = wanted.to_owned();
        let mut number = 2;
        while flights.iter().any(|flight| flight.name == name) {
            name = format!("{wanted} {number}");
            number += 1;
        }
        flights.push(Flight { name, views: path.near_or(near_plane(stage.radius())).frames(options.frames) });
    }
    flights
}
