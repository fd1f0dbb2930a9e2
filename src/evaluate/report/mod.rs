//! The report folder: `report.html`, `frames.csv`, `summary.json`.

mod csv;
mod html;
mod picture;
mod simplified;
mod style;
mod svg;
#[cfg(test)]
mod tests;
mod worst;

use super::result::Evaluation;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Names of the files in a report folder.
pub const REPORT_FILES: [&str; 3] = ["report.html", "frames.csv", "summary.json"];

/// Why a report could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {source}", path.display())]
pub struct ReportError {
    /// The file or folder.
    pub path: PathBuf,
    /// Why.
    pub source: io::Error,
}

impl Evaluation {
    /// Content of `summary.json`.
    pub fn summary(&self) -> serde_json::Value {
        // Numbers and texts: this cannot fail.
        serde_json::to_value(self).unwrap_or_default()
    }

    /// Content of `frames.csv`: one row per frame and method.
    pub fn csv(&self) -> String {
        csv::table(self)
    }

    /// Content of `report.html`: one file that needs no other.
    pub fn html(&self) -> String {
        html::page(self)
    }

    /// Writes the three files into `folder`, which is created if it is not there (the folder above it must be). Each is
    /// written beside its place and renamed when it is complete; what was there before stays until then. Other files
    /// in the folder are left alone.
    ///
    /// # Errors
    /// [`ReportError`]
    pub fn write(&self, folder: &Path) -> Result<(), ReportError> {
        let contents = [self.html(), self.csv(), format!("{:#}\n", self.summary())];
        let failed = |path: &Path| {
            let path = path.to_owned();
            move |source| ReportError { path, source }
        };
        if folder.is_dir() {
            for (name, content) in REPORT_FILES.iter().zip(&contents) {
                let path = folder.join(name);
                replace(folder, &path, content).map_err(failed(&path))?;
            }
            return Ok(());
        }
        let beside = match folder.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let whole = || -> io::Result<()> {
            let unfinished = tempfile::Builder::new().prefix(".svs-report-").tempdir_in(beside)?;
            let inside = unfinished.path().join("report");
            // Not the temporary folder itself: only its owner may look into that.
            std::fs::create_dir(&inside)?;
            for (name, content) in REPORT_FILES.iter().zip(&contents) {
                std::fs::write(inside.join(name), content)?;
            }
            std::fs::rename(&inside, folder)
        };
        whole().map_err(failed(folder))
    }
}

fn replace(folder: &Path, path: &Path, content: &str) -> io::Result<()> {
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    file.write_all(content.as_bytes())?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        // Temporary files are for their owner alone; a report is for reading.
        file.as_file().set_permissions(std::fs::Permissions::from_mode(0o644))?;
    }
    file.persist(path)?;
    Ok(())
}
