//! Reads `EXT_spherical_visibility` and answers, per camera, what to draw.
