//! How points look: shapes by placement, colours by the size of cells, areas by memory.

use crate::plan::chart::{Chart, Class, Point};
use crate::plan::short;
use crate::scene::{Placement, Tracking};
use std::fmt::Write;

/// Colours that people with any colour vision tell apart (Okabe and Ito 2008), coarse to fine.
const COLOURS: [&str; 6] = ["#e69f00", "#56b4e9", "#009e73", "#cc79a7", "#0072b2", "#d55e00"];

/// Which of them the scene's own model has.
const OWN: usize = 2;

/// Styles of the picture; light, and dark where the reader's system is.
pub const STYLE: &str = "\
text{font-family:system-ui,sans-serif;fill:#222;font-size:12px}.small{font-size:11px}.title{font-size:14px;font-weight:600}\
.paper{fill:#fff}.frame{fill:none;stroke:#999}.line{stroke:#ececec}.strong{stroke:#d4d4d4}.curve{fill:none;stroke-opacity:.3}\
.bar{stroke:#888;stroke-width:1;stroke-opacity:.25}.on .bar{stroke:#444;stroke-opacity:1}.m{fill-opacity:.3;stroke-opacity:.45}\
.m.on{fill-opacity:1;stroke-opacity:1}.m.gpu{fill-opacity:0}.fibers{fill:#222;stroke:#222}\
.front{fill:none;stroke:#222;stroke-width:1.6}.front.gpu{stroke-dasharray:5 4}.lead{stroke:#888;stroke-width:.8}\
.name{paint-order:stroke;stroke:#fff;stroke-width:3px;stroke-linejoin:round}.m:focus{outline:2px solid #0072b2}\
@media(prefers-color-scheme:dark){text{fill:#e8e8e8}.paper{fill:#16181b}.frame{stroke:#777}.line{stroke:#26292d}\
.strong{stroke:#3a3e44}.on .bar{stroke:#ccc}.fibers{fill:#f4f4f4;stroke:#f4f4f4}.front{stroke:#f4f4f4}\
.name{stroke:#16181b}}";

/// Which colour stands for what.
pub struct Looks {
    /// What is told by colour, coarse to fine, in words.
    groups: Vec<String>,
    own: Option<String>,
}

impl Looks {
    /// Of all points of a chart.
    pub fn of(chart: &Chart) -> Looks {
        let mut seen: Vec<(f64, String)> = Vec::new();
        for point in chart.points.iter().filter(|point| !point.explicit) {
            let (order, words) = group(point);
            if !seen.iter().any(|(_, known)| *known == words) {
                seen.push((order, words));
            }
        }
        seen.sort_by(|a, b| a.0.total_cmp(&b.0));
        let own = chart.points.iter().find(|point| point.name == chart.own).map(|point| group(point).1);
        Looks { groups: seen.into_iter().map(|(_, words)| words).collect(), own }
    }

