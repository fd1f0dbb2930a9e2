//! What the page sees of the module.

use crate::frame::{Eye, Painter};
use crate::open::Open;
use crate::pick::Pick;
use crate::settings::{Controls, Limit};
use crate::surface::CanvasSurface;
use glam::DVec3;
use serde_json::json;
use svs::rig::{Motion, Rig};
use svs::stage::Method;
use svs::stream::{Head, Loader};
use svs_render::{Frame, Gpu, Image, View, wgpu};
use wasm_bindgen::prelude::*;
use web_sys::HtmlCanvasElement;

/// A canvas, a GPU, a camera and at most one file.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Viewer {
    gpu: Gpu,
    surface: CanvasSurface,
    painter: Painter,
    rig: Rig,
    open: Option<Open>,
    controls: Controls,
    motion: Motion,
    /// Time of the frame before, milliseconds.
    before: Option<f64>,
    /// Something changed that the picture shows.
    dirty: bool,
    /// Draws all the time.
    continuous: bool,
    pick: Option<Pick>,
    arriving: Arriving,
    files: u32,
}

/// An image that the browser decodes: it has decoders for all formats of glTF.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Undecoded {
    place: u32,
    bytes: Vec<u8>,
}

#[wasm_bindgen]
impl Undecoded {
    /// What it is to the viewer.
    #[wasm_bindgen(getter)]
    pub fn place(&self) -> u32 {
        self.place
    }

    /// The file.
    #[wasm_bindgen(getter)]
    pub fn bytes(&self) -> Vec<u8> {
        self.bytes.clone()
    }
}

/// A file on its way.
#[derive(Debug)]
enum Arriving {
    Nothing,
    Head(Head),
    Loader(Loader),
    /// It is what is open.
    Open,
}

fn wrong(error: impl std::fmt::Display) -> JsError {
    JsError::new(&error.to_string())
}

/// Milliseconds since the page was opened.
fn now() -> f64 {
    web_sys::window().and_then(|window| window.performance()).map_or(0.0, |performance| performance.now())
}

#[wasm_bindgen]
impl Viewer {
    /// Finds a GPU for a canvas.
    ///
    /// # Errors
    /// When the browser gives none.
    pub async fn create(canvas: HtmlCanvasElement) -> Result<Viewer, JsError> {
        let size = [canvas.width(), canvas.height()];
        let descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        let instance = wgpu::Instance::new(descriptor);
        let surface = instance.create_surface(wgpu::SurfaceTarget::Canvas(canvas));
        let surface = surface.map_err(|error| JsError::new(&error.to_string()))?;
        let gpu = Gpu::new(instance, Some(&surface)).await;
        let gpu = gpu.map_err(|error| JsError::new(&error.to_string()))?;
        let surface = CanvasSurface::new(&gpu, surface, size)?;
        let painter = Painter::new(&gpu, surface.format());
        let rig = Rig::new(DVec3::splat(-1.0), DVec3::ONE);
        Ok(Self {
            gpu,
            surface,
            painter,
            rig,
            open: None,
            controls: Controls::default(),
            motion: Motion::default(),
            before: None,
            dirty: true,
            continuous: false,
            pick: None,
            arriving: Arriving::Nothing,
            files: 0,
        })
    }

    /// Opens a whole file.
    ///
    /// # Errors
    /// When it cannot be read; what was open stays.
    pub fn open(&mut self, bytes: &[u8]) -> Result<(), JsError> {
        let open = Open::whole(&self.gpu, bytes).map_err(|error| JsError::new(&error))?;
        self.put(open);
        Ok(())
    }

    /// Starts to load a GLB of `length` bytes bit by bit, with its first bytes; false if it is to be opened as a whole.
    ///
    /// # Errors
    /// When it is broken already.
    pub fn stream(&mut self, length: f64, first: &[u8]) -> Result<bool, JsError> {
        self.arriving = Arriving::Nothing;
        let Some(mut head) = Head::new(length as u64, first) else { return Ok(false) };
        self.arriving = match head.known().map_err(wrong)? {
            Some(known) => Arriving::Loader(Loader::new(known).map_err(wrong)?),
            None => Arriving::Head(head),
        };
        Ok(true)
    }

