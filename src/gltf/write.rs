//! Writing documents. Everything is written beside its target first and renamed when all of it is complete: a full
//! disk or an interruption leaves what was there before, never half a file.

use super::buffers::BufferStorage;
use super::document::{Container, Document};
use super::error::WriteError;
use super::{glb, json, uri};
use serde_json::Value;
use std::borrow::Cow;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// What [`Document::write`] has written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WriteSummary {
    /// Bytes of the main file.
    pub bytes: u64,
    /// Other files written: buffers beside a .gltf, and copied resources.
    pub files: Vec<PathBuf>,
    /// Relative URIs whose files were not copied: they are missing, or lie outside the source's folder.
    pub not_copied: Vec<String>,
    /// GLB chunks that a .gltf has no place for.
    pub dropped_chunks: usize,
}

impl Document {
    /// Writes the document to `path`, in the container that its extension asks for (of any other extension: the
    /// container the document has). Writing over the file that was read is fine.
    ///
    /// External files are copied when the output lies in another folder, over files of the same name; buffers of the
    /// source are never rewritten. All files are complete before the first one appears under its name, and the main
    /// file appears last.
    ///
    /// # Errors
    /// [`WriteError`]; the old output is then untouched.
    pub fn write(&self, path: &Path) -> Result<WriteSummary, WriteError> {
        let container = Container::from_path(path).unwrap_or(self.container);
        if container != self.container {
            let mut converted = self.clone();
            converted.convert(container);
            return converted.write(path);
        }
        self.check_buffers()?;
        // A symbolic link stays one: what it points to is replaced.
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let folder = match target.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
            _ => PathBuf::from("."),
        };
        if !folder.is_dir() {
            let source =
                io::Error::new(io::ErrorKind::NotFound, "its folder does not exist; create it first");
            return Err(WriteError::Io { path: path.to_owned(), source });
        }
        let mut output = Output::new(&folder, &target);
        let mut summary = WriteSummary { dropped_chunks: self.dropped_chunks, ..WriteSummary::default() };
        self.stage_resources(&mut output, &mut summary)?;
        summary.bytes = match self.container {
            Container::Glb => output.stage(&target, |file| self.write_glb(file))?,
            Container::Gltf => {
                let json = self.stage_beside(&mut output, &target)?;
                let text = self.style.text(&json)?;
                output.stage(&target, |file| Ok(file.write_all(&text)?))?
            }
        };
        summary.files = output.publish()?;
        Ok(summary)
    }

    /// The document as GLB bytes (a .gltf is converted first).
    ///
    /// # Errors
    /// [`WriteError::TooLarge`] from 4 GiB on, [`WriteError::Inconsistent`] if JSON and buffers do not fit together.
    pub fn to_glb(&self) -> Result<Vec<u8>, WriteError> {
        if self.container != Container::Glb {
            let mut converted = self.clone();
            converted.convert(Container::Glb);
            return converted.to_glb();
        }
        self.check_buffers()?;
        let mut bytes = Vec::new();
        self.write_glb(&mut bytes).map_err(|problem| match problem {
            Problem::Io(source) => WriteError::Io { path: PathBuf::from("memory"), source },
            Problem::Other(error) => error,
        })?;
        Ok(bytes)
    }

    fn write_glb(&self, out: &mut impl Write) -> Result<(), Problem> {
        let json = serde_json::to_vec(&self.json).map_err(WriteError::from)?;
        let parts = match self.storage.first() {
            Some(BufferStorage::Bin) => Some([self.buffers[0].as_slice(), self.bin_tail.as_slice()]),
            _ => self.loose_bin.as_ref().map(|bin| [bin.as_slice(), &[]]),
        };
        let bin = parts.map(|parts| parts.iter().map(|part| part.len() as u64).sum());
        let extra = self.extra_chunks.iter().map(|chunk| chunk.bytes.len() as u64);
        let length = glb::length(json.len() as u64, bin, extra)?;
        Ok(glb::write(out, length, &json, parts.as_ref().map(|parts| &parts[..]), &self.extra_chunks)?)
    }

    /// JSON and buffers must fit together, whatever code has done to them since they were read.
    fn check_buffers(&self) -> Result<(), WriteError> {
        let inconsistent = |pointer: String, problem: String| WriteError::Inconsistent { pointer, problem };
        let objects = json::array(&self.json, "buffers");
        if objects.len() != self.buffers.len() || objects.len() != self.storage.len() {
            let problem = format!("{} buffers in the JSON, {} in memory", objects.len(), self.buffers.len());
            return Err(inconsistent("/buffers".to_owned(), problem));
        }
        for (i, (object, buffer)) in objects.iter().zip(&self.buffers).enumerate() {
            let declared = object.get("byteLength").and_then(json::index);
            if self.storage[i] != BufferStorage::Absent && declared != Some(buffer.len()) {
                let problem = format!("byteLength does not match the buffer's {} bytes", buffer.len());
                return Err(inconsistent(format!("/buffers/{i}"), problem));
            }
        }
        Ok(())
    }

    fn stage_resources(&self, output: &mut Output, summary: &mut WriteSummary) -> Result<(), WriteError> {
        let resources = self.resources();
        let in_place = self.folder.as_ref().is_some_and(|folder| same_file(folder, output.folder));
        if !in_place {
            summary.not_copied = resources.unresolved;
        }
        for (uri, copy) in resources.files {
            let target = output.folder.join(&copy.to);
            if target == output.main || same_file(&copy.from, output.main) {
                return Err(WriteError::OwnResource { path: target, uri });
            }
            if in_place || same_file(&copy.from, &target) {
                continue;
            }
            output.stage(&target, |file| {
                io::copy(&mut File::open(&copy.from)?, file)?;
                Ok(())
            })?;
        }
        Ok(())
    }

    /// Stages buffers that get a file of their own; returns the JSON that names them.
    fn stage_beside(&self, output: &mut Output, target: &Path) -> Result<Cow<'_, Value>, WriteError> {
        let mut json = Cow::Borrowed(&self.json);
        let stem = target.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        for (i, storage) in self.storage.iter().enumerate() {
            let BufferStorage::Beside(ending) = storage else { continue };
            let name = self.free_name(target, &stem, ending);
            output.stage(&output.folder.join(&name), |file| Ok(file.write_all(&self.buffers[i])?))?;
            json.to_mut()["buffers"][i]["uri"] = Value::String(uri::encode_path(&name));
        }
        Ok(json)
    }

    /// `<stem><ending>`, with a number if the document already uses that name for something else.
    fn free_name(&self, target: &Path, stem: &str, ending: &str) -> String {
        let main = target.file_name().map(PathBuf::from);
        let taken: Vec<String> = self
            .resources()
            .files
            .into_iter()
            .map(|(_, copy)| copy.to)
            .chain(main)
            .map(|path| path.to_string_lossy().to_lowercase())
            .collect();
        let mut name = format!("{stem}{ending}");
        let mut number = 2;
        while taken.contains(&name.to_lowercase()) {
            name = format!("{stem}-{number}{ending}");
            number += 1;
        }
        name
    }
}

