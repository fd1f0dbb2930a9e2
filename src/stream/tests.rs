use super::*;
use crate::bake::{BakeOptions, Silent, build};
use crate::gltf::{Document, payload};
use crate::stage::Stage;
use std::ops::Range;
use std::path::Path;
use svs_render::View;

/// The plant, baked, whose JSON is long enough for a compressed copy.
fn baked() -> Document {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/plant.glb");
    let mut doc = Document::read(&path).expect("the sample");
    let options = BakeOptions { rays: Some(50_000), verify: false, ..BakeOptions::default() };
    build(&mut doc, &options, &Silent).expect("a bake");
    doc
}

fn view(stage: &Stage) -> View {
    let (min, max) = stage.bounds();
    let center = (min + max) * 0.5;
    let eye = center + glam::DVec3::new(0.6, 0.4, 0.7).normalize() * stage.radius() * 2.5;
    View::looking_along(eye, center - eye, 1.0, 0.01)
}

/// Loads a file as a browser would; `cut` alters the ranges asked for. Returns the stage and the bytes fetched until it could
/// be opened.
fn load(file: &[u8], first: usize) -> (Stage, u64) {
    let length = file.len() as u64;
    let mut head = Head::new(length, &file[..first]).expect("a GLB worth it");
    let mut fetched = first as u64;
    let bytes = |range: &Range<u64>| &file[range.start as usize..range.end as usize];
    let mut known = head.known().expect("a head");
    while known.is_none() {
        let wanted = head.wanted();
        assert!(!wanted.is_empty(), "it waits for nothing");
        for range in wanted {
            fetched += range.end - range.start;
            known = head.receive(range.start, bytes(&range)).expect("a head");
        }
    }
    let mut loader = Loader::new(known.expect("a document")).expect("a loader");
    for range in loader.wanted(&[]) {
        fetched += range.end - range.start;
        loader.receive(range.start, bytes(&range)).expect("bytes");
    }
    assert!(loader.can_open());
    let mut stage = loader.open().expect("a stage");
    let view = view(&stage);
    let sizes = loader.mesh_bytes();
    let mut rounds = 0;
    while !loader.is_done() {
        let order = priorities(&mut stage, &view, 640, 480, &sizes);
        for range in loader.wanted(&order) {
            loader.receive(range.start, bytes(&range)).expect("bytes");
        }
        let ready = loader.ready();
        loader.fill(&ready, &mut stage).expect("data");
        rounds += 1;
        assert!(rounds < 10_000, "it never ends");
    }
    (stage, fetched)
}

fn same_data(a: &Stage, b: &Stage) {
    assert_eq!(a.data.objects, b.data.objects);
    assert_eq!(a.data.materials, b.data.materials);
    assert!(a.data.images == b.data.images);
    assert_eq!(a.data.meshes.len(), b.data.meshes.len());
    for (a, b) in a.data.meshes.iter().zip(&b.data.meshes) {
        assert_eq!(a.primitives.len(), b.primitives.len());
        for (a, b) in a.primitives.iter().zip(&b.primitives) {
            assert!(a.positions == b.positions && a.normals == b.normals && a.indices == b.indices);
            assert!(a.uvs == b.uvs && a.colors == b.colors && a.material == b.material);
        }
    }
    assert_eq!(a.order(), b.order());
    assert_eq!(a.triangles(), b.triangles());
}

#[test]
fn arranged_files_load_bit_by_bit_and_come_back() {
    let plain = baked();
    let mut arranged = plain.clone();
    let done = arrange(&mut arranged).expect("an arrangement");
    assert!(done.pieces > 1 && done.index_bytes > 1000, "{done:?}");
    let again = {
        let mut again = arranged.clone();
        arrange(&mut again).expect("an arrangement");
        again.to_glb().expect("a file")
    };
    let files = [plain.to_glb().expect("a file"), arranged.to_glb().expect("a file")];
    assert!(files[1] == again, "arranging twice is arranging once");
    let whole = Stage::open(&plain).expect("a stage");
    let mut before = Vec::new();
    for file in &files {
        for first in [64, 4096] {
            let (stage, fetched) = load(file, first);
            assert!(stage.is_baked() && stage.notice().is_none());
            same_data(&stage, &whole);
            before.push(fetched);
        }
    }
    // The JSON is most of what must come first.
    assert!(before[2] * 2 < before[0], "{before:?}");

    // All but the offsets is as it was, and stripping gives the file that was baked.
    assert!(restore(&mut arranged.clone()).expect("the order of before"));
    let mut stripped = [plain, arranged].map(|mut doc| {
        assert!(payload::strip(&mut doc));
        doc
    });
    let accessors = |doc: &Document| -> Vec<Vec<u8>> {
        let count = doc.json["accessors"].as_array().map_or(0, Vec::len);
        (0..count).map(|index| doc.accessor(index).unwrap().bytes().unwrap().into_owned()).collect()
    };
    assert!(accessors(&stripped[0]) == accessors(&stripped[1]));
    for doc in &mut stripped {
        for view in doc.json["bufferViews"].as_array_mut().unwrap() {
            view.as_object_mut().unwrap().remove("byteOffset");
        }
        doc.json.as_object_mut().unwrap().remove("buffers");
    }
    assert_eq!(stripped[0].json, stripped[1].json);
}

#[test]
fn a_copy_that_disagrees_is_ignored() {
    let mut doc = baked();
    arrange(&mut doc).expect("an arrangement");
    let mut file = doc.to_glb().expect("a file");
    // Another name of the same length, as a tool that keeps the copy might write it.
    let at = file.windows(5).position(|window| window == b"\"name").expect("a name") + 8;
    file[at] = if file[at] == b'x' { b'y' } else { b'x' };
    let (stage, _) = load(&file, 64 << 10);
    let whole = Stage::open(&Document::from_glb(&file).expect("a document")).expect("a stage");
    assert_eq!(stage.names, whole.names);
}

#[test]
fn what_cannot_be_streamed_is_said() {
    let file = baked().to_glb().expect("a file");
    assert!(Head::new(file.len() as u64, b"{\"asset\": {}}").is_none());
    assert!(Head::new(file.len() as u64, &file).is_none(), "there is nothing left to fetch");
    let mut head = Head::new(file.len() as u64, &file[..100]).expect("a head");
    assert!(matches!(head.receive(u64::MAX - 3, &[0; 9]), Err(StreamError::Outside { .. })));
    assert!(matches!(head.receive(file.len() as u64 - 1, &[0; 2]), Err(StreamError::Outside { .. })));
    let mut broken = file.clone();
    broken[24] = 0xFF;
    let mut head = Head::new(broken.len() as u64, &broken[..100]).expect("a head");
    let found = head.receive(100, &broken[100..]);
    assert!(matches!(found, Err(StreamError::Read(_))), "{found:?}");
}
