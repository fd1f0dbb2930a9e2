//! The machine that measured: no figure means anything without it.

use serde::Serialize;
use svs_render::wgpu::{AdapterInfo, DeviceType};

/// The machine that measured.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// Processor.
    pub cpu: String,
    /// Threads it runs at once, as the system reports them.
    pub cores: usize,
    /// Operating system and architecture.
    pub system: String,
    /// Graphics adapter.
    pub adapter: String,
    /// Kind of adapter: discrete, integrated, virtual, software.
    pub adapter_kind: String,
    /// Graphics interface: Vulkan, Metal, …
    pub backend: String,
    /// Driver and its version.
    pub driver: String,
    /// Version of this program.
    pub version: String,
}

impl Machine {
    /// This one, with its graphics adapter.
    pub fn this(info: AdapterInfo) -> Self {
        let kind = match info.device_type {
            DeviceType::DiscreteGpu => "discrete",
            DeviceType::IntegratedGpu => "integrated",
            DeviceType::VirtualGpu => "virtual",
            DeviceType::Cpu => SOFTWARE,
            DeviceType::Other => "unknown",
        };
        let driver = [info.driver, info.driver_info].into_iter().filter(|text| !text.is_empty());
        Self {
            cpu: cpu().unwrap_or_else(|| std::env::consts::ARCH.to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            adapter: info.name,
            adapter_kind: kind.to_owned(),
            backend: info.backend.to_string(),
            driver: driver.collect::<Vec<_>>().join(", "),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        }
    }

    /// The adapter is a program on the CPU.
    pub fn is_software(&self) -> bool {
        self.adapter_kind == SOFTWARE
    }
}

const SOFTWARE: &str = "software";

/// Name of the processor, where the system tells it in a file.
fn cpu() -> Option<String> {
    model_name(&std::fs::read_to_string("/proc/cpuinfo").ok()?)
}

fn model_name(cpuinfo: &str) -> Option<String> {
    let line = cpuinfo.lines().find_map(|line| line.strip_prefix("model name"))?;
    let name = line.trim_start_matches([' ', '\t', ':']).trim();
    (!name.is_empty()).then(|| name.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_processor_is_found() {
        assert_eq!(
            model_name("processor\t: 0\nmodel name\t: A CPU @ 2 GHz\n").as_deref(),
            Some("A CPU @ 2 GHz")
        );
        assert_eq!(model_name("processor\t: 0\nmodel name\t:\n"), None);
        assert_eq!(model_name(""), None);
    }
}