/// Files that are complete but not yet under their names.
struct Output<'a> {
    folder: &'a Path,
    main: &'a Path,
    staged: Vec<(NamedTempFile, PathBuf)>,
}

/// An error that still lacks the path of the file it concerns, or one that needs none.
enum Problem {
    Io(io::Error),
    Other(WriteError),
}

impl From<io::Error> for Problem {
    fn from(source: io::Error) -> Self {
        Problem::Io(source)
    }
}

impl From<WriteError> for Problem {
    fn from(error: WriteError) -> Self {
        Problem::Other(error)
    }
}

impl<'a> Output<'a> {
    fn new(folder: &'a Path, main: &'a Path) -> Self {
        Self { folder, main, staged: Vec::new() }
    }

    /// Writes a file beside `target`; returns its size in bytes.
    fn stage(
        &mut self,
        target: &Path,
        write: impl FnOnce(&mut BufWriter<&File>) -> Result<(), Problem>,
    ) -> Result<u64, WriteError> {
        let io = |source| WriteError::Io { path: target.to_owned(), source };
        let folder = target.parent().unwrap_or(self.folder);
        if folder != self.folder {
            // Sub-folders of resources; a missing folder of the output itself is the user's mistake to correct.
            fs::create_dir_all(folder).map_err(io)?;
        }
        let file = temporary(target, folder).map_err(io)?;
        let mut buffered = BufWriter::with_capacity(1 << 20, file.as_file());
        write(&mut buffered).map_err(|problem| match problem {
            Problem::Io(source) => io(source),
            Problem::Other(error) => error,
        })?;
        buffered.flush().map_err(io)?;
        drop(buffered);
        // A full network disk tells only now.
        file.as_file().sync_all().map_err(io)?;
        let bytes = file.as_file().metadata().map_err(io)?.len();
        self.staged.push((file, target.to_owned()));
        Ok(bytes)
    }

    /// Renames everything, the main file last; returns the other paths.
    fn publish(self) -> Result<Vec<PathBuf>, WriteError> {
        let mut written = Vec::new();
        for (file, target) in self.staged {
            file.persist(&target)
                .map_err(|error| WriteError::Io { path: target.clone(), source: error.error })?;
            written.push(target);
        }
        written.pop();
        Ok(written)
    }
}

/// A temporary file in `folder` with the rights the target has, or a new file would get.
fn temporary(target: &Path, folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".svs-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Without this the output would be readable by its owner only; the umask is applied on top.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let file = builder.tempfile_in(folder)?;
    match fs::metadata(target) {
        // Renaming would replace a device or a pipe (`/dev/null`) by a file.
        Ok(old) if !old.is_file() => return Err(io::Error::other("it exists and is not a regular file")),
        Ok(old) => file.as_file().set_permissions(old.permissions())?,
        Err(_) => {}
    }
    Ok(file)
}

fn same_file(a: &Path, b: &Path) -> bool {
    match (fs::canonicalize(a), fs::canonicalize(b)) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    }
}
