//! `svs serve`: the viewer in a browser.

use super::error::Failure;
use super::output;
use clap::Args;
use serde_json::json;
use std::path::PathBuf;
use svs::serve::{Server, Site};

/// Look at a scene in a browser, on this machine alone
///
/// Prints an address to open. Nothing leaves the machine: the server listens on 127.0.0.1 and answers to no other name. It
/// runs until Ctrl-C. The page comes from `cargo xtask wasm`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  svs serve plant.svs.glb --open
  svs serve plant.svs.glb --port 8080
  svs serve plant.svs.glb --site viewer-web/dist     a page built elsewhere")]
pub(crate) struct Serve {
    /// Scene to show: .glb or .gltf
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Port to listen on [default: any free one]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub(crate) port: u16,
    /// Open the address in the default browser
    #[arg(long)]
    pub(crate) open: bool,
    /// Folder of the built page [default: viewer-web/dist of the sources]
    #[arg(long, value_name = "DIR")]
    pub(crate) site: Option<PathBuf>,
}

pub(crate) fn run(args: &Serve, common: &super::args::Common) -> Result<(), Failure> {
    let built = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("viewer-web").join("dist");
    let folder = args.site.clone().unwrap_or_else(built);
    let fail = |error: svs::serve::ServeError| Failure::Input(error.to_string());
    let site = Site::open(&folder).map_err(fail)?;
    let server = Server::bind(site, &args.file, args.port).map_err(fail)?;
    let url = server.url();
    output::print(common, &json!({ "url": url }), &format!("{url}\nCtrl-C ends it.\n"))?;
    if args.open
        && let Err(error) = open::that_detached(&url)
    {
        eprintln!("no browser could be opened ({error}): open the address yourself");
    }
    server.run();
    Ok(())
}
