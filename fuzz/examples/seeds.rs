//! Writes the small documents that fuzzing starts from into `fuzz/corpus/TARGET/`.

#[path = "../common/mod.rs"]
mod common;

use std::path::Path;

fn main() -> std::io::Result<()> {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    for (target, seeds) in common::seeds::all() {
        let folder = corpus.join(target);
        std::fs::create_dir_all(&folder)?;
        for (number, seed) in seeds.iter().enumerate() {
            std::fs::write(folder.join(format!("seed-{number}")), seed)?;
        }
        println!("{}: {} files", folder.display(), seeds.len());
    }
    Ok(())
}
