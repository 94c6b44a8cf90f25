//! A tree of rank 4 over the square of Shirley and Chiu.
//!
//! Coordinates 0 and 1 are the place of −wi on the square, 2 and 3 that of wo. Bit j of a branch's child is the upper half of coordinate j;
//! numbers of a leaf have coordinate 0 running slowest.

use super::material::rad;
use super::xml::{Block, Colours, Head, blocks, direction, document, observed};
use crate::bsdf::{Bsdf, Component};
use crate::export::fit::{Fitted, Loaded, check, fit};
use crate::export::format::{File, Job, Written};
use crate::goniometer::{Basis, DiscBasis};
use crate::scene::Side;
use glam::DVec2;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Most cells along an edge, a power of two.
const MOST: u32 = 32;
/// A node becomes one number where no cell is farther from the mean than this, in standard errors of the table.
const ERRORS: f64 = 0.5;
/// The same for u′ and v′, which have no error of their own.
const CHROMA: f64 = 0.002;
/// u′ and v′ where there is no light: those of the white x = y = ⅓.
const NEUTRAL: [f64; 2] = [4.0 / 19.0, 9.0 / 19.0];

/// Write the file, its scene description, and read it again.
pub fn write(job: &Job) -> Written {
    let (table, colours) = observed(job.table, job.channels);
    let n = edge(&table.goniometer.exit);
    let disc = Basis::Disc(DiscBasis { n });
    let mut data = Vec::new();
    for part in table.tables() {
        let fitted = fit(&table, part, job.incident, &disc, &disc);
        for (wavelength, grid) in grids(&fitted, colours) {
            let node = Node::prune(&grid, n as usize);
            let mut text = String::new();
            node.print(&mut text);
            data.push(Block { wavelength, direction: direction(part.side, part.component), data: text + "\n" });
        }
    }
    let head = Head { name: job.title, thickness: job.thickness, openness: job.openness() };
    let structure = "<IncidentDataStructure>TensorTree4</IncidentDataStructure>\n";
    let text = document(&head, structure, "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>\n", &data);
    let checked = check(&table, job.incident, &Trees::read(&text, colours));
    let name = format!("{}_tensor-tree.xml", job.stem);
    let scene = rad(&format!("{}_tree", job.stem), &name, job.title, false);
    Written {
        checks: vec![(name.clone(), checked)],
        files: vec![
            File { name, bytes: text.into_bytes() },
            File { name: format!("{}_tensor-tree.rad", job.stem), bytes: scene.into_bytes() },
        ],
    }
}

/// Cells along an edge: the least power of two that is not coarser than the table, within what a text file bears.
fn edge(exit: &Basis) -> u32 {
    match exit {
        Basis::Disc(disc) => disc.n.next_power_of_two().min(MOST),
        Basis::Rings(rings) => ((rings.cells() as f64).sqrt() as u32).next_power_of_two().clamp(8, MOST),
    }
}

/// What the format leaves out of a table.
pub fn notes(table: &Bsdf, incident: &Basis) -> Vec<String> {
    let n = edge(&table.goniometer.exit);
    let mut notes = Vec::new();
    let disc = Basis::Disc(DiscBasis { n });
    let inside = |basis: &Basis| disc.inside(basis).is_some();
    if !inside(incident) || !inside(&table.goniometer.exit) {
        notes
            .push(format!("cells are joined and cut to {n} × {n}; a disc basis whose N is a power of two avoids that"));
    }
    if table.goniometer.sides.iter().any(|side| table.direct(*side).iter().any(|share| share.value > 0.0)) {
        notes.push(
            "there is no place for light that touches no fiber, and it is left out: lay an opening beside it, or take klems".into(),
        );
    }
    notes
}

/// Values and how far each may be moved, by coordinates 0 to 3, coordinate 0 running slowest.
struct Grid {
    f: Vec<f64>,
    room: Vec<f64>,
}

