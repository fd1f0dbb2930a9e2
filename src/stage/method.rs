//! Ways to choose what is drawn.

use std::fmt;
use std::str::FromStr;

/// How the objects to draw are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    /// Everything is drawn.
    Nothing,
    /// What the frustum touches.
    Frustum,
    /// What the baked visibility says is seen; in files without it, and for objects in no tree, what the frustum touches.
    Visibility,
    /// What at least one pixel shows: found out by drawing an item buffer, so it costs more than it saves. The reference.
    Exact,
}

impl Method {
    /// All methods, from most to least drawn.
    pub const ALL: [Method; 4] = [Method::Nothing, Method::Frustum, Method::Visibility, Method::Exact];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Method::Nothing => "nothing",
            Method::Frustum => "frustum",
            Method::Visibility => "visibility",
            Method::Exact => "exact",
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that no method has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no method {name:?}: use nothing, frustum, visibility or exact")]
pub struct UnknownMethod {
    /// What was asked for.
    pub name: String,
}

impl FromStr for Method {
    type Err = UnknownMethod;

    fn from_str(name: &str) -> Result<Self, UnknownMethod> {
        let method = Method::ALL.into_iter().find(|method| method.name() == name);
        method.ok_or_else(|| UnknownMethod { name: name.to_owned() })
    }
}
