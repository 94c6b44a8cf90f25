//! One way to model a cloth.

use crate::cloth::{Cloth, DrawnFor, Realizer};
use crate::distribution::{cells_of_edge, thinnest_radius, usual_edge};
use crate::error::Result;
use crate::goniometer::Goniometer;
use crate::scene::{Direct, FirstHit, Medium, Memory, Model, Packing, Placement, Scene, Structure, Tracking};
use crate::walk::{Purpose, draw};
use std::fmt::Write;

/// The yarns of a cloth: what cells are cut from, and what draws the fibers.
#[derive(Clone, Debug)]
pub struct Extent {
    /// The yarns; none of a sheet.
    realizer: Option<Realizer>,
}

impl Extent {
    /// Lay out the cloth of a scene; a sheet has no extent.
    ///
    /// # Errors
    /// Those of [`Realizer::new`].
    pub fn of(scene: &Scene) -> Result<Extent> {
        let realizer = match &scene.structure {
            Structure::Sheet(_) => None,
            Structure::Weave(_) | Structure::Knit(_) => {
                Some(Realizer::new(scene, scene.model.packing, DrawnFor::Medium)?.keeping())
            }
        };
        Ok(Extent { realizer })
    }

    /// What draws the fibers of the yarns, each realization of separate ones once; none of a sheet.
    pub fn realizer(&self) -> Option<&Realizer> {
        self.realizer.as_ref()
    }

    fn cloth(&self) -> Option<&Cloth> {
        self.realizer.as_ref().and_then(Realizer::yarns)
    }

    /// Edge of a cell in radii of the thinnest fiber where nothing is said of cells; none of a sheet.
    pub fn usual_edge(&self) -> Option<f64> {
        self.cloth().map(|cloth| usual_edge(cloth) / thinnest_radius(cloth))
    }

    /// Cells along x, y and z of an edge in radii of the thinnest fiber; none of a sheet.
    pub fn cells(&self, edge: f64) -> Option<[u32; 3]> {
        self.cloth().map(|cloth| cells_of_edge(cloth, edge * thinnest_radius(cloth)))
    }
}

/// One way to model a cloth: all settings of the model, with cells by their edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Configuration {
    /// The settings; cells only where they are given as numbers.
    pub model: Model,
    /// Edge of a cell in radii of the thinnest fiber; none of a sheet, of the fibers themselves, and where cells are given.
    pub edge: Option<f64>,
    /// Walks of each start through one realization; of the fibers themselves only.
    pub each: Option<u64>,
    /// Light goes on through another realization after each hit; of the fibers themselves only.
    pub anew: bool,
}

impl Configuration {
    /// The medium that the settings of a scene are for, with the cells that it gets.
    pub fn of(scene: &Scene, extent: &Extent) -> Configuration {
        let model = Model { medium: Medium::Implicit, ..scene.model };
        let edge = if model.cells.is_none() { extent.usual_edge() } else { None };
        Configuration { model, edge, each: None, anew: false }
    }

    /// The fibers themselves, with as many walks of each start through one realization as make 4096 in all, at most 256.
    pub fn usual_fibers(scene: &Scene) -> Configuration {
        let most = (4096 / Goniometer::new(&scene.measure).starts()).clamp(1, 256);
        Configuration::fibers(scene, 1 << most.ilog2())
    }

    /// The fibers themselves, laid as the scene says, with so many walks of each start through one realization.
    pub fn fibers(scene: &Scene, each: u64) -> Configuration {
        let model = Model { medium: Medium::Explicit, cells: None, ..scene.model };
        Configuration { model, edge: None, each: Some(each.max(1)), anew: false }
    }

    /// With light that goes on through another realization after each hit.
    pub fn anew(self) -> Configuration {
        Configuration { anew: true, ..self }
    }

    /// With another placement.
    pub fn placed(mut self, placement: Placement) -> Configuration {
        (self.model.placement, self.model.placement_chosen) = (placement, true);
        self.model.settle();
        self
    }

    /// With another tracking.
    pub fn tracked(mut self, tracking: Tracking) -> Configuration {
        self.model.tracking = tracking;
        self
    }

    /// With cells of another edge in radii of the thinnest fiber.
    pub fn edged(mut self, edge: f64) -> Configuration {
        (self.edge, self.model.cells) = (Some(edge), None);
        self
    }