/// The quantities of the file from f by channel.
fn grids(fitted: &[Fitted], colours: Colours) -> Vec<(&'static str, Grid)> {
    let cells = fitted[0].f.len();
    let n2 = (cells as f64).sqrt().round() as usize;
    let n = (n2 as f64).sqrt().round() as usize;
    // From row·n + column of both cells to column, row of −wi and column, row of wo.
    let order = |i: usize| {
        let [x, y, column, row] = [i / (n * n2), i / n2 % n, i / n % n, i % n];
        ((n - 1 - y) * n + (n - 1 - x)) * n2 + row * n + column
    };
    let grid = |value: &dyn Fn(usize) -> [f64; 2]| {
        let (f, room) = (0..cells).map(|i| value(order(i))).map(|[f, room]| (f, room)).unzip();
        Grid { f, room }
    };
    let luminance = &fitted[if colours == Colours::Grey { 0 } else { 1 }];
    let mut grids = vec![("Visible", grid(&|cell| [luminance.f[cell], ERRORS * luminance.stderr[cell]]))];
    if colours == Colours::Xyz {
        let chroma = |k: usize, cell: usize| {
            let [x, y, z] = [0, 1, 2].map(|channel| fitted[channel].f[cell]);
            let sum = x + 15.0 * y + 3.0 * z;
            if sum > 0.0 { [4.0 * x, 9.0 * y][k] / sum } else { NEUTRAL[k] }
        };
        grids.push(("CIE-u", grid(&|cell| [chroma(0, cell), CHROMA])));
        grids.push(("CIE-v", grid(&|cell| [chroma(1, cell), CHROMA])));
    }
    grids
}

/// A part of the tree.
enum Node {
    /// One number for all.
    Flat(f64),
    /// The numbers of a grid of 2⁴.
    Grid(Vec<f64>),
    /// 16 parts, bit j for the upper half of coordinate j.
    Branch(Vec<Node>),
}

impl Node {
    /// The tree of a grid of n⁴, cells that are near to their mean joined.
    fn prune(grid: &Grid, n: usize) -> Node {
        Node::part(grid, n, [0; 4], n).0
    }

    /// The tree of a cube of the grid, its mean, and the range of means that every cell in it allows.
    fn part(grid: &Grid, n: usize, corner: [usize; 4], size: usize) -> (Node, f64, [f64; 2]) {
        if size == 1 {
            let index = corner.iter().fold(0, |index, place| index * n + place);
            let (f, room) = (grid.f[index], grid.room[index]);
            return (Node::Flat(f), f, [f - room, f + room]);
        }
        let half = size / 2;
        let child = |bits: usize| {
            let corner = std::array::from_fn(|j| corner[j] + half * (bits >> j & 1));
            Node::part(grid, n, corner, half)
        };
        let children: Vec<(Node, f64, [f64; 2])> = (0..16).map(child).collect();
        let mean = children.iter().map(|(_, mean, _)| mean).sum::<f64>() / 16.0;
        let allowed = children.iter().fold([f64::NEG_INFINITY, f64::INFINITY], |[low, high], (_, _, range)| {
            [low.max(range[0]), high.min(range[1])]
        });
        if (allowed[0]..=allowed[1]).contains(&mean) {
            return (Node::Flat(mean), mean, allowed);
        }
        let node = if size == 2 {
            // Coordinate 0 is the high bit inside a grid, and the low one among children.
            let flat = |place: usize| match children[(place as u8).reverse_bits() as usize >> 4].0 {
                Node::Flat(f) => f,
                _ => mean,
            };
            Node::Grid((0..16).map(flat).collect())
        } else {
            Node::Branch(children.into_iter().map(|(node, ..)| node).collect())
        };
        (node, mean, allowed)
    }

    fn print(&self, text: &mut String) {
        match self {
            Node::Flat(f) => {
                let _ = write!(text, "{{{f:.6e}}}");
            }
            Node::Grid(numbers) => {
                text.push('{');
                for f in numbers {
                    let _ = write!(text, " {f:.6e}");
                }
                text.push('}');
            }
            Node::Branch(children) => {
                text.push_str("{\n");
                children.iter().for_each(|child| child.print(text));
                text.push_str("}\n");
            }
        }
    }

