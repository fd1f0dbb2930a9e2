//! What JavaScript sees. Input and output of a frame are arrays in the module's memory: no garbage.

use crate::bake::{Accessor, Bake, MeshLevelsTable, TreeNumbers};
use crate::cull::Limit;
use crate::describe::{Description, affine};
use crate::scene::Scene;
use glam::{DMat4, DVec3};
use wasm_bindgen::prelude::wasm_bindgen;

/// Takes the parts of a file.
#[wasm_bindgen]
#[derive(Debug, Default)]
pub struct SceneBuilder {
    bake: Bake,
    description: Description,
}

#[wasm_bindgen]
impl SceneBuilder {
    /// Nothing yet. `version` is that of the extension.
    #[wasm_bindgen(constructor)]
    pub fn new(version: String) -> Self {
        Self { bake: Bake { version, ..Bake::default() }, description: Description::default() }
    }

    /// The next accessor, by ascending index.
    pub fn accessor(&mut self, index: u32, component_type: u32, components: u32, count: u32, bytes: Vec<u8>) {
        self.bake.accessors.push(Accessor { index, component_type, components, count, bytes });
    }

    /// The next tree, see [`TreeNumbers`].
    pub fn tree(
        &mut self,
        directions: String,
        hash: String,
        numbers: Vec<f64>,
        anchors: Vec<u32>,
        nested: Vec<u32>,
    ) {
        self.bake.trees.push(TreeNumbers { directions, anchors, numbers, nested, hash });
    }

    /// The next of `meshLevels`.
    #[wasm_bindgen(js_name = meshLevels)]
    pub fn mesh_levels(&mut self, mesh: u32, meshes: Vec<u32>, errors: Vec<f64>) {
        self.bake.mesh_levels.push(MeshLevelsTable { mesh, meshes, errors });
    }

    /// The scene's nodes, see [`Description`].
    pub fn nodes(&mut self, scene: u32, nodes: Vec<u32>, parents: Vec<i32>, matrices: Vec<f64>) {
        let old = std::mem::take(&mut self.description);
        self.description = Description { scene, nodes, parents, matrices, ..old };
    }

    /// The scene's objects, see [`Description`].
    pub fn objects(
        &mut self,
        nodes: Vec<u32>,
        meshes: Vec<u32>,
        of_instances: Vec<i32>,
        instances: Vec<f64>,
    ) {
        let description = &mut self.description;
        (description.object_nodes, description.object_meshes) = (nodes, meshes);
        (description.object_instances, description.instances) = (of_instances, instances);
    }

    /// The document's meshes, see [`Description`].
    pub fn meshes(&mut self, triangles: Vec<u32>, boxes: Vec<f64>) {
        (self.description.mesh_triangles, self.description.mesh_boxes) = (triangles, boxes);
    }

    /// Puts all together; an error's text is thrown.
    pub fn build(self) -> Result<SceneHandle, String> {
        let scene = Scene::new(&self.description, &self.bake).map_err(|error| error.to_string())?;
        Ok(SceneHandle { scene, camera: [0.0; 20], figures: [0.0; 9], limit: Limit::None })
    }
}

/// A scene with baked visibility.
#[wasm_bindgen]
#[derive(Debug)]
pub struct SceneHandle {
    scene: Scene,
    /// View-projection matrix by columns, eye, pixels per radian.
    camera: [f64; 20],
    figures: [f64; 9],
    limit: Limit,
}

#[wasm_bindgen]
impl SceneHandle {
    /// Where the camera is written to: see [`Self::cull`].
    #[wasm_bindgen(js_name = cameraPointer)]
    pub fn camera_pointer(&self) -> *const f64 {
        self.camera.as_ptr()
    }

    /// Where the figures are read from, see [`Self::cull`].
    #[wasm_bindgen(js_name = figuresPointer)]
    pub fn figures_pointer(&self) -> *const f64 {
        self.figures.as_ptr()
    }

    /// Where the answer is read from; it may move with each [`Self::cull`].
    #[wasm_bindgen(js_name = idsPointer)]
    pub fn ids_pointer(&self) -> *const u32 {
        self.scene.ids.as_ptr()
    }

