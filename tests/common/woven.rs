//! Woven cloths, written as a user would.

use fiberwalk::cloth::{Cloth, Primitive, System, Thread};
use fiberwalk::scene::{Scene, Source};
use glam::DVec3;

/// A yarn of one kind of fiber, or of a blend.
#[derive(Clone, Debug)]
pub struct Yarn {
    pub fiber: &'static str,
    pub plies: u32,
    pub fibers_per_ply: u32,
    pub width_um: f64,
    pub height_um: f64,
    /// Further lines of the yarn's table.
    pub lines: &'static str,
}

impl Yarn {
    /// One ply of fibers of 10 µm.
    pub fn new(fibers_per_ply: u32, width_um: f64, height_um: f64, lines: &'static str) -> Yarn {
        Yarn { fiber: "\"thin\"", plies: 1, fibers_per_ply, width_um, height_um, lines }
    }
}

/// A weave; spacings are numbers per cm.
#[derive(Clone, Debug)]
pub struct Woven {
    pub draft: Vec<String>,
    pub yarns: Vec<Yarn>,
    /// Indices of yarns.
    pub warp: Vec<usize>,
    pub weft: Vec<usize>,
    pub ends_per_cm: f64,
    pub picks_per_cm: f64,
    pub warp_crimp_share: f64,
}

impl Woven {
    /// A weave of one yarn.
    pub fn of(draft: &[&str], yarn: Yarn, threads_per_cm: f64) -> Woven {
        Woven {
            draft: draft.iter().map(|row| (*row).to_owned()).collect(),
            yarns: vec![yarn],
            warp: vec![0],
            weft: vec![0],
            ends_per_cm: threads_per_cm,
            picks_per_cm: threads_per_cm,
            warp_crimp_share: 0.5,
        }
    }

    /// The cloth file.
    pub fn text(&self) -> String {
        let mut text = String::from(
            "[fiber.thin]\nradius_um = 5\nior = 1.5\ndensity_g_per_cm3 = 1.5\n\
             [fiber.thick]\nradius_um = 8\nior = 1.5\ndensity_g_per_cm3 = 1.2\n",
        );
        for (index, yarn) in self.yarns.iter().enumerate() {
            let Yarn { fiber, plies, fibers_per_ply, width_um, height_um, lines } = yarn;
            text += &format!(
                "[yarn.y{index}]\nfiber = {fiber}\nplies = {plies}\nfibers_per_ply = {fibers_per_ply}\n\
                 width_um = {width_um}\nheight_um = {height_um}\n{lines}\n"
            );
        }
        let names = |threads: &[usize]| threads.iter().map(|yarn| format!("y{yarn}")).collect::<Vec<_>>();
        text += &format!(
            "[weave]\ndraft = {:?}\nwarp = {:?}\nweft = {:?}\nends_per_cm = {}\npicks_per_cm = {}\nwarp_crimp_share = {}\n",
            self.draft,
            names(&self.warp),
            names(&self.weft),
            self.ends_per_cm,
            self.picks_per_cm,
            self.warp_crimp_share
        );
        text
    }

    /// The cloth, unless a thread of the draft never interlaces.
    pub fn interlaced(&self) -> Option<Cloth> {
        let varies = |marks: Vec<u8>| marks.iter().any(|mark| *mark != marks[0]);
        let column = |end: usize| self.draft.iter().map(|row| row.as_bytes()[end]).collect();
        let rows = self.draft.iter().all(|row| varies(row.bytes().collect()));
        let columns = (0..self.draft[0].len()).all(|end| varies(column(end)));
        (rows && columns).then(|| self.cloth())
    }

    /// The cloth, through the reader.
    pub fn cloth(&self) -> Cloth {
        let source = Source { file: "cloth.toml".into(), stem: "cloth".into(), text: self.text(), folder: None };
        let scene = Scene::parse(&source).unwrap_or_else(|error| panic!("{error}\n{}", source.text));
        Cloth::new(&scene).unwrap_or_else(|error| panic!("{error}"))
    }
}

/// A preset's cloth.
pub fn preset(name: &str) -> Cloth {
    let source = Source::find(name).expect("it is a preset");
    Cloth::new(&Scene::parse(&source).expect("it is right")).expect("it can be laid out")
}

/// The pieces of each fiber of a thread, in their order: a fiber goes on as long as the pieces join, round the period.
pub fn fibers(cloth: &Cloth, seed: u64, number: u64, thread: usize) -> Vec<Vec<Primitive>> {
    let mut fibers: Vec<Vec<Primitive>> = Vec::new();
    let apart = |x: f64, period: f64| (x + period / 2.0).rem_euclid(period) - period / 2.0;
    let mut end: Option<DVec3> = None;
    cloth.realize_thread(seed, number, thread, &mut |piece| {
        let half = piece.direction * piece.length / 2.0;
        let joins = end.is_some_and(|end| {
            let gap = piece.centre - half - end;
            DVec3::new(apart(gap.x, cloth.period().x), apart(gap.y, cloth.period().y), gap.z).length() < 1e-9
        });
        if !joins {
            fibers.push(Vec::new());
        }
        end = Some(piece.centre + half);
        fibers.last_mut().expect("there is one").push(piece);
    });
    fibers
}

/// Where a fiber passes a plane across its thread: (to the left, up) seen along the thread, off the thread's axis.
pub fn crossing(cloth: &Cloth, thread: &Thread, fiber: &[Primitive], plane: f64) -> [f64; 2] {
    let warp = thread.system == System::Warp;
    let period = if warp { cloth.period().y } else { cloth.period().x };
    for piece in fiber {
        let (centre, direction) = (piece.centre, piece.direction);
        let (along, step) = if warp { (centre.y, direction.y) } else { (centre.x, direction.x) };
        // The nearest image of the plane.
        let ahead = (plane - along + period / 2.0).rem_euclid(period) - period / 2.0;
        if (ahead / step).abs() <= piece.length / 2.0 {
            let point = centre + direction * (ahead / step);
            let size = if warp { cloth.period().x } else { cloth.period().y };
            let across = if warp { thread.at - point.x } else { point.y - thread.at };
            let across = (across + size / 2.0).rem_euclid(size) - size / 2.0;
            return [across, point.z - cloth.axis_height(thread, plane)];
        }
    }
    panic!("the fiber does not pass y or x = {plane}");
}
