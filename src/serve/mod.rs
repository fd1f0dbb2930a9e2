//! A web server for one file and the viewer's page, on this machine alone.
//!
//! What can be asked for is a list made at the start: no path of a request ever reaches the file system. Requests must name
//! this machine as their host, so that no page of another site gets at the file by a domain name that points here.
//!
//! HTTP is spoken by `tiny_http`: blocking, a few threads, no runtime; ranges and what may be read are decided here.

mod content;
mod range;

pub use content::Site;

use crate::gltf::{Document, ReadError, WriteError};
use content::Content;
use range::{Asked, asked};
use std::io::Read;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use tiny_http::{Header, Method, Request, Response, StatusCode};

/// Requests that are answered at the same time: browsers open six connections to a host.
const THREADS: usize = 6;

/// Why there is nothing to serve.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ServeError {
    /// The page has not been built.
    #[error(
        "there is no web viewer in {}: run `cargo xtask wasm` in the sources of svs, or name the folder of a built one \
         with --site", .folder.display()
    )]
    NoSite {
        /// Where it was looked for.
        folder: PathBuf,
    },
    /// The port is taken, or may not be used.
    #[error("cannot serve on port {port}: {message}; choose another with --port, or none for any free one")]
    Port {
        /// The port asked for.
        port: u16,
        /// What the system said.
        message: String,
    },
    /// The scene cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A .gltf cannot be made one file.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// A server that listens already.
pub struct Server {
    http: tiny_http::Server,
    site: Site,
    path: String,
    scene: Content,
}

impl std::fmt::Debug for Server {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Server").field("site", &self.site).field("path", &self.path).finish_non_exhaustive()
    }
}

impl Server {
    /// Listens on a port of this machine (0: any free one). A .glb is served as it is at each request, a .gltf as one GLB,
    /// made now.
    ///
    /// # Errors
    /// [`ServeError`]
    pub fn bind(site: Site, file: &Path, port: u16) -> Result<Self, ServeError> {
        let io = |source| ReadError::Io { path: file.to_owned(), source };
        let mut begin = Vec::new();
        std::fs::File::open(file).and_then(|file| file.take(4).read_to_end(&mut begin)).map_err(io)?;
        let scene = if begin == b"glTF" {
            Content::file(file).map_err(io)?
        } else {
            Content::Bytes(Document::read(file)?.to_glb()?, "model/gltf-binary")
        };
        let name = Path::new(file.file_name().unwrap_or_default()).with_extension("glb");
        let path = format!("scene/{}", content::encode(&name.to_string_lossy()));
        let http = tiny_http::Server::http((Ipv4Addr::LOCALHOST, port))
            .map_err(|error| ServeError::Port { port, message: error.to_string() })?;
        Ok(Self { http, site, path, scene })
    }

    /// Where it listens.
    pub fn address(&self) -> Option<SocketAddr> {
        self.http.server_addr().to_ip()
    }

    /// What to open in a browser.
    pub fn url(&self) -> String {
        let port = self.address().map_or(0, |address| address.port());
        format!("http://127.0.0.1:{port}/?src={}", self.path)
    }

    /// Answers requests, for ever.
    pub fn run(&self) {
        std::thread::scope(|scope| {
            for _ in 0..THREADS {
                scope.spawn(|| {
                    while let Ok(request) = self.http.recv() {
                        // A browser that goes away in the middle of an answer is no fault.
                        let _ = self.answer(request);
                    }
                });
            }
        });
    }

    fn answer(&self, request: Request) -> std::io::Result<()> {
        if !matches!(request.method(), Method::Get | Method::Head) {
            return plain(request, 405, "only GET and HEAD are answered");
        }
        if !self.is_for_us(&request) {
            return plain(request, 403, "this server answers to 127.0.0.1 and localhost alone");
        }
        let path = request.url().split(['?', '#']).next().unwrap_or_default();
        let path = path.strip_prefix('/').unwrap_or(path).to_owned();
        let content = if path == self.path { Some(&self.scene) } else { self.site.get(&path) };
        match content {
            Some(content) => send(request, content),
            None => plain(request, 404, "there is nothing here"),
        }
    }

    /// The request names this machine.
    fn is_for_us(&self, request: &Request) -> bool {
        let host = header(request, "Host").unwrap_or_default();
        let name = host.rsplit_once(':').map_or(host.as_str(), |(name, _)| name);
        name == "127.0.0.1" || name.eq_ignore_ascii_case("localhost")
    }
}

fn header(request: &Request, name: &'static str) -> Option<String> {
    request.headers().iter().find(|h| h.field.equiv(name)).map(|h| h.value.as_str().to_owned())
}

fn field(name: &str, value: &str) -> Option<Header> {
    Header::from_bytes(name, value).ok()
}

fn plain(request: Request, status: u16, text: &str) -> std::io::Result<()> {
    request.respond(Response::from_string(format!("{text}\n")).with_status_code(status))
}

fn send(request: Request, content: &Content) -> std::io::Result<()> {
    let length = match content.length() {
        Ok(length) => length,
        Err(error) => return plain(request, 404, &format!("the file is gone: {error}")),
    };
    let mut headers = vec![
        field("Content-Type", content.kind()),
        field("Accept-Ranges", "bytes"),
        // The file may be baked again while it is looked at.
        field("Cache-Control", "no-cache"),
    ];
    let (status, range) = match asked(header(&request, "Range").as_deref(), length) {
        Asked::Whole => (200, 0..length),
        Asked::Part(range) => {
            let text = format!("bytes {}-{}/{length}", range.start, range.end - 1);
            headers.push(field("Content-Range", &text));
            (206, range)
        }
        Asked::Nothing => {
            let response = Response::from_string("no such bytes\n").with_status_code(416);
            let range = field("Content-Range", &format!("bytes */{length}"));
            return request.respond(response.with_header_option(range));
        }
    };
    let size = usize::try_from(range.end - range.start).ok();
    let body = content.read(range)?;
    let headers = headers.into_iter().flatten().collect();
    // Never in chunks: the length is known.
    let response = Response::new(StatusCode(status), headers, body, size, None);
    request.respond(response.with_chunked_threshold(usize::MAX))
}

trait WithOption {
    fn with_header_option(self, header: Option<Header>) -> Self;
}

impl<R: Read> WithOption for Response<R> {
    fn with_header_option(self, header: Option<Header>) -> Self {
        match header {
            Some(header) => self.with_header(header),
            None => self,
        }
    }
}
