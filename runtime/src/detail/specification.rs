//! The worked example of the extension's specification.

use super::frame::Content;
use super::view::{Scene, nodes};
use super::{Detail, Level, Metric, SelectedKind};
use crate::bounds::Bounds;
use crate::budget::Budget;
use crate::camera::Camera;
use crate::decode::Visibility;
use crate::proxies::ProxyTables;
use crate::query::Settings;
use crate::scene::SceneCuller;
use crate::tables::TreeTables;
use crate::tree::{Placement, Tree};
use glam::{DVec3, Vec3};

const README: &str = include_str!("../../../schema/EXT_spherical_visibility/README.md");

/// Cells of the table of the worked example whose header begins like this.
fn table(header: &str) -> Vec<Vec<&'static str>> {
    let text = &README[README.find("### A Cut").unwrap()..];
    let text = &text[text.find(&format!("\n| {header}")).unwrap() + 1..];
    let rows = text.lines().take_while(|line| line.starts_with('|')).skip(2);
    rows.map(|row| row.trim_matches('|').split('|').map(str::trim).collect()).collect()
}

fn number(text: &str) -> f64 {
    text.replace('−', "-").parse().unwrap_or_else(|_| panic!("{text:?} is no number"))
}

fn point(text: &str) -> Vec3 {
    let parts: Vec<f32> = text.trim_matches(['(', ')']).split(", ").map(|part| number(part) as f32).collect();
    Vec3::from_slice(&parts)
}

fn hexadecimal(text: &str) -> u8 {
    u8::from_str_radix(text.trim_matches('`'), 16).unwrap()
}

fn culler() -> SceneCuller {
    let (objects, proxies) = (table("Object |"), table("Proxy |"));
    let tables = TreeTables {
        placement: Placement::Scene(0),
        directions: "octahedron".to_owned(),
        object_count: 4,
        node_sphere: vec![[0.0, 0.0, 0.0, 12.0]],
        node_subtree: vec![1],
        node_first_object: vec![0],
        node_object_count: vec![4],
        object_order: None,
        level_bits: 1,
        level_row: objects.iter().map(|row| hexadecimal(row[3])).collect(),
        level_row_index: None,
        importance_area: 4.0,
        importance: objects.iter().map(|row| number(row[4]) as u8).collect(),
        proxies: Some(ProxyTables {
            visible: true,
            sphere: proxies
                .iter()
                .map(|row| point(row[1]).extend(number(row[2]) as f32).to_array())
                .collect(),
            subtree: vec![2, 1],
            first_object: vec![0, 1],
            object_count: vec![4, 3],
            object: None,
            error: proxies.iter().map(|row| number(row[3]) as f32).collect(),
            deviation: None,
            mesh: vec![0, 1],
            origin: vec![[0.0; 3]; 2],
        }),
        nested: Vec::new(),
        recommended_quality: None,
        fingerprint: None,
    };
    let visibility = Visibility::new(vec![Tree::new(tables).unwrap()]).unwrap();
    let boxes = objects.iter().map(|row| Bounds { min: point(row[1]) - 1.0, max: point(row[1]) + 1.0 });
    let mut culler = SceneCuller::new(&visibility, &[boxes.collect::<Vec<_>>()]).unwrap();
    let triangles = |rows: &[Vec<&str>], column: usize| -> Vec<u32> {
        rows.iter().map(|row| number(row[column]) as u32).collect()
    };
    culler.set_triangles(0, &triangles(&objects, 2)).unwrap();
    culler.set_proxy_triangles(0, &triangles(&proxies, 4)).unwrap();
    culler.set_levels(0, &[0, 1, 1, 1, 1], &[Level::new(800, 0.05)]).unwrap();
    culler
}

fn camera() -> Camera {
    let view = glam::dcamera::rh::view::look_at_mat4(DVec3::new(0.0, 0.0, 20.0), DVec3::ZERO, DVec3::Y);
    Camera::perspective(view, 2.0 * 0.5_f64.atan(), 1000.0, 1000.0, 0.1)
}

/// A number of the text is the one that is computed, to the digits it is given in.
#[track_caller]
fn same(text: &str, value: f64) {
    let digits = text.split_once('.').map_or(0, |(_, digits)| digits.len());
    assert_eq!(text, format!("{value:.digits$}"), "{value}");
}

#[test]
fn the_numbers_of_the_worked_example() {
    let mut culler = culler();
    let detail = Detail { tau: 1.0, metric: Metric::default() };
    culler.select(&camera(), &Settings::NEAREST_O, &detail, &Budget::Unlimited);
    let state = &culler.detail;
    let scene = Scene {
        placed: &culler.placed,
        loose: &culler.loose,
        tables: &state.tables,
        candidates: &culler.within.candidates,
        detail,
        clip: true,
    };
    let layout = &state.frame.layout;
    let entry = &layout.entries[0];
    let rows = table("| Visible");
    let value = |row: &[&str], pixels: f64, loss: f64| {
        same(row[7], 1.0 - loss);
        same(row[8], pixels * (1.0 - loss));
    };
    for (slot, row) in rows[..3].iter().enumerate() {
        let Content::Object(candidate) = layout.slots[slot].content() else { panic!("no object") };
        let object = scene.object(entry, candidate);
        same(row[1], object.pixels);
        if slot == 0 {
            same(row[2], object.pixels);
            same(row[4], object.ratio);
            same(row[5], object.distance);
            same(row[6], scene.level_error(&object, 1));
        }
        value(row, object.pixels, scene.level_loss(&object, u8::from(slot == 0)));
    }
    for (node, row) in rows[3..].iter().enumerate() {
        let proxy = &nodes(scene.placed, entry)[node];
        let view = scene.view(layout, entry, node as u32, layout.slots_of(entry, proxy.objects())).unwrap();
        let mu = scene.placed[0].instance.boxes.proxy(node as u32).mu(view.pixels, &entry.local, true);
        same(row[1], view.pixels);
        same(row[2], view.pixels / mu);
        same(row[3], mu);
        same(row[4], view.ratio);
        same(row[5], (camera().eye() - proxy.center.as_dvec3()).length() - f64::from(proxy.radius));
        same(row[6], view.error);
        value(row, view.shown, view.loss);
    }
}

#[test]
fn the_cuts_of_the_worked_example() {
    let mut culler = culler();
    for row in table("tau |") {
        let detail = Detail { tau: number(row[0]) as f32, metric: Metric::default() };
        let budget = match row[1] {
            "none" => Budget::Unlimited,
            most => Budget::Triangles(most.parse().unwrap()),
        };
        culler.cull(&camera(), &Settings::NEAREST_O);
        let selected = culler.select(&camera(), &Settings::NEAREST_O, &detail, &budget);
        let names: Vec<String> = selected
            .iter()
            .map(|s| match s.kind {
                SelectedKind::Object => format!("object {}", s.draw.object),
                SelectedKind::Level(level) => format!("level {level} of object {}", s.draw.object),
                SelectedKind::Proxy => format!("proxy {}", s.draw.object),
            })
            .collect();
        // "objects 0, 1, 2" is short for each by itself.
        let drawn = row[2].replace("objects 0, 1, 2", "object 0, object 1, object 2");
        assert_eq!(names.join(", "), drawn, "{row:?}");
        assert_eq!(culler.detail_statistics().triangles.to_string(), row[3], "{row:?}");
    }
}
