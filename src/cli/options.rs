//! What the arguments of `svs build` mean: checked, and in the library's own types.

use super::args::{
    Build, HierarchyName, LayoutName, Proxies, ProxiesName, ProxyFormatName, QualityName, SpheresName,
};
use super::error::Failure;
use super::file;
use std::path::PathBuf;
use svs::bake::hierarchy::HierarchyKind;
use svs::bake::spheres::SphereKind;
use svs::bake::{BakeOptions, HierarchyChoice, Quality};
use svs::gltf::Container;
use svs::proxies::{ProxyFormat, ProxyMode, ProxyOptions};

/// A build that can begin.
#[derive(Debug)]
pub(crate) struct BuildOptions {
    pub(crate) input: PathBuf,
    pub(crate) output: PathBuf,
    pub(crate) report: Option<PathBuf>,
    pub(crate) bake: BakeOptions,
}

impl TryFrom<&Build> for BuildOptions {
    type Error = Failure;

    fn try_from(args: &Build) -> Result<Self, Failure> {
        file::check_output(&args.output)?;
        if let Some(report) = &args.report {
            if *report == args.output || *report == args.input {
                return Err(Failure::Usage(format!(
                    "--report {} would overwrite the scene; name another file",
                    report.display()
                )));
            }
            file::check_folder(report)?;
        }
        if args.layout == LayoutName::Stream && Container::from_path(&args.output) != Some(Container::Glb) {
            return Err(Failure::Usage(
                "--layout stream is for one file with everything in it; name the output .glb".to_owned(),
            ));
        }
        if args.proxies.msft_lod && matches!(args.proxies.proxies, ProxiesName::Off) {
            return Err(Failure::Usage(
                "--msft-lod names simplified meshes, which --proxies auto or --proxies all makes; add one of them"
                    .to_owned(),
            ));
        }
        if args.layout == LayoutName::Stream && args.proxies.proxy_format == ProxyFormatName::Meshopt {
            return Err(Failure::Usage(
                "--layout stream is for data that can be read piece by piece, which compressed proxies cannot; use \
                 --proxy-format quantized with it"
                    .to_owned(),
            ));
        }
        let bake = BakeOptions {
            quality: match args.quality {
                Some(QualityName::Draft) => Quality::Draft,
                Some(QualityName::Standard) | None => Quality::Standard,
                Some(QualityName::High) => Quality::High,
            },
            max_missing_ppm: args.max_missing,
            directions: args.directions.clone(),
            rays: args.rays,
            hierarchy: match args.hierarchy {
                HierarchyName::Auto => HierarchyChoice::Auto,
                HierarchyName::Scene => HierarchyChoice::Kind(HierarchyKind::Scene),
                HierarchyName::Octree => HierarchyChoice::Kind(HierarchyKind::Octree),
                HierarchyName::Bvh => HierarchyChoice::Kind(HierarchyKind::Bvh),
            },
            spheres: match args.spheres {
                SpheresName::Simple => SphereKind::Simple,
                SpheresName::Tight => SphereKind::Tight,
            },
            prune: args.prune,
            proxies: ProxyOptions::from(&args.proxies),
            ..BakeOptions::default()
        };
        Ok(Self { input: args.input.clone(), output: args.output.clone(), report: args.report.clone(), bake })
    }
}

impl From<&Proxies> for ProxyOptions {
    fn from(args: &Proxies) -> Self {
        Self {
            mode: match args.proxies {
                ProxiesName::Auto => ProxyMode::Auto,
                ProxiesName::All => ProxyMode::All,
                ProxiesName::Off => ProxyMode::Off,
            },
            error_pixels: args.proxy_error,
            format: match args.proxy_format {
                ProxyFormatName::Float => ProxyFormat::Float,
                ProxyFormatName::Quantized => ProxyFormat::Quantized,
                ProxyFormatName::Meshopt => ProxyFormat::Meshopt,
            },
            triangles: args.proxy_triangles,
            share: args.proxy_share / 100.0,
            msft_lod: args.msft_lod,
        }
    }
}
