//! Finding adapters: the only place that makes a `wgpu::Instance`.

use crate::error::{Error, Result};
use wgpu::{Adapter, Backend, Backends, DeviceType, Instance, InstanceDescriptor, Limits};

/// What helps when there is none.
const ADVICE: &str = "on Debian-like systems the packages mesa-vulkan-drivers and libvulkan1 bring a software adapter";

/// Whether an adapter is a device or a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A graphics processor.
    Hardware,
    /// A Vulkan driver that runs on the processor, such as Mesa's lavapipe.
    Software,
}

/// What is known of an adapter before it is opened.
#[derive(Clone, Debug)]
pub struct AdapterSummary {
    /// Its name.
    pub name: String,
    /// Name, backend and driver on one line.
    pub description: String,
    /// What it is.
    pub kind: Kind,
    /// Its limits.
    pub limits: Limits,
}

/// All adapters, the best first.
pub fn list() -> Vec<AdapterSummary> {
    adapters().iter().map(summary).collect()
}

/// The best adapter that fits; `name` is part of its name, in any case.
pub(super) fn find(name: Option<&str>) -> Result<Adapter> {
    let adapters = adapters();
    let names: Vec<String> = adapters.iter().map(|adapter| summary(adapter).name).collect();
    let fits = |adapter: &Adapter| {
        let known = adapter.get_info().name.to_lowercase();
        name.is_none_or(|name| known.contains(&name.to_lowercase()))
    };
    let found = adapters.into_iter().find(fits);
    found.ok_or_else(|| match name {
        _ if names.is_empty() => Error::Device {
            needed: "the gpu engine needs a Vulkan, Metal or DX12 driver".into(),
            found: format!("no adapter was found; {ADVICE}"),
        },
        Some(name) => Error::Device {
            needed: format!("an adapter named `{name}` was asked for"),
            found: format!("there is only: {}", names.join(", ")),
        },
        None => unreachable!("without a name the first adapter fits"),
    })
}

/// The adapter at a place of [`list`].
pub(super) fn at(place: usize) -> Result<Adapter> {
    adapters()
        .into_iter()
        .nth(place)
        .ok_or_else(|| Error::Device { needed: "an adapter was listed".into(), found: "it is no longer there".into() })
}

/// Describe an adapter.
pub(super) fn summary(adapter: &Adapter) -> AdapterSummary {
    let info = adapter.get_info();
    let driver = [info.driver.as_str(), info.driver_info.as_str()].join(" ");
    AdapterSummary {
        description: format!("{}, {}, {}", info.name, info.backend, driver.trim()),
        name: info.name,
        kind: if info.device_type == DeviceType::Cpu { Kind::Software } else { Kind::Hardware },
        limits: adapter.limits(),
    }
}

/// All adapters that keep the default limits, the best first.
fn adapters() -> Vec<Adapter> {
    let instance = Instance::new(InstanceDescriptor::new_without_display_handle_from_env());
    let mut adapters = pollster::block_on(instance.enumerate_adapters(Backends::all()));
    adapters.retain(|adapter| Limits::default().check_limits(&adapter.limits()));
    adapters.sort_by_key(|adapter| {
        let info = adapter.get_info();
        (rank(info.device_type), backend_rank(info.backend))
    });
    adapters
}

fn rank(device: DeviceType) -> u8 {
    match device {
        DeviceType::DiscreteGpu => 0,
        DeviceType::IntegratedGpu => 1,
        DeviceType::VirtualGpu => 2,
        DeviceType::Other => 3,
        DeviceType::Cpu => 4,
    }
}

/// The same device behind two backends: Vulkan and Metal first.
fn backend_rank(backend: Backend) -> u8 {
    match backend {
        Backend::Vulkan | Backend::Metal => 0,
        _ => 1,
    }
}