    /// With another number of directions.
    pub fn directed(mut self, directions: u32) -> Configuration {
        self.model.directions = directions;
        self
    }

    /// With another cone, its half angle in degrees; a sheet has none.
    pub fn coned(mut self, degrees: f64) -> Configuration {
        self.model.cone = self.model.cone.map(|_| degrees.to_radians());
        self
    }

    /// With direct light from elsewhere.
    pub fn lit(mut self, direct: Direct) -> Configuration {
        self.model.direct = direct;
        self
    }

    /// With another memory.
    pub fn remembering(mut self, memory: Memory) -> Configuration {
        (self.model.memory, self.model.memory_chosen) = (memory, true);
        self
    }

    /// With first hits from elsewhere.
    pub fn hit_first(mut self, first_hit: FirstHit) -> Configuration {
        self.model.first_hit = first_hit;
        self
    }

    /// With first hits and direct light of the medium's own.
    pub fn without_rays(self) -> Configuration {
        Configuration { model: self.model.without_rays(), ..self }
    }

    /// With half the edge of the cells; none where there are no cells, or as many as there can be.
    pub fn halved(self, extent: &Extent) -> Option<Configuration> {
        let (cells, finer) = match (self.model.cells, self.edge) {
            (Some(cells), _) => {
                // Of no edge there are as many as there can be.
                let most = extent.cells(0.0)?;
                let finer = [0, 1, 2].map(|axis| (2 * cells[axis]).min(most[axis]));
                (cells, Configuration { model: Model { cells: Some(finer), ..self.model }, ..self })
            }
            (None, Some(edge)) => (extent.cells(edge)?, self.edged(edge / 2.0)),
            (None, None) => return None,
        };
        (finer.cells(extent)? != cells).then_some(finer)
    }

    /// Cells along x, y and z; none of a sheet and of the fibers themselves.
    pub fn cells(&self, extent: &Extent) -> Option<[u32; 3]> {
        self.model.cells.or_else(|| extent.cells(self.edge?))
    }

    /// Half angle of the cone in degrees, without the noise of the conversion.
    pub fn cone_deg(&self) -> Option<f64> {
        self.model.cone.map(|radians| (radians.to_degrees() * 1e9).round() / 1e9)
    }

    /// The scene, modelled this way.
    pub fn apply(&self, scene: &Scene, extent: &Extent) -> Scene {
        let mut scene = scene.clone();
        scene.model = Model { cells: self.cells(extent), ..self.model };
        scene
    }

    /// A seed of its own for its walks, so that they are independent of those of other configurations.
    pub fn seed(&self, seed: u64) -> u64 {
        // Fowler, Noll, Vo: FNV-1a of the name, then mixed with the seed.
        let prime = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        let hash = self.name().bytes().fold(0xcbf2_9ce4_8422_2325, prime);
        let [low, high, ..] = draw(seed, hash, 0, Purpose::Start);
        u64::from(low) | u64::from(high) << 32
    }

    /// A short name that no other way to model the same cloth has, such as `carried 4R 1024d`: placement, edge of cells and number of
    /// directions, and every setting that is not the usual one. The fibers themselves are `fibers 256w`, with the walks of each
    /// start through one realization.
    pub fn name(&self) -> String {
        let Model {
            medium,
            tracking,
            placement,
            direct,
            first_hit,
            memory,
            packing,
            directions,
            length_over_radius,
            ..
        } = self.model;
        let mut name = String::new();
        let usual = Model::of(self.model.cone.is_some());
        if packing != usual.packing {
            name += if packing == Packing::Separate { "separate " } else { "random " };
        }
        if let (Medium::Explicit, Some(each)) = (medium, self.each) {
            return name + &format!("fibers {each}w{}", if self.anew { " anew" } else { "" });
        }
        if tracking == Tracking::Tabulated {
            name += "tabulated ";
        }
        name += placement.name();
        match (self.model.cells, self.edge) {
            (Some([x, y, z]), _) => name += &format!(" {x}x{y}x{z}"),
            (None, Some(edge)) => name += &format!(" {}R", short(edge)),
            (None, None) => {}
        }
        let _ = write!(name, " {directions}d");
        if let (Some(cone), true) = (self.cone_deg(), self.model.cone != usual.cone) {
            let _ = write!(name, " cone {}", short(cone));
        }
        if direct != usual.direct {
            name += if direct == Direct::Walks { " direct by walks" } else { " direct by rays" };
        }
        if first_hit != usual.first_hit {
            name += if first_hit == FirstHit::Medium { " first hit in the medium" } else { " first hit on fibers" };
        }
        let mut settled = Model { memory_chosen: false, ..self.model };
        settled.settle();
        if memory != settled.memory {
            name += if memory == Memory::None { " without memory" } else { " with memory" };
        }
        if length_over_radius.is_finite() {
            let _ = write!(name, " length {}", short(length_over_radius));
        }
        name
    }
}

