//! Which configurations a chart has, and in which order.

use super::super::budget::refinements;
use super::super::configuration::{Configuration, Extent};
use crate::scene::{Direct, FirstHit, Memory, Placement, Scene, Tracking};

/// Edges of cells in radii of the thinnest fiber, beside the usual one and half of it.
const EDGES: [f64; 2] = [8.0, 4.0];
/// Edges that are nearer to the usual one than this factor are left out.
const NEAR: f64 = 1.4;
/// Numbers of directions.
const DIRECTIONS: [u32; 3] = [256, 1024, 4096];
/// Half angle of a cone in degrees, where the scene has none.
const CONE_DEG: f64 = 2.0;
/// Walks through one realization, as factors of the usual number.
const EACH: [(u64, u64); 3] = [(1, 4), (4, 1), (1, 16)];

/// The configurations of a cloth: the fibers themselves, the medium that the scene asks for, a few that are far from it, the
/// refinements that an error budget needs, and then all products of the settings, those first that differ from the scene's medium in
/// the fewest.
pub fn sweep(scene: &Scene, extent: &Extent) -> Vec<Configuration> {
    let fibers = Configuration::usual_fibers(scene);
    let base = Configuration::of(scene, extent);
    let (finer, halved, finest) = refinements(base, extent);
    let coarse = if base.edge.is_some() { base.edged(EDGES[0]) } else { base.directed(DIRECTIONS[0]) };
    let mut list = vec![fibers, base, coarse];
    let paper = base.placed(Placement::AtHit);
    list.push(if paper == base.placed(base.model.placement) { base.placed(Placement::Carried) } else { paper });
    list.extend([Some(finer), halved, Some(finest)].into_iter().flatten());
    let mut products = products(base, halved, finest);
    products.sort_by_key(|configuration| differences(configuration, &base));
    let (near, far) = products.split_at(products.len().min(12));
    list.extend(near);
    let each = fibers.each.unwrap_or(1);
    list.extend(EACH.map(|(more, fewer)| Configuration::fibers(scene, each * more / fewer)));
    list.extend(far);
    // Keep the first of equal names.
    let mut seen = std::collections::HashSet::new();
    list.retain(|configuration| seen.insert(configuration.name()));
    list
}

/// All products of the settings.
fn products(base: Configuration, halved: Option<Configuration>, finest: Configuration) -> Vec<Configuration> {
    let apart = |edge: &f64| base.edge.is_none_or(|usual| *edge > usual * NEAR || *edge * NEAR < usual);
    let mut sizes = vec![base];
    if base.edge.is_some() {
        sizes.extend(EDGES.into_iter().filter(apart).map(|edge| base.edged(edge)));
    }
    sizes.extend(halved);
    let placements = [Placement::AtHit, Placement::Carried, Placement::CarriedDense, Placement::CarriedVoid];
    let ways = placements.map(|placement| (Tracking::NullCollision, placement));
    let ways = ways.into_iter().chain([(Tracking::Tabulated, Placement::AtHit)]);
    let mut directions = DIRECTIONS.to_vec();
    directions.extend([base.model.directions, finest.model.directions]);
    directions.sort_unstable();
    directions.dedup();
    let mut cones = vec![base.cone_deg().unwrap_or_default()];
    cones.extend(base.cone_deg().map(|cone| if cone > 0.0 { 0.0 } else { CONE_DEG }));
    let mut list = Vec::new();
    for (tracking, placement) in ways {
        for size in &sizes {
            for &directions in &directions {
                for &cone in &cones {
                    for [lit, hit] in [[false, false], [true, false], [false, true], [true, true]] {
                        let way = size.tracked(tracking).placed(placement).directed(directions).coned(cone);
                        let (direct, first_hit) = others(&base);
                        let way = if lit { way.lit(direct) } else { way };
                        list.push(if hit { way.hit_first(first_hit) } else { way });
                    }
                    let way = size.tracked(tracking).placed(placement).directed(directions).coned(cone);
                    if placement != Placement::AtHit {
                        let other = if way.model.memory == Memory::None { Memory::Flight } else { Memory::None };
                        list.push(way.remembering(other));
                    }
                }
            }
        }
    }
    list
}

/// The other sources of direct light and of first hits.
fn others(base: &Configuration) -> (Direct, FirstHit) {
    let direct = match base.model.direct {
        Direct::Walks => Direct::Straight,
        Direct::Straight => Direct::Walks,
    };
    let first_hit = match base.model.first_hit {
        FirstHit::Medium => FirstHit::Fibers,
        FirstHit::Fibers => FirstHit::Medium,
    };
    (direct, first_hit)
}

/// In how many settings two configurations differ; where there are as many, large cells go first.
fn differences(a: &Configuration, b: &Configuration) -> (usize, u64) {
    let settings = [
        a.model.tracking != b.model.tracking,
        a.model.placement != b.model.placement && a.model.tracking == b.model.tracking,
        (a.edge, a.model.cells) != (b.edge, b.model.cells),
        a.model.directions != b.model.directions,
        a.model.cone != b.model.cone,
        a.model.direct != b.model.direct,
        a.model.first_hit != b.model.first_hit,
        a.model.memory != b.model.memory && a.model.placement == b.model.placement,
    ];
    let edge = a.edge.unwrap_or_default();
    (settings.iter().filter(|differs| **differs).count(), (1e6 / edge.max(1e-3)) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Medium, Source};
    use std::collections::HashSet;

    fn names(cloth: &str) -> Vec<String> {
        let scene = Scene::parse(&Source::find(cloth).expect("a preset")).expect("it is fine");
        let extent = Extent::of(&scene).expect("it can be laid out");
        let list = sweep(&scene, &extent);
        assert!(list.iter().all(|configuration| configuration.model.conflict().is_none()));
        assert!(list.iter().filter(|configuration| configuration.model.medium == Medium::Explicit).count() == 4);
        list.iter().map(Configuration::name).collect()
    }

    #[test]
    fn a_few_that_are_far_apart_come_first_and_all_products_are_there() {
        let voile = names("voile");
        let head = ["fibers 64w", "carried 2R 4096d", "carried 8R 4096d", "at-hit 2R 4096d", "carried 2R 16384d"];
        assert_eq!(voile[..5], head);
        // 5 ways, 4 edges, 4 numbers of directions, 2 cones, 2 sources of direct light and of first hits; those of 3 placements without
        // memory; and the fibers.
        assert_eq!(voile.len(), 640 + 96 + 4);
        assert_eq!(voile.iter().collect::<HashSet<_>>().len(), voile.len());
        assert!(voile.contains(&"tabulated at-hit 8R 256d cone 2 direct by walks first hit in the medium".into()));
        let felt = names("felt");
        assert_eq!(felt[..3], ["fibers 64w", "at-hit 1024d", "at-hit 256d"]);
        assert_eq!(felt.len(), 5 * 3 * 2 * 2 + 3 * 3 + 4);
    }
}