    /// Takes bytes of the file that [`Self::stream`] began; says whether there is something to see from now on.
    ///
    /// # Errors
    /// When the file is broken; what was open before it stays.
    pub fn receive(&mut self, at: f64, bytes: &[u8]) -> Result<bool, JsError> {
        let at = at as u64;
        self.arriving = match std::mem::replace(&mut self.arriving, Arriving::Nothing) {
            Arriving::Nothing => return Ok(false),
            Arriving::Open => {
                if let Some(open) = &mut self.open {
                    open.receive(at, bytes).map_err(wrong)?;
                }
                self.arriving = Arriving::Open;
                return Ok(true);
            }
            Arriving::Head(mut head) => match head.receive(at, bytes).map_err(wrong)? {
                Some(known) => Arriving::Loader(Loader::new(known).map_err(wrong)?),
                None => Arriving::Head(head),
            },
            Arriving::Loader(mut loader) => {
                loader.receive(at, bytes).map_err(wrong)?;
                Arriving::Loader(loader)
            }
        };
        match std::mem::replace(&mut self.arriving, Arriving::Open) {
            Arriving::Loader(loader) if loader.can_open() => {
                self.put(Open::streamed(loader).map_err(wrong)?);
                self.arriving = Arriving::Open;
                Ok(true)
            }
            other => {
                self.arriving = other;
                Ok(false)
            }
        }
    }

    /// What to fetch next, pairs of first byte and one past the last; empty if all is there or on its way.
    pub fn wanted(&mut self) -> Vec<f64> {
        let eye = self.eye();
        let ranges = match &mut self.arriving {
            Arriving::Nothing => Vec::new(),
            Arriving::Head(head) => head.wanted(),
            Arriving::Loader(loader) => loader.wanted(&[]),
            Arriving::Open => {
                self.open.as_mut().map_or_else(Vec::new, |open| open.wanted(&eye.view, eye.size))
            }
        };
        ranges.into_iter().flat_map(|range| [range.start as f64, range.end as f64]).collect()
    }

    /// There is more to show than the last frame did.
    pub fn pending(&self) -> bool {
        let awaits = self.open.as_ref().is_some_and(|open| open.awaited > 0);
        self.dirty || self.pick.is_some() || self.motion.moves() || awaits
    }

    /// The next image that the page is to decode: its place, and its encoded bytes.
    pub fn next_image(&mut self) -> Option<Undecoded> {
        let (place, bytes) = self.open.as_mut()?.next_image()?;
        Some(Undecoded { place, bytes })
    }

    /// Takes a decoded image, four bytes a texel, rows from the top; without texels it stays white. An image of a file that is
    /// not open any more must not come: tell it by [`Self::file`].
    ///
    /// # Errors
    /// When the GPU has no room for it.
    pub fn set_image(
        &mut self,
        place: u32,
        width: u32,
        height: u32,
        rgba: Option<Vec<u8>>,
    ) -> Result<(), JsError> {
        let image = rgba.map(|rgba| Image { width, height, rgba });
        if let Some(open) = &mut self.open
            && open.set_image(&self.gpu, place, image).map_err(wrong)?
        {
            self.painter.forget_tints();
            self.dirty = true;
        }
        Ok(())
    }

    /// Counts the files that were opened.
    pub fn file(&self) -> u32 {
        self.files
    }

    fn put(&mut self, open: Open) {
        self.arriving = Arriving::Nothing;
        let (min, max) = open.stage.bounds();
        self.rig = Rig::new(min, max);
        self.rig.frame(None, self.aspect());
        self.open = Some(open);
        self.files += 1;
        self.controls.selected = None;
        self.controls.freeze = false;
        self.painter.forget_tints();
        self.pick = None;
        self.dirty = true;
    }

    /// The canvas has another size, pixels.
    pub fn resize(&mut self, width: u32, height: u32) {
        self.surface.resize(&self.gpu, [width, height]);
        self.dirty = true;
    }

    /// Draws if there is anything new to see; says whether it did. `time` is that of the animation frame, milliseconds.
    ///
    /// # Errors
    /// When more of a file came and the GPU has no room for it.
    pub fn frame(&mut self, time: f64) -> Result<bool, JsError> {
        let seconds = self.before.replace(time).map_or(0.0, |before| (time - before) * 1e-3);
        if self.motion.moves() {
            self.rig.advance(&self.motion, seconds, false);
            self.dirty = true;
        }
        // Reading back goes on in here where the GPU is WebGL2.
        if self.pick.is_some() {
            let _ = self.gpu.device.poll(wgpu::PollType::Poll);
        }
        let eye = self.eye();
        let Some(open) = &mut self.open else { return Ok(false) };
        if open.is_loading() && open.advance(&self.gpu).map_err(wrong)? {
            self.painter.forget_tints();
            self.dirty = true;
        }
        if !(self.dirty || self.continuous) {
            self.painter.pause();
            return Ok(false);
        }
        self.painter.cull(open, eye, &self.controls, now);
        let drawn = self.painter.draw(&self.gpu, &mut self.surface, open, eye, &self.controls, now);
        self.dirty = !drawn && open.gpu_scene.is_some();
        Ok(drawn)
    }

