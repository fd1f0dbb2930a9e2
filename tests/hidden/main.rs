//! What `svs::hidden` removes, and what it must not.

mod brute_force;
mod builder;
mod bytes;
mod kept;
mod regions;
mod triangles;

use builder::Builder;
use svs::bake::Silent;
use svs::gltf::Document;
use svs::hidden::{HiddenOptions, HiddenReport, RemoveMode, remove};

/// Few rays: these scenes are small.
fn options(mode: RemoveMode, clearance: Option<f64>) -> HiddenOptions {
    HiddenOptions { mode, clearance, rays: Some(1 << 19), ..HiddenOptions::default() }
}

/// Names of the nodes that have a mesh.
fn drawn(document: &Document) -> Vec<&str> {
    let nodes = document.json["nodes"].as_array().expect("nodes").iter();
    nodes
        .filter(|node| node.get("mesh").is_some())
        .map(|node| node["name"].as_str().expect("a name"))
        .collect()
}

/// Removes objects; the names of what stays.
fn left(builder: &Builder, clearance: Option<f64>) -> (Vec<String>, HiddenReport, Document) {
    let mut document = builder.document();
    let report =
        remove(&mut document, &options(RemoveMode::Objects, clearance), &Silent).expect("a readable scene");
    (drawn(&document).into_iter().map(str::to_owned).collect(), report, document)
}
