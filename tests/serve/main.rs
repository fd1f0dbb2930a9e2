//! `svs serve` from outside: a browser's requests, and those of nobody's browser.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// A server that ends with the test.
struct Server {
    process: Child,
    port: u16,
    url: String,
    folder: tempfile::TempDir,
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

struct Answer {
    status: u16,
    headers: Vec<(String, String)>,
    body: Vec<u8>,
}

impl Answer {
    fn header(&self, name: &str) -> Option<&str> {
        let found = self.headers.iter().find(|(key, _)| key.eq_ignore_ascii_case(name));
        found.map(|(_, value)| value.as_str())
    }
}

fn svs() -> Command {
    Command::new(env!("CARGO_BIN_EXE_svs"))
}

fn sample() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/plant.glb")
}

fn serve(file: &Path) -> Server {
    let folder = tempfile::tempdir().expect("a folder");
    let site = folder.path().join("site");
    std::fs::create_dir_all(site.join("webgl")).expect("a folder");
    std::fs::write(site.join("index.html"), "<!doctype html>page").expect("a page");
    std::fs::write(site.join("webgl/a.wasm"), b"\0asm").expect("a module");
    std::fs::write(folder.path().join("secret.txt"), "secret").expect("a secret");
    let mut process = svs()
        .arg("serve")
        .arg(file)
        .arg("--site")
        .arg(&site)
        .stdout(Stdio::piped())
        .stderr(Stdio::inherit())
        .spawn()
        .expect("svs starts");
    let mut url = String::new();
    let output = process.stdout.as_mut().expect("its output");
    BufReader::new(output).read_line(&mut url).expect("an address");
    let url = url.trim().to_owned();
    let rest = url.strip_prefix("http://127.0.0.1:").expect("an address of this machine");
    let port = rest.split('/').next().and_then(|port| port.parse().ok()).expect("a port");
    Server { process, port, url, folder }
}

impl Server {
    fn raw(&self, request: &str) -> Answer {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("it listens");
        stream.write_all(request.as_bytes()).expect("it reads");
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).expect("it answers");
        let end = bytes.windows(4).position(|window| window == b"\r\n\r\n").expect("a head");
        let head = String::from_utf8_lossy(&bytes[..end]).into_owned();
        let mut lines = head.lines();
        let status = lines.next().and_then(|line| line.split(' ').nth(1)?.parse().ok()).expect("a status");
        let headers = lines.filter_map(|line| line.split_once(": "));
        let headers = headers.map(|(key, value)| (key.to_owned(), value.to_owned())).collect();
        Answer { status, headers, body: bytes[end + 4..].to_vec() }
    }

    fn get(&self, path: &str, more: &str) -> Answer {
        self.raw(&format!("GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n{more}\r\n"))
    }
}

#[test]
fn the_page_and_the_scene_are_there() {
    let server = serve(&sample());
    assert!(server.url.ends_with("/?src=scene/plant.glb"), "{}", server.url);
    let page = server.get("/?src=scene/plant.glb", "");
    assert_eq!((page.status, page.body.as_slice()), (200, b"<!doctype html>page".as_slice()));
    assert_eq!(page.header("content-type"), Some("text/html; charset=utf-8"));
    let module = server.get("/webgl/a.wasm", "");
    assert_eq!((module.status, module.header("content-type")), (200, Some("application/wasm")));
    let scene = server.get("/scene/plant.glb", "");
    assert!(scene.status == 200 && scene.body == std::fs::read(sample()).expect("the sample"));
    assert_eq!(scene.header("accept-ranges"), Some("bytes"));
    let head = server.raw("HEAD /scene/plant.glb HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    assert!(head.status == 200 && head.body.is_empty());
    assert_eq!(head.header("content-length"), scene.header("content-length"));
}

#[test]
fn ranges_are_exact() {
    let server = serve(&sample());
    let file = std::fs::read(sample()).expect("the sample");
    let length = file.len();
    for (asked, range) in [
        ("0-0".to_owned(), 0..1),
        ("100-199".to_owned(), 100..200),
        (format!("{}-", length - 7), length - 7..length),
        ("-5".to_owned(), length - 5..length),
        (format!("10-{}", length * 2), 10..length),
    ] {
        let answer = server.get("/scene/plant.glb", &format!("Range: bytes={asked}\r\n"));
        assert_eq!(answer.status, 206, "{asked}");
        let expected = format!("bytes {}-{}/{length}", range.start, range.end - 1);
        assert_eq!(answer.header("content-range"), Some(expected.as_str()));
        assert!(answer.body == file[range], "{asked}");
    }
    let beyond = server.get("/scene/plant.glb", &format!("Range: bytes={length}-\r\n"));
    assert_eq!(beyond.status, 416);
    assert_eq!(beyond.header("content-range"), Some(format!("bytes */{length}").as_str()));
    let several = server.get("/scene/plant.glb", "Range: bytes=0-1,5-6\r\n");
    assert!(several.status == 200 && several.body == file);
}

#[test]
fn nothing_else_is_there() {
    let server = serve(&sample());
    assert!(server.folder.path().join("secret.txt").exists());
    for path in [
        "/nothing",
        "/../secret.txt",
        "/webgl/../../secret.txt",
        "/%2e%2e/secret.txt",
        "/..%2fsecret.txt",
        "/webgl/..%5c..%5csecret.txt",
        "//etc/passwd",
        "/scene/../secret.txt",
        "/scene/",
        "/webgl",
        "/webgl/",
    ] {
        let answer = server.get(path, "");
        assert_eq!(answer.status, 404, "{path}");
        assert!(!answer.body.windows(6).any(|window| window == b"secret"), "{path}");
    }
    let post =
        server.raw("POST / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nContent-Length: 0\r\n\r\n");
    assert_eq!(post.status, 405);
    let other =
        server.raw("GET /scene/plant.glb HTTP/1.1\r\nHost: evil.example\r\nConnection: close\r\n\r\n");
    assert_eq!(other.status, 403);
}

#[test]
fn a_gltf_is_served_as_one_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a triangle.gltf");
    let json = r#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":3,"uri":"data:;base64,AAEC"}]}"#;
    std::fs::write(&path, json).expect("a file");
    let server = serve(&path);
    assert!(server.url.ends_with("/?src=scene/a%20triangle.glb"), "{}", server.url);
    let answer = server.get("/scene/a%20triangle.glb", "");
    assert!(answer.status == 200 && answer.body.starts_with(b"glTF"));
}

#[test]
fn what_cannot_be_served_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let fails = |arguments: &[&std::ffi::OsStr], expected: &str| {
        let output = svs().arg("serve").args(arguments).output().expect("svs runs");
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(message.contains(expected), "{message}");
    };
    let (sample, empty) = (sample(), folder.path().as_os_str());
    fails(&[sample.as_os_str(), "--site".as_ref(), empty], "cargo xtask wasm");
    std::fs::write(folder.path().join("index.html"), "").expect("a page");
    fails(&[folder.path().join("none.glb").as_os_str(), "--site".as_ref(), empty], "cannot read");
    let server = serve(&sample);
    let port = server.port.to_string();
    fails(
        &[sample.as_os_str(), "--site".as_ref(), empty, "--port".as_ref(), port.as_ref()],
        "another with --port",
    );
}