    /// Draws every frame, needed or not: for measurements.
    pub fn set_continuous(&mut self, on: bool) {
        self.continuous = on;
    }

    fn eye(&self) -> Eye {
        Painter::view_of(&self.rig, self.surface.size())
    }

    fn aspect(&self) -> f64 {
        let [width, height] = self.surface.size();
        f64::from(width) / f64::from(height)
    }

    /// Name and interface of the GPU.
    pub fn gpu(&self) -> String {
        self.gpu.description()
    }

    /// The file and the last frame, as JSON.
    pub fn figures(&self) -> String {
        let figures = &self.painter.figures;
        let view = self.rig.view();
        let [width, height] = self.surface.size();
        let stage = self.open.as_ref().map(|open| &open.stage);
        json!({
            "objects": stage.map_or(0, |stage| stage.scene.objects.len()),
            "sceneTriangles": stage.map_or(0, |s| s.triangles().iter().map(|&t| u64::from(t)).sum::<u64>()),
            "baked": stage.is_some_and(svs::stage::Stage::is_baked),
            "hasProxies": stage.is_some_and(svs::stage::Stage::has_proxies),
            "notice": stage.and_then(svs::stage::Stage::notice),
            "frames": figures.frames,
            "drawnObjects": figures.objects,
            "triangles": figures.triangles,
            "draws": figures.draws,
            "cullUs": figures.cull_us,
            "frameMs": figures.frame_ms,
            "encodeMs": figures.encode_ms,
            "proxies": figures.proxies,
            "simplified": figures.simplified,
            "estimatedMissingPpm": figures.dropped_pixels / (f64::from(width) * f64::from(height)) * 1e6,
            "loading": self.open.as_ref().is_some_and(Open::is_loading),
            "recommended": stage.filter(|s| s.is_baked()).map(|s| s.recommended_quality()),
            "hidden": self.open.as_ref().map_or(0, |open| open.hidden.len()),
            "gpuBytes": self.open.as_ref().and_then(|o| o.gpu_scene.as_ref()).map_or(0, |scene| scene.bytes()),
            "width": width,
            "height": height,
            "camera": { "eye": view.eye.to_array(), "forward": view.forward.to_array() },
            "method": self.controls.method.name(),
            "quality": self.controls.quality,
            "freeze": self.controls.freeze,
        })
        .to_string()
    }

    /// Where the scene lies: smallest and largest corner, metres.
    pub fn bounds(&self) -> Vec<f64> {
        let open = self.open.as_ref().map(|open| open.stage.bounds());
        open.map_or_else(Vec::new, |(min, max)| [min.to_array(), max.to_array()].concat())
    }

    /// Puts the camera somewhere (metres), looking along a vector of any length.
    #[allow(clippy::too_many_arguments, reason = "two vectors of the page")]
    pub fn set_camera(&mut self, x: f64, y: f64, z: f64, dx: f64, dy: f64, dz: f64, fov: f64, near: f64) {
        let now = self.rig.view();
        let forward = DVec3::new(dx, dy, dz).try_normalize().unwrap_or(now.forward);
        let pick = |wanted: f64, old: f64| if wanted > 0.0 { wanted } else { old };
        let view = View {
            eye: DVec3::new(x, y, z),
            forward,
            vertical_fov: pick(fov, now.vertical_fov),
            near: pick(near, now.near),
            ..now
        };
        self.rig.set_view(&view);
        self.dirty = true;
    }

    /// A drag that turns, pixels.
    pub fn drag(&mut self, right: f64, down: f64) {
        self.rig.drag(right, down, f64::from(self.surface.size()[1]));
        self.dirty = true;
    }

    /// A drag that shifts, pixels.
    pub fn pan(&mut self, right: f64, down: f64) {
        self.rig.pan(right, down, f64::from(self.surface.size()[1]));
        self.dirty = true;
    }

    /// Nearer (positive) or farther, in notches of a wheel.
    pub fn wheel(&mut self, notches: f64) {
        self.rig.wheel(notches);
        self.dirty = true;
    }

