//! Bases: the same light through cells of the disc, of Klems and of polar rings.

use crate::common::stats::GATE;
use crate::common::{Cloth, SplitMix, run};
use fiberwalk::bsdf::{Component, hemispherical, reciprocity};
use fiberwalk::goniometer::{Basis, Goniometer, Tally};
use fiberwalk::reference::Reference;
use fiberwalk::scene::{BasisChoice, Side};
use fiberwalk::walk::WalkPlan;
use glam::DVec2;
use std::f64::consts::PI;

/// Walks in all, however many incident cells there are.
const WALKS: u64 = 600_000;
/// Edges in θ of the sums over rings, in degrees: edges of Klems and of the polar grid.
const RINGS: [f64; 4] = [15.0, 45.0, 75.0, 90.0];

fn lossless() -> Cloth {
    Cloth::isotropic(1.5)
}

/// A measurement with bases of names; each from random numbers of its own.
fn measured(cloth: Cloth, incident: &str, exit: &'static str, seed: u64) -> (Tally, Goniometer) {
    let cloth = cloth.lit_from(incident).counted_in(exit);
    let goniometer = Goniometer::new(&cloth.scene().measure);
    let walks = WALKS / goniometer.starts() as u64;
    (run("cpu", &Reference, &cloth, &WalkPlan::new(seed, walks)), goniometer)
}

/// Light of the front from the whole hemisphere that leaves between circles of equal θ, reflected and transmitted, with
/// its standard error: every start counts by its projected solid angle.
fn ring_sums(tally: &Tally, goniometer: &Goniometer) -> Vec<(f64, f64)> {
    let basis = goniometer.incident_basis().expect("there are cells");
    let walks = tally.walks_per_incident() as f64;
    let cells = goniometer.exit.cells();
    let ring = |cell: usize| {
        let theta = goniometer.exit.centre(cell).z.acos().to_degrees();
        RINGS.iter().position(|edge| theta < *edge).expect("it is on the hemisphere")
    };
    let mut sums = vec![(0.0, 0.0); 2 * RINGS.len()];
    for start in 0..basis.cells() {
        let weight = basis.projected_solid_angle(start) / PI;
        let mut counts = vec![0; 2 * RINGS.len()];
        for cell in 0..2 * cells {
            counts[cell / cells * RINGS.len() + ring(cell % cells)] += tally.of_start(start)[cell];
        }
        for (sum, count) in sums.iter_mut().zip(counts) {
            let share = count as f64 / walks;
            sum.0 += weight * share;
            sum.1 += weight * weight * share * (1.0 - share) / (walks - 1.0);
        }
    }
    sums.into_iter().map(|(value, variance)| (value, variance.sqrt())).collect()
}

/// The largest z between two lists.
fn farthest(a: &[(f64, f64)], b: &[(f64, f64)]) -> f64 {
    a.iter().zip(b).map(|(a, b)| ((a.0 - b.0) / a.1.hypot(b.1)).abs()).fold(0.0, f64::max)
}

#[test]
fn a_lossless_sheet_has_the_same_energy_and_ring_sums_in_every_basis() {
    let pairs =
        [("\"klems\"", "klems"), ("\"polar:6x4\"", "polar:18x36"), ("7", "polar:6x1"), ("\"polar:18x1\"", "klems")];
    let all = pairs.map(|(incident, exit)| measured(lossless(), incident, exit, 50 + incident.len() as u64));
    let sums = all.each_ref().map(|(tally, goniometer)| ring_sums(tally, goniometer));
    for ((tally, goniometer), (incident, exit)) in all.iter().zip(pairs) {
        let mean = hemispherical(tally, goniometer, 0, 0).expect("cells have a mean");
        let sum = mean.reflectance.value + mean.transmittance.value + mean.direct.value + mean.lost;
        println!("{incident} to {exit}: {:.5} reflected of {sum}", mean.reflectance.value);
        assert!((sum - 1.0).abs() < 1e-12, "{incident} to {exit}: {sum}");
        let z = farthest(&ring_sums(tally, goniometer), &sums[0]);
        println!("  farthest ring: z = {z:.1}");
        // The largest of eight.
        assert!(z < GATE, "{incident} to {exit}: z = {z}");
    }
    // Another sheet shows.
    let (tally, goniometer) = measured(Cloth { ior: 1.53, ..lossless() }, "\"klems\"", "klems", 70);
    let z = farthest(&ring_sums(&tally, &goniometer), &sums[0]);
    assert!(z > GATE, "an index of 1.53 for 1.5: z = {z}");
    // Cells that all count alike show as well, since those of rings do not.
    let (tally, goniometer) = &all[1];
    let equal = |cell: usize| tally.reflection(cell).iter().sum::<u64>() as f64 / tally.walks_per_incident() as f64;
    let cells = goniometer.incident_cells();
    let unweighted = (0..cells).map(equal).sum::<f64>() / cells as f64;
    let right = hemispherical(tally, goniometer, 0, 0).expect("cells have a mean").reflectance;
    assert!((unweighted - right.value).abs() > GATE * right.stderr, "{unweighted} and {right:?}");
}