/// A number to two decimals, without zeros behind.
pub fn short(number: f64) -> String {
    let text = format!("{number:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Absorption, Source};

    fn scene(name: &str) -> Scene {
        Scene::parse(&Source::find(name).expect("a preset")).expect("it is fine")
    }

    #[test]
    fn every_setting_is_in_the_name_or_the_usual_one() {
        let voile = scene("voile");
        let extent = Extent::of(&voile).expect("it can be laid out");
        let usual = Configuration::of(&voile, &extent);
        assert_eq!(usual.name(), "carried 2R 4096d");
        let names = [
            usual.edged(4.0).name(),
            usual.coned(2.0).name(),
            usual.placed(Placement::AtHit).tracked(Tracking::Tabulated).name(),
            usual.lit(Direct::Walks).directed(64).name(),
            usual.hit_first(FirstHit::Medium).name(),
            usual.remembering(Memory::None).name(),
            Configuration::fibers(&voile, 256).name(),
        ];
        let expected = [
            "carried 4R 4096d",
            "carried 2R 4096d cone 2",
            "tabulated at-hit 2R 4096d",
            "carried 2R 64d direct by walks",
            "carried 2R 4096d first hit in the medium",
            "carried 2R 4096d without memory",
            "fibers 256w",
        ];
        assert_eq!(names, expected);
        let felt = scene("felt");
        let extent = Extent::of(&felt).expect("a sheet has nothing to lay out");
        let sheet = Configuration::of(&felt, &extent);
        assert_eq!(sheet.name(), "at-hit 1024d");
        assert_eq!((sheet.halved(&extent), sheet.coned(5.0)), (None, sheet));
    }

    #[test]
    fn opaque_filaments_beside_others_have_finer_cells() {
        let edge = |scene: &Scene| {
            Extent::of(scene).expect("it can be laid out").usual_edge().expect("yarns have cells").mul_add(10.0, 0.5)
                as u32
        };
        let black = |name: &str| {
            let mut scene = scene(name);
            scene.fibers.iter_mut().for_each(|fiber| fiber.absorption = Absorption::Grey(400.0));
            scene
        };
        assert_eq!(edge(&scene("dimout")), 14);
        // Filaments all black, or such as some light crosses in some colour, and twisted fibers.
        let mut dyed = scene("dimout");
        dyed.fibers.iter_mut().for_each(|fiber| fiber.absorption = Absorption::Rgb([1.0, 2.0, 400.0]));
        let coarser = [black("dimout"), dyed, scene("lining"), black("linen")];
        assert_eq!(coarser.map(|scene| edge(&scene)), [20; 4]);
    }

    #[test]
    fn a_scene_gets_the_cells_of_the_edge() {
        let voile = scene("voile");
        let extent = Extent::of(&voile).expect("it can be laid out");
        let usual = Configuration::of(&voile, &extent);
        let made = usual.apply(&voile, &extent);
        let cells = made.model.cells.expect("a weave has cells");
        let halved = usual.halved(&extent).expect("there is room").cells(&extent).expect("a weave has cells");
        for (fine, coarse) in halved.into_iter().zip(cells) {
            // Twice as many, or one fewer where the last cell was not full.
            assert!(fine == 2 * coarse || fine == 2 * coarse - 1, "{halved:?} of {cells:?}");
        }
        // Numbers of cells in the file stay as they are, and are doubled.
        let mut given = voile.clone();
        given.model.cells = Some([32, 200, 8]);
        let given = Configuration::of(&given, &extent);
        assert_eq!(given.name(), "carried 32x200x8 4096d");
        assert_eq!(given.halved(&extent).and_then(|finer| finer.cells(&extent)), Some([64, 256, 16]));
    }
}
