//! svs-runtime for JavaScript.
use svs_runtime::*;
use wasm_bindgen::prelude::*;

struct A(Vec<(Vec<u8>, u32, u32, usize)>);
impl AccessorSource for A {
    fn accessor(&self, index: usize) -> Option<AccessorView<'_>> {
        let (bytes, component_type, components, count) = self.0.get(index)?;
        Some(AccessorView { bytes, component_type: *component_type, components: *components, count: *count })
    }
}
#[wasm_bindgen]
pub struct S {
    c: SceneCuller,
    m: CostModel,
}
#[wasm_bindgen]
impl S {
    #[wasm_bindgen(constructor)]
    pub fn new(json: &str, bytes: Vec<u8>) -> Result<S, JsError> {
        let v = Visibility::decode_json(json, &A(vec![(bytes, 5121, 1, 2)]))?;
        Ok(S { c: SceneCuller::new::<Vec<Bounds>>(&v, &[])?, m: CostModel::new() })
    }
    pub fn cull(&mut self, m: &[f64], q: f32, t: f64, b: f64) -> u32 {
        let vp = glam::DMat4::from_cols_slice(m);
        let cam = Camera::from_view_projection(vp, glam::DVec3::new(m[16], m[17], m[18]), m[19]);
        let s = Settings::from_quality(q);
        let budget = if b > 0.0 { Budget::Triangles(b as u64) } else { Budget::Milliseconds(t, &self.m) };
        self.c.select(&cam, &s, &Detail { tau: q, metric: Metric::Sse }, &budget).len() as u32
    }
    pub fn rec(&mut self, m: f64) {
        self.m.record(3, 4, m);
    }
    pub fn hid(&mut self, t: u32, o: u32) {
        self.c.set_hidden(Draw { tree: t, anchor: 0, object: o }, true);
    }
}
