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
    /// Sort of device: 0 a graphics card, 1 a part of the processor, 2 virtual, 3 unknown, 4 software. Lower ones come first
    /// without a measurement.
    pub rank: u8,
    /// Its limits.
    pub limits: Limits,
    /// Why it cannot be used, if so: it keeps less than the default limits.
    pub unfit: Option<String>,
}

/// An adapter that was found.
#[derive(Clone, Debug)]
pub struct Found {
    pub(super) adapter: Adapter,
    /// What is known of it.
    pub summary: AdapterSummary,
}

/// All adapters, the best first, those that cannot be used last.
pub fn list() -> Vec<Found> {
    let instance = Instance::new(InstanceDescriptor::new_without_display_handle_from_env());
    let adapters = pollster::block_on(instance.enumerate_adapters(Backends::all()));
    let mut found: Vec<Found> =
        adapters.into_iter().map(|adapter| Found { summary: summary(&adapter), adapter }).collect();
    found.sort_by_key(|Found { adapter, summary }| {
        (summary.unfit.is_some(), summary.rank, backend_rank(adapter.get_info().backend))
    });
    found
}

/// The adapters to try, in this order: all that are fit, or the one that `name` means.
///
/// A name is the adapter's number in [`list`] from 1, its whole name, or a part of its description, in any case.
pub(super) fn find(name: Option<&str>) -> Result<Vec<Found>> {
    let adapters = list();
    let Some(name) = name else {
        let fit: Vec<Found> = adapters.into_iter().filter(|found| found.summary.unfit.is_none()).collect();
        return if fit.is_empty() { Err(none(&[])) } else { Ok(fit) };
    };
    if adapters.is_empty() {
        return Err(none(&[]));
    }
    let summaries: Vec<&AdapterSummary> = adapters.iter().map(|found| &found.summary).collect();
    let same = |text: &str| text.to_lowercase() == name.to_lowercase();
    let part = |text: &str| text.to_lowercase().contains(&name.to_lowercase());
    let places = |fits: &dyn Fn(&AdapterSummary) -> bool| -> Vec<usize> {
        (0..summaries.len()).filter(|&place| fits(summaries[place])).collect()
    };
    let numbered: Option<usize> = name.parse().ok().filter(|number| (1..=summaries.len()).contains(number));
    let found = match numbered {
        Some(number) => vec![number - 1],
        None => Some(places(&|known| same(&known.name)))
            .filter(|places| !places.is_empty())
            .unwrap_or_else(|| places(&|known| part(&known.description))),
    };
    if let [place] = found[..] {
        return Ok(vec![adapters[place].clone()]);
    }
    let numbered = |place: usize| format!("{} {}", place + 1, summaries[place].description);
    let (needed, shown) = if found.is_empty() {
        (format!("an adapter named `{name}` was asked for"), "there is only".to_owned())
    } else {
        (format!("one adapter named `{name}` was asked for"), format!("there are {}", found.len()))
    };
    let candidates = if found.is_empty() { (0..summaries.len()).collect() } else { found };
    let list: Vec<String> = candidates.into_iter().map(numbered).collect();
    Err(Error::Device { needed, found: format!("{shown}: {}", list.join("; ")) })
}

/// That there is no adapter, or none of those that are there can be used, for these reasons.
pub fn none(passed_over: &[String]) -> Error {
    let needed = "the gpu engine needs a Vulkan, Metal or DX12 driver with the default limits of WebGPU";
    let found = match passed_over {
        [] => format!("no adapter was found; {ADVICE}"),
        faults => faults.join("; "),
    };
    Error::Device { needed: needed.into(), found }
}

/// Describe an adapter.
fn summary(adapter: &Adapter) -> AdapterSummary {
    let info = adapter.get_info();
    let driver = [info.driver.as_str(), info.driver_info.as_str()].join(" ");
    let limits = adapter.limits();
    let mut unfit = None;
    Limits::default().check_limits_with_fail_fn(&limits, true, |limit, needed, found| {
        unfit = Some(format!("{limit} is {found}, but must be {needed}"));
    });
    AdapterSummary {
        description: format!("{}, {}, {}", info.name, info.backend, driver.trim()),
        name: info.name,
        kind: if info.device_type == DeviceType::Cpu { Kind::Software } else { Kind::Hardware },
        rank: rank(info.device_type),
        limits,
        unfit,
    }
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
