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
use std::fmt::Write as _;
use std::io::{Read, Write as _};
use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use tiny_http::{Method, Request};

/// Requests that are answered at the same time: browsers open six connections to a host.
const THREADS: usize = 6;

const NOT_FOUND: (u16, &str) = (404, "Not Found");

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
            return plain(request, (405, "Method Not Allowed"), "only GET and HEAD are answered");
        }
        if !self.is_for_us(&request) {
            return plain(
                request,
                (403, "Forbidden"),
                "this server answers to 127.0.0.1 and localhost alone",
            );
        }
        let path = request.url().split(['?', '#']).next().unwrap_or_default();
        let path = path.strip_prefix('/').unwrap_or(path).to_owned();
        let content = if path == self.path { Some(&self.scene) } else { self.site.get(&path) };
        match content {
            Some(content) => send(request, content),
            None => plain(request, NOT_FOUND, "there is nothing here"),
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

/// One answer for each connection: with kept ones, `tiny_http` 0.12 lets a browser's fifth and sixth connection wait for the
/// end of the first four, which never comes. Its own answers cannot say so, hence this one.
fn respond(
    request: Request,
    (status, reason): (u16, &str),
    headers: &[(&str, &str)],
    length: u64,
    body: &mut dyn Read,
) -> std::io::Result<()> {
    let is_head = *request.method() == Method::Head;
    let mut out = request.into_writer();
    let mut head = format!("HTTP/1.1 {status} {reason}\r\nConnection: close\r\nContent-Length: {length}\r\n");
    for (name, value) in headers {
        let _ = write!(head, "{name}: {value}\r\n");
    }
    head.push_str("\r\n");
    out.write_all(head.as_bytes())?;
    if !is_head {
        std::io::copy(&mut body.take(length), &mut out)?;
    }
    out.flush()
}

fn plain(request: Request, status: (u16, &str), text: &str) -> std::io::Result<()> {
    let text = format!("{text}\n");
    let headers = [("Content-Type", "text/plain; charset=utf-8")];
    respond(request, status, &headers, text.len() as u64, &mut text.as_bytes())
}

fn send(request: Request, content: &Content) -> std::io::Result<()> {
    let length = match content.length() {
        Ok(length) => length,
        Err(error) => return plain(request, NOT_FOUND, &format!("the file is gone: {error}")),
    };
    // The file may be baked again while it is looked at.
    let mut headers =
        vec![("Content-Type", content.kind()), ("Accept-Ranges", "bytes"), ("Cache-Control", "no-cache")];
    let (status, range) = match asked(header(&request, "Range").as_deref(), length) {
        Asked::Whole => ((200, "OK"), 0..length),
        Asked::Part(range) => ((206, "Partial Content"), range),
        Asked::Nothing => {
            let range = format!("bytes */{length}");
            return respond(
                request,
                (416, "Range Not Satisfiable"),
                &[("Content-Range", &range)],
                0,
                &mut std::io::empty(),
            );
        }
    };
    let place = format!("bytes {}-{}/{length}", range.start, range.end.saturating_sub(1));
    if status.0 == 206 {
        headers.push(("Content-Range", &place));
    }
    let size = range.end - range.start;
    let mut body = content.read(range)?;
    respond(request, status, &headers, size, &mut body)
}