#[test]
fn cells_are_as_large_as_the_directions_that_fall_into_them() {
    // Directions that are even over the projected disc, from a generator of another kind.
    let mut random = SplitMix(9);
    const DRAWS: u32 = 400_000;
    for choice in [BasisChoice::Disc(9), BasisChoice::Klems, BasisChoice::Polar { rings: 9, sectors: 8 }] {
        let basis = Basis::new(choice);
        let mut counts = vec![0u32; basis.cells()];
        for _ in 0..DRAWS {
            let (turn, square) = (random.uniform(), random.uniform());
            counts[basis.cell_of(DVec2::from_angle(std::f64::consts::TAU * turn) * square.sqrt())] += 1;
        }
        let chi_square = |shift: usize| -> f64 {
            let term = |(cell, &count): (usize, &u32)| {
                let cell = (cell + shift) % basis.cells();
                let expected = f64::from(DRAWS) * basis.projected_solid_angle(cell) / PI;
                (f64::from(count) - expected).powi(2) / expected
            };
            counts.iter().enumerate().map(term).sum()
        };
        let z = crate::common::stats::chi2_z(chi_square(0), (basis.cells() - 1) as f64);
        println!("{choice}: z = {z:.1}");
        assert!(z.abs() < GATE, "{choice}: z = {z}");
        // Sizes of the neighbours would not do, where neighbours differ.
        let shifted = crate::common::stats::chi2_z(chi_square(1), (basis.cells() - 1) as f64);
        assert!(shifted > GATE || matches!(choice, BasisChoice::Disc(_)), "{choice}: {shifted}");
    }
}

#[test]
fn light_is_reciprocal_in_rings() {
    let slanted =
        |sides: &str| Cloth { sides: sides.into(), ..Cloth::new(60.0, &crate::common::aligned([0.8, 0.5, 0.3])) };
    for (incident, exit) in [("\"klems\"", "klems"), ("\"polar:4x6\"", "polar:8x12")] {
        let (mut tally, goniometer) = measured(slanted("[\"front\", \"back\"]"), incident, exit, 81);
        let z = |tally: &Tally, component| {
            let r =
                reciprocity(tally, &goniometer, component, Side::Front, 0).expect("exit cells lie in incident cells");
            assert!(r.pairs > 50, "{} pairs", r.pairs);
            crate::common::stats::chi2_z(r.chi_square, r.pairs as f64)
        };
        let found = [Component::Reflection, Component::Transmission].map(|component| z(&tally, component));
        println!("{incident} to {exit}: z = {found:.1?}");
        assert!(found.iter().all(|z| z.abs() < GATE), "{incident}: {found:?}");
        // Turn the exits of every start by one sector: the light of the bins stays, but not its way back.
        let stride = tally.layout.stride();
        let cells = tally.layout.exit_cells;
        for start in tally.bins.chunks_mut(stride) {
            start[..cells].rotate_left(1);
        }
        let turned = z(&tally, Component::Reflection);
        assert!(turned > GATE, "{incident}: turned, z = {turned}");
    }
    let (tally, goniometer) = measured(slanted("[\"front\"]"), "\"polar:4x6\"", "klems", 82);
    assert!(reciprocity(&tally, &goniometer, Component::Reflection, Side::Front, 0).is_none());
}
