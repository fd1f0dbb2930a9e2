//! Target `stage`: opens a file as viewers do. Not with the other targets: it needs the feature `render`.

use super::input;
use svs::stage::{ColourMode, Method, Stage};
use svs_render::View;
use svs_runtime::Budget;

/// Opens a file and culls it; everything that may be drawn must be there to be drawn.
pub(crate) fn stage(data: &[u8]) {
    let Some(document) = input::document(data) else { return };
    let Ok(mut stage) = Stage::open(&document) else { return };
    // Proxies and levels come after them.
    assert!(stage.data.objects.len() >= stage.scene.objects.len());
    for mesh in &stage.data.meshes {
        for primitive in &mesh.primitives {
            let count = primitive.positions.len();
            assert!(primitive.indices.iter().all(|&index| (index as usize) < count));
            assert!(primitive.positions.iter().flatten().all(|x| x.is_finite()));
            for length in [primitive.normals.len(), primitive.colors.len(), primitive.uvs.len()] {
                assert!(length == 0 || length == count);
            }
            assert!((primitive.material as usize) < stage.data.materials.len());
        }
    }
    let surroundings = stage.surroundings();
    let eye = surroundings.sphere.center + surroundings.sphere.radius * 2.0;
    let view = View::looking_along(eye, surroundings.sphere.center - eye, 1.0, 0.01);
    let (settings, objects) = (stage.recommended(), stage.scene.objects.len() as u32);
    for (method, budget) in Method::ALL.iter().zip([Budget::Unlimited, Budget::Triangles(3)].iter().cycle()) {
        let drawn = stage.cull(&view, 64, 36, *method, &settings, budget);
        assert!(drawn.iter().all(|&object| object < objects));
    }
    for mode in ColourMode::ALL {
        assert_eq!(stage.tints(mode).len(), stage.data.objects.len());
    }
}
