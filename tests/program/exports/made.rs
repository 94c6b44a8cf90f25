//! Tables made by hand.

use fiberwalk::bsdf::{Bsdf, Component};
use fiberwalk::export::{Format, Written};
use fiberwalk::goniometer::{Basis, BinLayout, Coverage, Goniometer, Incidence, Moments, Origin, Tally};
use fiberwalk::scene::{BasisChoice, Side};
use glam::DVec3;
use std::path::PathBuf;

pub const SIDES: [Side; 2] = [Side::Front, Side::Back];
pub const COMPONENTS: [Component; 2] = [Component::Reflection, Component::Transmission];
/// Walks of each start: errors are far below what files round.
const WALKS: u64 = 1 << 40;
const UNIT: u64 = fiberwalk::goniometer::WEIGHT;

/// Shares of light in red, green and blue that go from an incident cell of a side into an exit cell of a component.
type Light<'a> = &'a dyn Fn(&Goniometer, Side, Component, usize, usize) -> [f64; 3];

/// A table of red, green and blue whose share of light from cell to cell is `light`, with `direct` light.
pub fn table(incident: BasisChoice, exit: BasisChoice, light: Light, direct: &dyn Fn(usize) -> f64) -> Bsdf {
    let goniometer =
        Goniometer { incidence: Incidence::Cells(Basis::new(incident)), exit: Basis::new(exit), sides: SIDES.to_vec() };
    let origin = Origin { seed: 1, engine: "cpu".into(), adapter: "made".into() };
    let (cells, exits) = (goniometer.incident_cells(), goniometer.exit.cells());
    let mut tally = Tally::new(origin.clone(), BinLayout { exit_cells: exits }, goniometer.starts(), Some(3));
    tally.coverage = Coverage::new(origin, 0..WALKS);
    let stride = tally.layout.stride();
    for (side, cell) in (0..2).flat_map(|side| (0..cells).map(move |cell| (side, cell))) {
        let start = side * cells + cell;
        let mut left = WALKS;
        for (part, bin) in (0..2).flat_map(|part| (0..exits).map(move |bin| (part, bin))) {
            let shares = light(&goniometer, SIDES[side], COMPONENTS[part], cell, bin);
            let walks = (shares.iter().fold(0.0, |most: f64, share| most.max(*share)) * WALKS as f64).round() as u64;
            tally.bins[start * stride + part * exits + bin] = walks;
            left -= walks;
            let weights = tally.weights.as_mut().expect("it has weights");
            for (channel, share) in shares.into_iter().enumerate() {
                let sum = (share * (WALKS * UNIT) as f64).round() as u64;
                // As if every walk had the same weight.
                let square = if walks > 0 { (sum as f64 * sum as f64 / walks as f64) as u64 } else { 0 };
                weights.moments[(start * (2 * exits + 1) + part * exits + bin) * 3 + channel] = Moments { sum, square };
            }
        }
        let straight = (direct(cell) * WALKS as f64).round() as u64;
        tally.bins[start * stride + 2 * exits] = straight;
        tally.bins[start * stride + 2 * exits + 1] = left - straight;
    }
    Bsdf::new(&tally, &goniometer, &["R", "G", "B"].map(String::from))
}

/// f of a cloth that there is not: anisotropic, reciprocal, other on every side and in every colour.
pub fn lobe(side: Side, component: Component, wi: DVec3, wo: DVec3) -> [f64; 3] {
    let sum = wi.truncate() + wo.truncate();
    let ridge = (-4.0 * sum.x * sum.x - 1.5 * sum.y * sum.y).exp();
    // Odd under a turn by half, and the same both ways.
    let lean = 1.0 + 0.35 * sum.x + 0.15 * sum.y;
    let (level, colours) = match (component, side) {
        (Component::Reflection, Side::Front) => (0.060, [0.2, 0.6, 1.0]),
        (Component::Reflection, Side::Back) => (0.045, [1.0, 0.7, 0.4]),
        (Component::Transmission, _) => (0.030, [0.5, 1.0, 0.8]),
    };
    colours.map(|colour| colour * level * (1.0 + 2.0 * ridge) * lean)
}

/// The lobes as a table, each cell with the mean over 2 × 2 places of both cells.
pub fn lobes(incident: BasisChoice, exit: BasisChoice) -> Bsdf {
    let places = || (0..4).map(|i| glam::DVec2::new(f64::from(i % 2) * 2.0 + 1.0, f64::from(i / 2) * 2.0 + 1.0) / 4.0);
    let mean = |goniometer: &Goniometer, side: Side, component: Component, cell: usize, bin: usize| {
        let incident = goniometer.incident_basis().expect("it has cells");
        let solid_angle = goniometer.exit.projected_solid_angle(bin);
        let mut sum = [0.0; 3];
        for (wi, wo) in places().flat_map(|a| places().map(move |b| (a, b))) {
            let f = lobe(side, component, incident.direction(cell, wi), goniometer.exit.direction(bin, wo));
            sum.iter_mut().zip(f).for_each(|(sum, f)| *sum += f * solid_angle / 16.0);
        }
        sum
    };
    table(incident, exit, &mean, &|_| 0.05)
}

/// Write a table in a format into a folder that lasts as long as what is given back.
pub fn written(table: &Bsdf, format: Format) -> (tempfile::TempDir, Written) {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let written = format
        .write(table, "a cloth that <there> is \"not\" & never was", "made", Some(0.5))
        .expect("it can be written");
    for file in &written.files {
        std::fs::write(folder.path().join(&file.name), &file.bytes).expect("a file can be written");
    }
    (folder, written)
}

/// The path of a file that was written.
pub fn path(folder: &tempfile::TempDir, name: &str) -> PathBuf {
    let path = folder.path().join(name);
    assert!(path.is_file(), "{name} was written");
    path
}
