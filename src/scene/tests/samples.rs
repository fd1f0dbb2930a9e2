//! The sample scenes, where they are there: counts as their table states them.

use crate::gltf::Document;
use crate::scene::{ReadOptions, Role, read_scene};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// File, objects, triangles with every instance counted, distinct meshes.
const SCENES: [(&str, usize, u64, usize); 10] = [
    ("lego-millennium-falcon/lego-millennium-falcon.glb", 5_163, 5_374_975, 263),
    ("two-cylinder-engine/2CylinderEngine.glb", 67, 121_496, 29),
    ("lhcb-detector/lhcb-detector.glb", 12_916, 747_729, 623),
    ("atlas-detector/atlas-detector.glb", 15_000, 857_034, 15_000),
    ("medical-clinic/medical-clinic.glb", 9_486, 1_354_230, 9_486),
    ("schependomlaan-apartments/schependomlaan-apartments.glb", 5_559, 462_586, 2_426),
    ("duplex-apartment/duplex-apartment.glb", 1_141, 360_979, 1_141),
    ("linz-city/linz-city.glb", 15_243, 799_987, 15_243),
    ("black-forest/black-forest.glb", 2_753, 1_085_633, 1_227),
    ("facing-giants-level/facing-giants-level.glb", 1_338, 58_605, 1_338),
];

/// `SVS_SCENES`, else `shared/scenes` beside the sources or in the folder above.
fn folder() -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    match std::env::var_os("SVS_SCENES") {
        Some(folder) => folder.into(),
        None if root.join("shared/scenes").is_dir() => root.join("shared/scenes"),
        None => root.join("../shared/scenes"),
    }
}

#[test]
fn sample_scenes_have_the_counts_of_their_table() {
    SCENES.into_par_iter().for_each(|(file, objects, triangles, meshes)| {
        let path = folder().join(file);
        if !path.is_file() {
            eprintln!("skipped: {} is not there", path.display());
            return;
        }
        let doc = Document::read(&path).unwrap();
        let scene = read_scene(&doc, &ReadOptions::default()).unwrap();
        let drawn: u64 =
            scene.objects.iter().map(|o| u64::from(scene.meshes[o.mesh as usize].drawn_triangles)).sum();
        assert_eq!((scene.objects.len(), drawn, scene.meshes.len()), (objects, triangles, meshes), "{file}");
        super::properties::check(&scene);
        let excluded = scene.objects.iter().filter(|o| o.role == Role::Excluded).count();
        let notes: Vec<_> = scene.notes.iter().map(|n| (n.code, n.count)).collect();
        eprintln!("{file}: {excluded} objects left out, notes {notes:?}");
        assert_eq!(excluded, 0, "{file}: {notes:?}");
    });
}