    /// Which way held keys move, -1 to 1 along each axis.
    pub fn move_by(&mut self, right: f64, up: f64, ahead: f64, faster: bool) {
        let finite = |value: f64| if value.is_finite() { value.clamp(-1.0, 1.0) } else { 0.0 };
        self.motion = Motion { right: finite(right), up: finite(up), ahead: finite(ahead), faster };
    }

    /// Shows the whole scene, or the selected object.
    pub fn frame_all(&mut self, selection: bool) {
        let bounds = match (&self.open, self.controls.selected) {
            (Some(open), Some(object)) if selection => Some(open.stage.object_bounds(object)),
            _ => None,
        };
        self.rig.frame(bounds, self.aspect());
        self.dirty = true;
    }

    /// "nothing", "frustum" or "visibility".
    ///
    /// # Errors
    /// For any other name.
    pub fn set_method(&mut self, name: &str) -> Result<(), JsError> {
        let method: Method = name.parse().map_err(|_| JsError::new("use nothing, frustum or visibility"))?;
        if method == Method::Exact {
            return Err(JsError::new("use nothing, frustum or visibility"));
        }
        self.controls.method = method;
        self.dirty = true;
        Ok(())
    }

    /// 0 (fewest triangles) to 1 (fewest missing pixels).
    pub fn set_quality(&mut self, quality: f32) {
        self.controls.quality = if quality.is_finite() { quality.clamp(0.0, 1.0) } else { 0.0 };
        self.dirty = true;
    }

    /// "none", "triangles" or "milliseconds", and how many.
    pub fn set_budget(&mut self, kind: &str, amount: f64) {
        let amount = if amount.is_finite() { amount.max(0.0) } else { 0.0 };
        self.controls.limit = match kind {
            "triangles" => Limit::Triangles(amount as u64),
            "milliseconds" => Limit::Milliseconds(amount),
            _ => Limit::None,
        };
        self.dirty = true;
    }

    /// Proxies and simplified objects, and their largest error in pixels.
    pub fn set_proxies(&mut self, on: bool, tau: f32) {
        self.controls.proxies = on;
        self.controls.tau = if tau.is_finite() { tau.clamp(0.0, 1000.0) } else { 0.0 };
        self.dirty = true;
    }

    /// What is drawn stays as it is while the camera moves.
    pub fn set_freeze(&mut self, on: bool) {
        self.controls.freeze = on;
        self.dirty = true;
    }

    /// Asks which object is at a pixel; [`Self::picked`] has the answer some frames later.
    pub fn pick(&mut self, x: u32, y: u32) {
        let eye = self.eye();
        let Some(open) = &self.open else { return };
        let Some(scene) = open.gpu_scene.as_ref().filter(|_| x < eye.size[0] && y < eye.size[1]) else {
            return;
        };
        let frame = Frame { view: eye.view, objects: &self.painter.drawn, lines: &[] };
        let renderer = &mut self.painter.renderer;
        self.pick = Some(Pick::start(&self.gpu, renderer, scene, &frame, eye.size, [x, y]));
    }

    /// The answer to the last question, once: undefined while there is none, -1 for nothing, else the object, which is
    /// then selected.
    pub fn picked(&mut self) -> Option<f64> {
        let id = self.pick.as_ref()?.answer()?;
        self.pick = None;
        let object = id.and_then(|id| self.open.as_ref()?.object_of(id));
        self.select(object);
        Some(object.map_or(-1.0, f64::from))
    }

    /// Selects an object, or none.
    pub fn select(&mut self, object: Option<u32>) {
        self.controls.selected = object;
        self.dirty = true;
    }

    /// Name of an object's node.
    pub fn name(&self, object: u32) -> Option<String> {
        self.open.as_ref()?.stage.names.get(object as usize)?.clone()
    }

    /// Triangles of an object.
    pub fn triangles_of(&self, object: u32) -> u32 {
        let open = self.open.as_ref();
        open.and_then(|open| open.stage.triangles().get(object as usize).copied()).unwrap_or(0)
    }

    /// Hides an object, or shows it again.
    pub fn set_hidden(&mut self, object: u32, hidden: bool) {
        if let Some(open) = &mut self.open {
            open.set_hidden(object, hidden);
        }
        self.dirty = true;
    }

    /// Shows everything that was hidden.
    pub fn show_all(&mut self) {
        if let Some(open) = &mut self.open {
            for object in std::mem::take(&mut open.hidden) {
                open.stage.set_hidden(object, false);
            }
        }
        self.dirty = true;
    }

    /// Ids of what was drawn last: for tests.
    pub fn drawn(&self) -> Vec<u32> {
        self.painter.drawn.clone()
    }
}