    /// The colour of a group: the scene's own has the third, coarser ones those before, finer ones those behind.
    fn colour_of(&self, words: &str) -> &'static str {
        let place = |words: &str| self.groups.iter().position(|known| known == words);
        let own = self.own.as_deref().and_then(place).unwrap_or(OWN);
        let index = place(words).unwrap_or_default();
        let index = if index < own { index.min(OWN - 1) } else { index - own + OWN };
        COLOURS[index % COLOURS.len()]
    }

    /// Attributes of the colour of a point.
    pub fn colour(&self, point: &Point) -> String {
        if point.explicit {
            return r#"class="fibers""#.into();
        }
        format!(r#"fill="{0}" stroke="{0}""#, self.colour_of(&group(point).1))
    }

    /// What colours stand for: a patch and words.
    pub fn colours(&self) -> Vec<(String, String)> {
        let patch = |words: &String| {
            let colour = self.colour_of(words);
            let own = if self.own.as_ref() == Some(words) { " (the scene's)" } else { "" };
            (format!(r#"<rect x="-6" y="-6" width="12" height="12" fill="{colour}"/>"#), format!("{words}{own}"))
        };
        self.groups.iter().map(patch).collect()
    }
}

/// What the colour of a point tells, in an order from coarse to fine.
fn group(point: &Point) -> (f64, String) {
    match (point.edge_r, point.cells, point.directions) {
        (Some(edge), ..) => (-edge, format!("cells of {} R", short(edge))),
        (None, Some([x, y, z]), _) => (f64::from(x * y * z), format!("{x} × {y} × {z} cells")),
        (.., directions) => (f64::from(directions.unwrap_or(0)), format!("{} directions", directions.unwrap_or(0))),
    }
}

/// The shape of a point around a place, as a path.
pub fn shape(point: &Point, x: f64, y: f64) -> String {
    let size = size(point.bytes);
    match (point.placement, point.tracking) {
        (None, _) => polygon(x, y, 1.35 * size, 10, 0.45, 0.0),
        (Some(Placement::AtHit), Some(Tracking::Tabulated)) => polygon(x, y, 1.25 * size, 3, 1.0, 0.5),
        (Some(Placement::AtHit), _) => {
            format!(
                "M{:.1} {y:.1}a{size:.1} {size:.1} 0 1 0 {:.1} 0a{size:.1} {size:.1} 0 1 0 {:.1} 0Z",
                x - size,
                2.0 * size,
                -2.0 * size
            )
        }
        (Some(Placement::Carried), _) => polygon(x, y, 1.25 * size, 3, 1.0, 0.0),
        (Some(Placement::CarriedDense), _) => polygon(x, y, 1.25 * size, 4, 1.0, 0.125),
        (Some(Placement::CarriedVoid), _) => polygon(x, y, 1.25 * size, 4, 1.0, 0.0),
    }
}

/// Half the size of a mark: it grows with the logarithm of the memory, from 10 KiB on.
pub fn size(bytes: usize) -> f64 {
    (2.8 + 0.9 * (bytes as f64 / 10_240.0).max(1.0).log10()).min(7.0)
}

/// A regular polygon; of a star, every other corner lies at a share of the radius. It is turned by a share of a full turn.
fn polygon(x: f64, y: f64, radius: f64, corners: u32, inner: f64, turn: f64) -> String {
    let mut path = String::new();
    for corner in 0..corners {
        let angle = std::f64::consts::TAU * (f64::from(corner) / f64::from(corners) + turn);
        let radius = if corner % 2 == 1 { inner * radius } else { radius };
        let (sign, px, py) = (if corner == 0 { 'M' } else { 'L' }, x + radius * angle.sin(), y - radius * angle.cos());
        let _ = write!(path, "{sign}{px:.1} {py:.1}");
    }
    path + "Z"
}

/// What shapes stand for: a mark and words, those that the chart has.
pub fn shapes(chart: &Chart) -> Vec<(String, String)> {
    let mut seen: Vec<(String, String)> = Vec::new();
    for point in &chart.points {
        let words = match (point.placement, point.tracking) {
            (None, _) => "the fibers themselves".to_owned(),
            (Some(placement), Some(Tracking::Tabulated)) => format!("{}, tabulated", placement.name()),
            (Some(placement), _) => placement.name().to_owned(),
        };
        if !seen.iter().any(|(_, known)| *known == words) {
            let alike = Point { bytes: 1 << 20, ..point.clone() };
            let class = if point.explicit { r#"class="fibers""# } else { r##"fill="#8a8a8a""## };
            seen.push((format!(r#"<path {class} d="{}"/>"#, shape(&alike, 0.0, 0.0)), words));
        }
    }
    seen
}

/// What sizes, fillings and lines stand for.
pub fn others(chart: &Chart) -> Vec<(String, String)> {
    let of = |class| chart.points.iter().any(|point| point.class == class);
    let circle = |bytes: usize, fill: &str| format!(r##"<circle r="{:.1}" {fill} stroke="#8a8a8a"/>"##, size(bytes));
    let mut list = vec![
        (circle(100 << 10, r##"fill="#8a8a8a""##), "100 KiB".to_owned()),
        (circle(10 << 20, r##"fill="#8a8a8a""##), "10 MiB".to_owned()),
    ];
    if of(Class::Gpu) {
        list.push((circle(1 << 20, r##"fill="#8a8a8a""##), "cpu".to_owned()));
        list.push((circle(1 << 20, r#"fill="none""#), "gpu".to_owned()));
    }
    for class in [Class::Cpu, Class::Gpu].into_iter().filter(|class| of(*class)) {
        let word = class.name();
        list.push((
            format!(r#"<path class="front {word}" d="M-12 0H12"/>"#),
            format!("nothing on {word} is both faster and better"),
        ));
    }
    list
}
