//! Broken files: opened and culled, or refused, but never a panic.

use crate::fuzz;
use crate::fuzz::stage::stage;

#[test]
fn mutated_scenes() {
    fuzz::smoke::smoke("scene", stage);
}

#[test]
fn mutated_bakes() {
    fuzz::smoke::smoke("extension", stage);
}
