//! What the keys do.

use crate::rig::Motion;
use winit::keyboard::KeyCode;

/// A key that does something once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shortcut {
    Orbit,
    Walk,
    SwitchCamera,
    Frame,
    FrameAll,
    Record,
    Play,
    Hide,
    ShowAll,
    Freeze,
    Skipped,
    SkippedBoxes,
    Spheres,
    Measure,
    NextMethod,
    NextColours,
    LowerQuality,
    HigherQuality,
    Graphs,
    Panel,
    Help,
    Leave,
}

/// Key, its name on the keyboard (for help and scripts), what it does, in words.
type Binding = (KeyCode, &'static str, Shortcut, &'static str);

/// All keys that do something once.
pub(crate) const BINDINGS: [Binding; 22] = [
    (KeyCode::Digit1, "1", Shortcut::Orbit, "orbit camera"),
    (KeyCode::Digit2, "2", Shortcut::Walk, "walk camera"),
    (KeyCode::Tab, "Tab", Shortcut::SwitchCamera, "switch between them"),
    (KeyCode::KeyF, "F", Shortcut::Frame, "frame the selection, or the scene"),
    (KeyCode::Home, "Home", Shortcut::FrameAll, "frame the scene"),
    (KeyCode::KeyR, "R", Shortcut::Record, "start or stop recording a camera path"),
    (KeyCode::KeyP, "P", Shortcut::Play, "play the camera path, or stop it"),
    (KeyCode::KeyH, "H", Shortcut::Hide, "hide or show the selected object"),
    (KeyCode::KeyU, "U", Shortcut::ShowAll, "show all hidden objects"),
    (KeyCode::KeyX, "X", Shortcut::Freeze, "freeze culling, fly out and look"),
    (KeyCode::KeyK, "K", Shortcut::Skipped, "show what is skipped, in red (while frozen)"),
    (KeyCode::KeyJ, "J", Shortcut::SkippedBoxes, "show boxes of what is skipped (while frozen)"),
    (KeyCode::KeyO, "O", Shortcut::Spheres, "show the spheres in use"),
    (KeyCode::KeyM, "M", Shortcut::Measure, "measure what is missing now"),
    (KeyCode::KeyV, "V", Shortcut::NextMethod, "next method"),
    (KeyCode::KeyB, "B", Shortcut::NextColours, "next colours"),
    (KeyCode::BracketLeft, "[", Shortcut::LowerQuality, "lower quality"),
    (KeyCode::BracketRight, "]", Shortcut::HigherQuality, "higher quality"),
    (KeyCode::KeyG, "G", Shortcut::Graphs, "graphs"),
    (KeyCode::F10, "F10", Shortcut::Panel, "panel"),
    (KeyCode::F1, "F1", Shortcut::Help, "this help"),
    (KeyCode::Escape, "Esc", Shortcut::Leave, "close help, unselect"),
];

/// What a key does once.
pub(crate) fn shortcut(code: KeyCode) -> Option<Shortcut> {
    BINDINGS.iter().find(|binding| binding.0 == code).map(|binding| binding.2)
}

/// The same by the key's name, whatever its case.
pub(crate) fn shortcut_named(name: &str) -> Option<Shortcut> {
    BINDINGS.iter().find(|binding| binding.1.eq_ignore_ascii_case(name)).map(|binding| binding.2)
}

/// Keys that are held down.
#[derive(Clone, Debug, Default)]
pub(crate) struct Held(Vec<KeyCode>);

impl Held {
    /// A key went down or up.
    pub(crate) fn set(&mut self, code: KeyCode, down: bool) {
        self.0.retain(|&held| held != code);
        if down {
            self.0.push(code);
        }
    }

    /// The window lost the keyboard: releases will not be heard of.
    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }

    /// What the held keys do to the camera. Keys are meant by place: WASD are the same ones on every keyboard.
    pub(crate) fn motion(&self) -> Motion {
        let any = |codes: &[KeyCode]| codes.iter().any(|code| self.0.contains(code));
        let axis = |plus: &[KeyCode], minus: &[KeyCode]| f64::from(any(plus)) - f64::from(any(minus));
        use KeyCode::{
            ArrowDown, ArrowLeft, ArrowRight, ArrowUp, KeyA, KeyC, KeyD, KeyE, KeyQ, KeyS, KeyW, PageDown,
            PageUp, ShiftLeft, ShiftRight, Space,
        };
        Motion {
            right: axis(&[KeyD, ArrowRight], &[KeyA, ArrowLeft]),
            up: axis(&[Space, KeyE, PageUp], &[KeyC, KeyQ, PageDown]),
            ahead: axis(&[KeyW, ArrowUp], &[KeyS, ArrowDown]),
            faster: any(&[ShiftLeft, ShiftRight]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn no_key_does_two_things() {
        let codes: HashSet<KeyCode> = BINDINGS.iter().map(|binding| binding.0).collect();
        let names: HashSet<&str> = BINDINGS.iter().map(|binding| binding.1).collect();
        assert_eq!((codes.len(), names.len()), (BINDINGS.len(), BINDINGS.len()));
        for &(code, ..) in &BINDINGS {
            let mut held = Held::default();
            held.set(code, true);
            assert!(!held.motion().moves(), "{code:?} moves the camera too");
        }
    }

    #[test]
    fn keys_are_found_by_code_and_name() {
        assert_eq!(shortcut(KeyCode::KeyF), Some(Shortcut::Frame));
        assert_eq!(shortcut_named("f1"), Some(Shortcut::Help));
        assert_eq!(shortcut(KeyCode::KeyW), None);
        assert_eq!(shortcut_named("nothing"), None);
    }

    #[test]
    fn held_keys_add_up_and_cancel() {
        let mut held = Held::default();
        held.set(KeyCode::KeyW, true);
        held.set(KeyCode::KeyW, true);
        held.set(KeyCode::ShiftLeft, true);
        assert_eq!(held.motion(), Motion { ahead: 1.0, faster: true, ..Motion::default() });
        held.set(KeyCode::ArrowDown, true);
        assert!(!held.motion().moves());
        held.set(KeyCode::KeyW, false);
        assert_eq!(held.motion().ahead, -1.0);
        held.clear();
        assert_eq!(held.motion(), Motion::default());
    }
}