    /// Read a node; none when the text is no tree.
    fn read(words: &mut std::iter::Peekable<std::str::Chars>) -> Option<Node> {
        let skip = |words: &mut std::iter::Peekable<std::str::Chars>| {
            while words.next_if(|c| c.is_whitespace() || *c == ',').is_some() {}
        };
        skip(words);
        words.next_if_eq(&'{')?;
        let (mut children, mut numbers) = (Vec::new(), Vec::new());
        loop {
            skip(words);
            match words.peek()? {
                '}' => break,
                '{' => children.push(Node::read(words)?),
                _ => {
                    let mut word = String::new();
                    while let Some(c) = words.next_if(|c| !c.is_whitespace() && !"{},".contains(*c)) {
                        word.push(c);
                    }
                    numbers.push(word.parse().ok()?);
                }
            }
        }
        words.next();
        match (children.len(), numbers.len()) {
            (16, 0) => Some(Node::Branch(children)),
            (0, 1) => Some(Node::Flat(numbers[0])),
            (0, 16) => Some(Node::Grid(numbers)),
            _ => None,
        }
    }

    /// The number at a place of [0, 1)⁴.
    fn at(&self, mut place: [f64; 4]) -> f64 {
        match self {
            Node::Flat(f) => *f,
            Node::Grid(numbers) => numbers[place.iter().fold(0, |index, t| index * 2 + usize::from(*t >= 0.5))],
            Node::Branch(children) => {
                let child = (0..4).map(|j| usize::from(place[j] >= 0.5) << j).sum::<usize>();
                place.iter_mut().for_each(|t| *t = (2.0 * *t).fract());
                children[child].at(place)
            }
        }
    }
}

/// The file as Radiance evaluates it.
struct Trees {
    trees: BTreeMap<(&'static str, &'static str), Node>,
    colours: Colours,
}

impl Trees {
    fn read(text: &str, colours: Colours) -> Trees {
        let mut trees = BTreeMap::new();
        for side in [Side::Front, Side::Back] {
            for name in [Component::Reflection, Component::Transmission].map(|component| direction(side, component)) {
                for wanted in ["Visible", "CIE-u", "CIE-v"] {
                    let found =
                        blocks(text).find(|(wavelength, direction, _)| (*wavelength, *direction) == (wanted, name));
                    if let Some(node) = found.and_then(|(_, _, data)| Node::read(&mut data.chars().peekable())) {
                        trees.insert((name, wanted), node);
                    }
                }
            }
        }
        Trees { trees, colours }
    }
}

impl Loaded for Trees {
    fn has(&self, side: Side, component: Component) -> bool {
        self.trees.contains_key(&(direction(side, component), "Visible"))
    }

    fn f(&self, side: Side, component: Component, wi: DVec2, wo: DVec2) -> Vec<f64> {
        let square = |projection: DVec2| (crate::concentric::disc_to_square(projection) + 1.0) / 2.0;
        let (travels, leaves) = (square(-wi), square(wo));
        let place = [travels.x, travels.y, leaves.x, leaves.y].map(|t| t.clamp(0.0, 1.0 - 1e-12));
        let name = direction(side, component);
        let at = |wavelength| self.trees.get(&(name, wavelength)).map_or(0.0, |tree| tree.at(place));
        let y = at("Visible");
        match self.colours {
            Colours::Grey => vec![y],
            Colours::Xyz => {
                let (u, v) = (at("CIE-u"), at("CIE-v"));
                vec![y * 9.0 * u / (4.0 * v), y, y * (12.0 - 3.0 * u - 20.0 * v) / (4.0 * v)]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tree_that_is_printed_and_read_has_every_number_in_its_place() {
        let n = 4;
        let f: Vec<f64> = (0..256).map(f64::from).collect();
        let tree = |room: f64| {
            let mut text = String::new();
            Node::prune(&Grid { f: f.clone(), room: vec![room; 256] }, n).print(&mut text);
            (Node::read(&mut text.chars().peekable()).expect("it is a tree"), text)
        };
        let (whole, text) = tree(0.0);
        for (i, f) in f.iter().enumerate() {
            let place = [i / 64, i / 16 % 4, i / 4 % 4, i % 4].map(|k| (k as f64 + 0.5) / 4.0);
            assert_eq!(whole.at(place), *f, "cell {i}");
        }
        // Within half of 85 + 21 … every half cube may be one number, and all of it with more.
        let (joined, shorter) = tree(45.0);
        assert!(shorter.len() < text.len() / 4 && (joined.at([0.1; 4]) - 42.5).abs() < 1e-9, "{shorter}");
        assert!(matches!(tree(130.0).0, Node::Flat(f) if (f - 127.5).abs() < 1e-6));
        assert!(Node::read(&mut "{1 2 3}".chars().peekable()).is_none());
    }
}
