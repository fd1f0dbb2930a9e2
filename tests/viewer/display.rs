//! A display of its own for each test.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

/// What a machine without a display needs for these tests.
const INSTALL: &str = "install it: apt-get install --no-install-recommends xvfb xdotool mesa-vulkan-drivers \
                       libx11-6 libx11-xcb1 libxcursor1 libxi6 libxkbcommon-x11-0";

/// A running Xvfb; ends with the test.
pub(crate) struct Display {
    server: Child,
    name: String,
}

impl Display {
    /// Starts a display of 1280 x 800 pixels.
    pub(crate) fn start() -> Self {
        let mut server = Command::new("Xvfb")
            // It finds a free number itself and says which.
            .args(["-displayfd", "1", "-screen", "0", "1280x800x24", "-nolisten", "tcp"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap_or_else(|error| panic!("Xvfb does not start ({error}); {INSTALL}"));
        let mut number = String::new();
        let output = server.stdout.take().expect("its output is a pipe");
        BufReader::new(output).read_line(&mut number).expect("Xvfb names its display");
        assert!(!number.trim().is_empty(), "Xvfb ended at once; {INSTALL}");
        Self { server, name: format!(":{}", number.trim()) }
    }

    /// As in the variable DISPLAY.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Runs xdotool with these words.
    pub(crate) fn xdotool(&self, words: &str) {
        let output = Command::new("xdotool")
            .args(words.split_whitespace())
            .env("DISPLAY", &self.name)
            .output()
            .unwrap_or_else(|error| panic!("xdotool does not start ({error}); {INSTALL}"));
        assert!(output.status.success(), "xdotool {words}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}
