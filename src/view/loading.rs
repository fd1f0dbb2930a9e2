//! Opening files in the background: the window stays alive.

use crate::gltf::Document;
use crate::stage::Stage;
use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};
use svs_render::{Gpu, GpuScene};

/// A file ready to be drawn.
pub(crate) struct Loaded {
    pub(crate) path: PathBuf,
    pub(crate) stage: Stage,
    pub(crate) gpu_scene: GpuScene,
    pub(crate) took: Duration,
}

/// A file on its way.
pub(crate) struct Loading {
    path: PathBuf,
    begun: Instant,
    result: Receiver<Result<Loaded, String>>,
}

impl Loading {
    /// Starts to read and upload a file; `wake` is called when it is done, whatever came of it.
    pub(crate) fn start(gpu: Arc<Gpu>, path: PathBuf, wake: impl FnOnce() + Send + 'static) -> Self {
        let (sender, result) = channel();
        let (file, begun) = (path.clone(), Instant::now());
        std::thread::spawn(move || {
            let opened = open(&gpu, &file);
            let loaded = opened.map(|(stage, gpu_scene)| Loaded {
                path: file,
                stage,
                gpu_scene,
                took: begun.elapsed(),
            });
            // Nobody waits any more when another file was opened meanwhile.
            let _ = sender.send(loaded);
            wake();
        });
        Self { path, begun, result }
    }

    /// Name of the file, without folders.
    pub(crate) fn name(&self) -> String {
        file_name(&self.path)
    }

    /// How long it takes already.
    pub(crate) fn elapsed(&self) -> Duration {
        self.begun.elapsed()
    }

    /// What came of it, once; the message names the file.
    pub(crate) fn finished(&mut self) -> Option<Result<Loaded, String>> {
        match self.result.try_recv() {
            Ok(result) => Some(result),
            Err(TryRecvError::Empty) => None,
            // The thread is gone without an answer.
            Err(TryRecvError::Disconnected) => Some(Err(format!("{} cannot be opened", self.name()))),
        }
    }
}

/// Name of a file, without folders.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

fn open(gpu: &Gpu, path: &Path) -> Result<(Stage, GpuScene), String> {
    let document = Document::read(path).map_err(|error| told(path, &error))?;
    let stage = Stage::open(&document).map_err(|error| told(path, &error))?;
    let gpu_scene =
        GpuScene::upload(gpu, &stage.data, stage.upload_order()).map_err(|error| told(path, &error))?;
    Ok((stage, gpu_scene))
}

/// The error with its causes, each said once.
fn told(path: &Path, error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut next = error.source();
    while let Some(cause) = next {
        let message = cause.to_string();
        if !text.contains(&message) {
            let _ = write!(text, ": {message}");
        }
        next = cause.source();
    }
    let name = file_name(path);
    if text.contains(&name) { text } else { format!("{name} cannot be opened: {text}") }
}
