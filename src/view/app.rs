//! The window: events in, frames out.

use super::canvas::Canvas;
use super::keys::shortcut;
use super::script::{self, Step};
use super::script_run::{SECONDS_PER_FRAME, Script, Wishes};
use super::state::State;
use super::surface::WindowSurface;
use super::viewer::Viewer;
use super::{ViewError, ViewOptions, panel, screenshot};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};
use svs_render::{Gpu, wgpu};
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{ElementState, KeyEvent, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::keyboard::{KeyCode, PhysicalKey};
use winit::window::{Window, WindowId};

/// Size of the window's inside, pixels.
const SIZE: [u32; 2] = [1280, 800];
/// While a file is loaded, the window says so this often.
const LOADING_TICK: Duration = Duration::from_millis(200);

/// Something outside the window happened: look at what was loaded.
#[derive(Clone, Copy, Debug)]
struct Woken;

pub(super) fn run(options: &ViewOptions) -> Result<(), ViewError> {
    let script = match (&options.script, &options.screenshot) {
        (Some(path), _) => Some(script::read(path)?),
        (None, Some(output)) => Some(script::for_screenshot(output, options.frames.max(1))),
        (None, None) => None,
    };
    let event_loop = EventLoop::<Woken>::with_user_event()
        .build()
        .map_err(|error| ViewError::NoWindow(error.to_string()))?;
    let mut app = App {
        options: options.clone(),
        proxy: event_loop.create_proxy(),
        script: script.map(|steps: Vec<Step>| Script::new(steps)),
        parts: None,
        error: None,
        repaint_at: None,
        last_frame: Instant::now(),
    };
    event_loop.run_app(&mut app).map_err(|error| ViewError::NoWindow(error.to_string()))?;
    app.error.map_or(Ok(()), Err)
}

struct App {
    options: ViewOptions,
    proxy: EventLoopProxy<Woken>,
    script: Option<Script>,
    parts: Option<Parts>,
    /// Why the window was closed, if it was no wish of the user.
    error: Option<ViewError>,
    /// When the panel wants to be drawn again.
    repaint_at: Option<Instant>,
    last_frame: Instant,
}

/// What there is once there is a window.
struct Parts {
    window: Arc<Window>,
    gpu: Arc<Gpu>,
    surface: WindowSurface,
    egui: egui_winit::State,
    painter: egui_wgpu::Renderer,
    canvas: Option<Canvas>,
    viewer: Viewer,
    title: String,
}

impl Parts {
    fn new(
        event_loop: &ActiveEventLoop,
        options: &ViewOptions,
        proxy: &EventLoopProxy<Woken>,
    ) -> Result<Self, ViewError> {
        let [width, height] = options.size.unwrap_or(SIZE);
        let attributes =
            Window::default_attributes().with_title("svs").with_inner_size(PhysicalSize::new(width, height));
        let window =
            event_loop.create_window(attributes).map_err(|error| ViewError::NoWindow(error.to_string()))?;
        let window = Arc::new(window);
        let display = Box::new(event_loop.owned_display_handle());
        let descriptor = wgpu::InstanceDescriptor::new_with_display_handle_from_env(display);
        let instance = wgpu::Instance::new(descriptor);
        let surface = instance
            .create_surface(Arc::clone(&window))
            .map_err(|error| ViewError::Surface(error.to_string()))?;
        let gpu = Arc::new(pollster::block_on(Gpu::new(instance, Some(&surface)))?);
        let surface = WindowSurface::new(&gpu, surface, Arc::clone(&window))?;
        let context = egui::Context::default();
        panel::apply_style(&context);
        let largest = gpu.device.limits().max_texture_dimension_2d as usize;
        let egui = egui_winit::State::new(
            context,
            egui::ViewportId::ROOT,
            &window,
            Some(window.scale_factor() as f32),
            None,
            Some(largest),
        );
        let painter =
            egui_wgpu::Renderer::new(&gpu.device, surface.format(), egui_wgpu::RendererOptions::default());
        let mut state = State::default();
        state.quality = options.quality.unwrap_or(state.quality);
        state.method = options.method.unwrap_or(state.method);
        let camera = options.camera.as_ref().and_then(|path| path.frames(1).first().copied());
        let proxy = proxy.clone();
        // The loop is gone when the window was closed meanwhile.
        let wake = Arc::new(move || {
            let _ = proxy.send_event(Woken);
        });
        let mut viewer = Viewer::new(Arc::clone(&gpu), state, camera, wake);
        if let Some(file) = &options.file {
            viewer.open(file);
        }
        Ok(Self { window, gpu, surface, egui, painter, canvas: None, viewer, title: String::new() })
    }

    /// Lays the panel out, draws the scene and the panel, presents. Says when the panel wants to be drawn again.
    fn frame(&mut self, picture: Option<&Path>) -> Result<Duration, ViewError> {
        let input = self.egui.take_egui_input(&self.window);
        let (viewer, id) = (&mut self.viewer, self.canvas.as_ref().map(|canvas| canvas.id));
        let context = self.egui.egui_ctx().clone();
        let output = context.run_ui(input, |ui| panel::show(ui, viewer, id));
        self.egui.handle_platform_output(&self.window, output.platform_output);
        let repaint =
            output.viewport_output.get(&egui::ViewportId::ROOT).map_or(Duration::MAX, |v| v.repaint_delay);

        let is_new = self.canvas.as_ref().is_none_or(|canvas| canvas.size() != self.viewer.viewport);
        if is_new {
            let reuse = self.canvas.take().map(|canvas| canvas.id);
            self.canvas = Some(Canvas::new(&self.gpu, &mut self.painter, self.viewer.viewport, reuse));
        }
        let drawn = self.viewer.history.total();
        if let Some(canvas) = &self.canvas {
            self.viewer.draw(canvas, is_new)?;
        }
        let panel_is_old = self.viewer.history.total() != drawn;

        let shapes = context.tessellate(output.shapes, output.pixels_per_point);
        for (id, deltas) in &output.textures_delta.set {
            for delta in deltas {
                self.painter.update_texture(&self.gpu.device, &self.gpu.queue, *id, delta);
            }
        }
        let acquired = self.surface.acquire(&self.gpu)?;
        if let Some(shown) = acquired {
            self.paint(&shown.texture, &shapes, output.pixels_per_point);
            if let Some(path) = picture {
                self.picture(&shown.texture, &shapes, output.pixels_per_point, path)?;
            }
            self.window.pre_present_notify();
            self.gpu.queue.present(shown);
        }
        for id in &output.textures_delta.free {
            self.painter.free_texture(id);
        }
        // The panel was laid out before the figures of this frame were known, the first one without a picture.
        Ok(if is_new || panel_is_old { Duration::ZERO } else { repaint })
    }

    /// Writes what was just painted as a file.
    fn picture(
        &mut self,
        shown: &wgpu::Texture,
        shapes: &[egui::ClippedPrimitive],
        scale: f32,
        path: &Path,
    ) -> Result<(), ViewError> {
        if self.surface.copyable() {
            return screenshot::save(&self.gpu, shown, path);
        }
        let [width, height] = self.surface.size();
        let texture = self.gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("screenshot"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: self.surface.format(),
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        self.paint(&texture, shapes, scale);
        screenshot::save(&self.gpu, &texture, path)
    }

    fn paint(&mut self, texture: &wgpu::Texture, shapes: &[egui::ClippedPrimitive], scale: f32) {
        let gpu = &self.gpu;
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let screen =
            egui_wgpu::ScreenDescriptor { size_in_pixels: self.surface.size(), pixels_per_point: scale };
        let more = self.painter.update_buffers(&gpu.device, &gpu.queue, &mut encoder, shapes, &screen);
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        {
            let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("panel"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            });
            self.painter.render(&mut pass.forget_lifetime(), shapes, &screen);
        }
        gpu.queue.submit(more.into_iter().chain([encoder.finish()]));
    }

    /// A key went down or up. Says whether it was for the scene.
    fn key(&mut self, event: &KeyEvent) -> bool {
        let PhysicalKey::Code(code) = event.physical_key else { return false };
        let down = event.state == ElementState::Pressed;
        let context = self.egui.egui_ctx();
        // Releases count always, or a key would stay down for ever.
        if down && context.text_edit_focused() {
            return false;
        }
        let command = context.input(|input| input.modifiers.command || input.modifiers.alt);
        if down && command {
            return false;
        }
        self.viewer.held.set(code, down);
        if down
            && !event.repeat
            && let Some(shortcut) = shortcut(code)
        {
            self.viewer.press(shortcut);
        }
        // egui would walk through the controls.
        code == KeyCode::Tab
    }
}

impl App {
    /// Ends the program with an error.
    fn fail(&mut self, event_loop: &ActiveEventLoop, error: ViewError) {
        self.error.get_or_insert(error);
        event_loop.exit();
    }

    fn redraw(&mut self, event_loop: &ActiveEventLoop) {
        if let Err(error) = self.try_redraw(event_loop) {
            self.fail(event_loop, error);
        }
    }

    fn try_redraw(&mut self, event_loop: &ActiveEventLoop) -> Result<(), ViewError> {
        let Some(parts) = &mut self.parts else { return Ok(()) };
        let elapsed = std::mem::replace(&mut self.last_frame, Instant::now()).elapsed().as_secs_f64();
        parts.viewer.receive();
        let mut wishes = Wishes::default();
        let mut seconds = elapsed;
        if let Some(script) = &mut self.script {
            if script.is_running() {
                seconds = SECONDS_PER_FRAME;
            }
            wishes = script.step(&mut parts.viewer)?;
        }
        if let Some([width, height]) = wishes.resize {
            let _ = parts.window.request_inner_size(PhysicalSize::new(width, height));
        }
        parts.viewer.advance(seconds);
        let delay = parts.frame(wishes.screenshot.as_deref())?;
        self.repaint_at = Instant::now().checked_add(delay);
        let dumps = wishes.dump.iter().chain(self.script.as_ref().and_then(|script| script.watch.as_ref()));
        for path in dumps {
            dump(&parts.viewer, path)?;
        }
        let title = parts.viewer.title();
        if title != parts.title {
            parts.window.set_title(&title);
            parts.title = title;
        }
        if wishes.leave {
            event_loop.exit();
        }
        Ok(())
    }
}

/// Writes settings and figures; whoever reads the file never sees half of it.
fn dump(viewer: &Viewer, path: &Path) -> Result<(), ViewError> {
    let write = || -> std::io::Result<()> {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut file = tempfile::NamedTempFile::new_in(folder)?;
        serde_json::to_writer_pretty(&mut file, &viewer.dump())?;
        file.persist(path)?;
        Ok(())
    };
    write().map_err(|error| ViewError::Write { path: path.to_owned(), message: error.to_string() })
}

impl ApplicationHandler<Woken> for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.parts.is_some() {
            return;
        }
        match Parts::new(event_loop, &self.options, &self.proxy) {
            Ok(parts) => {
                parts.window.request_redraw();
                self.parts = Some(parts);
            }
            Err(error) => self.fail(event_loop, error),
        }
    }

    fn user_event(&mut self, _: &ActiveEventLoop, _: Woken) {
        if let Some(parts) = &self.parts {
            parts.window.request_redraw();
        }
    }

    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        if let (StartCause::ResumeTimeReached { .. }, Some(parts)) = (cause, &self.parts) {
            parts.window.request_redraw();
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(parts) = &mut self.parts else { return };
        let mut for_scene = false;
        match &event {
            WindowEvent::RedrawRequested => return self.redraw(event_loop),
            WindowEvent::CloseRequested => return event_loop.exit(),
            WindowEvent::Resized(size) => parts.surface.resize(&parts.gpu, *size),
            WindowEvent::DroppedFile(path) => parts.viewer.open(path),
            WindowEvent::Focused(false) => parts.viewer.held.clear(),
            WindowEvent::KeyboardInput { event, .. } => {
                for_scene = parts.key(event);
            }
            _ => {}
        }
        if for_scene {
            parts.window.request_redraw();
            return;
        }
        if parts.egui.on_window_event(&parts.window, &event).repaint {
            parts.window.request_redraw();
        }
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let Some(parts) = &self.parts else { return };
        if !parts.surface.is_usable() {
            event_loop.set_control_flow(ControlFlow::Wait);
            return;
        }
        let scripted = self.script.as_ref().is_some_and(Script::is_running);
        if scripted || parts.viewer.is_busy() {
            parts.window.request_redraw();
        }
        let tick = parts.viewer.loading.is_some().then(|| Instant::now() + LOADING_TICK);
        event_loop.set_control_flow(match self.repaint_at.into_iter().chain(tick).min() {
            Some(at) => ControlFlow::WaitUntil(at),
            None => ControlFlow::Wait,
        });
    }
}
