//! The samples' materials: a muted industrial palette.

use serde_json::{Value, json};

/// A material. Colours are linear, as glTF wants them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Paint {
    Concrete,
    RoofSheet,
    WallSheet,
    Sage,
    SlateBlue,
    Sand,
    Graphite,
    Louvre,
    Steel,
    Brass,
    Copper,
    Iron,
    SafetyYellow,
    SignalRed,
    PipeGreen,
    PipeBlue,
    Timber,
    Facade,
    FacadeBrick,
    FacadeGrey,
    Plaster,
    Blind,
    Grass,
    Leaf,
    Bark,
    RoofTar,
}

impl Paint {
    /// Name, red, green, blue, metalness, roughness, thin sheet (drawn and hiding from both sides).
    fn recipe(self) -> (&'static str, [f64; 3], f64, f64, bool) {
        match self {
            Paint::Concrete => ("concrete", [0.40, 0.39, 0.37], 0.0, 0.95, true),
            Paint::RoofSheet => ("roof sheet", [0.33, 0.36, 0.38], 0.2, 0.7, true),
            Paint::WallSheet => ("wall sheet", [0.55, 0.56, 0.53], 0.1, 0.75, true),
            Paint::Sage => ("sage housing", [0.25, 0.35, 0.29], 0.1, 0.6, true),
            Paint::SlateBlue => ("slate blue housing", [0.15, 0.24, 0.34], 0.1, 0.6, true),
            Paint::Sand => ("sand housing", [0.52, 0.44, 0.30], 0.1, 0.65, true),
            Paint::Graphite => ("graphite housing", [0.12, 0.13, 0.14], 0.2, 0.6, true),
            Paint::Louvre => ("louvre", [0.20, 0.21, 0.22], 0.3, 0.5, true),
            Paint::Steel => ("steel", [0.46, 0.48, 0.50], 0.6, 0.4, false),
            Paint::Brass => ("brass", [0.58, 0.43, 0.18], 0.6, 0.4, false),
            Paint::Copper => ("copper", [0.54, 0.27, 0.17], 0.6, 0.4, false),
            Paint::Iron => ("cast iron", [0.13, 0.14, 0.15], 0.4, 0.7, false),
            Paint::SafetyYellow => ("safety yellow", [0.68, 0.45, 0.07], 0.0, 0.6, false),
            Paint::SignalRed => ("signal red", [0.45, 0.08, 0.06], 0.0, 0.6, false),
            Paint::PipeGreen => ("pipe green", [0.12, 0.30, 0.22], 0.1, 0.5, false),
            Paint::PipeBlue => ("pipe blue", [0.12, 0.24, 0.40], 0.1, 0.5, false),
            Paint::Timber => ("timber", [0.40, 0.26, 0.14], 0.0, 0.9, false),
            Paint::Facade => ("render, ivory", [0.62, 0.57, 0.47], 0.0, 0.9, true),
            Paint::FacadeBrick => ("brick", [0.38, 0.19, 0.13], 0.0, 0.9, true),
            Paint::FacadeGrey => ("render, grey", [0.36, 0.38, 0.39], 0.0, 0.9, true),
            Paint::Plaster => ("plaster", [0.66, 0.64, 0.59], 0.0, 0.95, true),
            Paint::Blind => ("blind", [0.50, 0.46, 0.38], 0.0, 0.8, true),
            Paint::Grass => ("ground", [0.20, 0.25, 0.13], 0.0, 1.0, true),
            Paint::Leaf => ("leaves", [0.11, 0.22, 0.08], 0.0, 0.9, false),
            Paint::Bark => ("bark", [0.20, 0.13, 0.08], 0.0, 0.9, false),
            Paint::RoofTar => ("roof", [0.16, 0.16, 0.17], 0.0, 0.95, false),
        }
    }

    /// Name of the material.
    pub(super) fn name(self) -> &'static str {
        self.recipe().0
    }

    /// The glTF material.
    pub(super) fn material(self) -> Value {
        let (name, [red, green, blue], metalness, roughness, sheet) = self.recipe();
        let mut material = json!({
            "name": name,
            "pbrMetallicRoughness": {
                "baseColorFactor": [red, green, blue, 1],
                "metallicFactor": metalness,
                "roughnessFactor": roughness,
            },
        });
        if sheet {
            material["doubleSided"] = true.into();
        }
        material
    }
}