    /// Culls for the camera that was written; returns how many things are drawn.
    pub fn cull(&mut self) -> u32 {
        let view_projection = DMat4::from_cols_slice(&self.camera[..16]);
        let eye = DVec3::from_slice(&self.camera[16..19]);
        self.scene.cull(view_projection, eye, self.camera[19], self.limit);
        let statistics = self.scene.statistics();
        self.figures = [
            statistics.candidates as f64,
            statistics.candidate_triangles as f64,
            statistics.drawn as f64,
            statistics.proxies as f64,
            statistics.levels as f64,
            statistics.triangles as f64,
            statistics.dropped_pixels,
            statistics.spheres_used as f64,
            statistics.objects_tested as f64,
        ];
        statistics.drawn as u32
    }

    /// Quality 0 to 1; less than 0 for frustum culling alone.
    #[wasm_bindgen(js_name = setQuality)]
    pub fn set_quality(&mut self, quality: f32) {
        if quality < 0.0 { self.scene.set_frustum_only() } else { self.scene.set_quality(quality) }
    }

    /// Largest error in pixels, and whether only its visible share counts.
    #[wasm_bindgen(js_name = setDetail)]
    pub fn set_detail(&mut self, tau: f32, by_visibility: bool) {
        self.scene.set_detail(tau, by_visibility);
    }

    /// Triangles or milliseconds per frame; the one that is not finite does not count.
    #[wasm_bindgen(js_name = setBudget)]
    pub fn set_budget(&mut self, triangles: f64, milliseconds: f64) {
        self.limit = if triangles.is_finite() {
            Limit::Triangles(triangles as u64)
        } else if milliseconds.is_finite() {
            Limit::Milliseconds(milliseconds)
        } else {
            Limit::None
        };
    }

    /// Where the scene is in the world: sixteen numbers by columns.
    #[wasm_bindgen(js_name = setRoot)]
    pub fn set_root(&mut self, matrix: &[f64]) {
        if let Some(to_world) = affine(matrix) {
            self.scene.set_root(to_world);
        }
    }

    /// Moves the node at a place: sixteen numbers by columns, relative to its parent.
    #[wasm_bindgen(js_name = setNode)]
    pub fn set_node(&mut self, place: u32, matrix: &[f64]) {
        if let Some(local) = affine(matrix) {
            self.scene.set_node(place, local);
        }
    }

    /// Hides an object or shows it again.
    #[wasm_bindgen(js_name = setHidden)]
    pub fn set_hidden(&mut self, object: u32, hidden: bool) {
        self.scene.set_hidden(object, hidden);
    }

    /// Learns from a frame.
    pub fn record(&mut self, milliseconds: f64) {
        self.scene.record(milliseconds);
    }

    /// Quality that the file recommends, or -1.
    #[wasm_bindgen(js_name = recommendedQuality)]
    pub fn recommended_quality(&self) -> f32 {
        self.scene.recommended_quality().unwrap_or(-1.0)
    }

    /// Why the proxies are not used.
    pub fn notice(&self) -> Option<String> {
        self.scene.notice().map(str::to_owned)
    }

    /// For each object 1 if a tree decides about it, 2 if it has been moved out of its tree, else 0.
    pub fn states(&self) -> Vec<u8> {
        let state = |object: u32| match (self.scene.is_baked(object), self.scene.is_released(object)) {
            (false, _) => 0,
            (true, false) => 1,
            (true, true) => 2,
        };
        (0..self.scene.object_count() as u32).map(state).collect()
    }

    /// Mesh, object and node of everything that is drawn in place of objects, see [`crate::Extra`].
    pub fn extras(&self) -> Vec<u32> {
        self.scene.extras().iter().flat_map(|extra| [extra.mesh, extra.object, extra.node]).collect()
    }

    /// Their origins.
    #[wasm_bindgen(js_name = extraOrigins)]
    pub fn extra_origins(&self) -> Vec<f32> {
        self.scene.extras().iter().flat_map(|extra| extra.origin).collect()
    }
}
