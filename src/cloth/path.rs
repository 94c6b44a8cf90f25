//! The axis of a thread: arcs on the yarns that it crosses, and the tangents between them.

use super::steps::Curve;
use glam::DVec2;

/// No axis climbs more steeply than this: yarns that leave each other no room at all.
const MAX_SLOPE: f64 = 1e6;
/// Parts of an arc or a line that have one step length.
const PARTS: usize = 24;
/// Nodes and weights of the Gauss–Legendre rule of four points on [−1, 1].
const GAUSS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

/// Where a thread crosses another; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Distance along the thread's direction.
    pub at: f64,
    /// Height of the axis.
    pub height: f64,
    /// Semi-axes of the section of the yarn that is crossed: half its width, half its height.
    pub section: DVec2,
}

/// A stretch of an axis in its vertical plane: (distance along the thread, height), in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Element {
    /// A straight line.
    Line {
        /// Its start.
        from: DVec2,
        /// Its end.
        to: DVec2,
    },
    /// An arc of an ellipse on both sides of its apex, where it is level.
    Arc {
        /// The apex.
        apex: DVec2,
        /// Semi-axes.
        section: DVec2,
        /// 1 when the axis lies on top of the ellipse, −1 when it lies under it.
        side: f64,
        /// Eccentric angle from the apex at the start, in radians.
        from: f64,
        /// The same at the end.
        to: f64,
    },
}

impl Element {
    /// The point at a fraction of the way: of the length of a line, of the eccentric angle of an arc.
    pub fn point(&self, fraction: f64) -> DVec2 {
        match *self {
            Element::Line { from, to } => from.lerp(to, fraction),
            Element::Arc { apex, section, side, from, to } => {
                let (sin, cos) = (from + fraction * (to - from)).sin_cos();
                apex + DVec2::new(section.x * sin, -side * section.y * (1.0 - cos))
            }
        }
    }

    /// Length between two fractions.
    pub fn length(&self, start: f64, end: f64) -> f64 {
        match *self {
            Element::Line { from, to } => from.distance(to) * (end - start),
            Element::Arc { section, from, to, .. } => {
                let half = (end - start) / 2.0;
                let speed = |(node, weight): (f64, f64)| {
                    let (sin, cos) = (from + (start + half * (1.0 + node)) * (to - from)).sin_cos();
                    weight * (section.x * cos).hypot(section.y * sin)
                };
                GAUSS.into_iter().map(speed).sum::<f64>() * half * (to - from)
            }
        }
    }

    /// Largest curvature between two fractions in 1/mm: from the apex on it only rises or only falls.
    pub fn curvature(&self, start: f64, end: f64) -> f64 {
        match *self {
            Element::Line { .. } => 0.0,
            Element::Arc { section, from, to, .. } => {
                let at = |fraction: f64| {
                    let (sin, cos) = (from + fraction * (to - from)).sin_cos();
                    section.x * section.y / (section.x * cos).hypot(section.y * sin).powi(3)
                };
                at(start).max(at(end))
            }
        }
    }
}

/// The axis of a thread over one period.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Length of the period along the thread's direction in mm.
    pub period: f64,
    /// Stretches in their order, from the first crossing to its next image.
    pub elements: Vec<Element>,
    /// Where the first stretch starts.
    first: f64,
    /// Where each stretch ends.
    ends: Vec<f64>,
    /// Steepest slope, rise over run.
    pub steepest: f64,
}

impl Path {
    /// The axis through crossings in ascending order, at least one, within a period.
    pub fn new(crossings: &[Crossing], period: f64) -> Path {
        let mut path = Path { period, elements: Vec::new(), first: crossings[0].at, ends: Vec::new(), steepest: 0.0 };
        let next = crossings.iter().skip(1).copied();
        let last = Crossing { at: crossings[0].at + period, ..crossings[0] };
        for (from, to) in crossings.iter().zip(next.chain([last])) {
            path.climb(from, &to);
        }
        path.ends = path.elements.iter().map(|element| element.point(1.0).x).collect();
        path
    }

    /// Go from one crossing to the next: an arc on the first section, the common tangent, an arc on the second.
    fn climb(&mut self, from: &Crossing, to: &Crossing) {
        let start = DVec2::new(from.at, from.height);
        let end = DVec2::new(to.at, to.height);
        let drop = from.height - to.height;
        if drop == 0.0 {
            self.elements.push(Element::Line { from: start, to: end });
            return;
        }
        let side = drop.signum();
        let slope = tangent_slope(to.at - from.at, drop.abs(), from.section, to.section);
        // The eccentric angle at which an ellipse has this slope.
        let angle = |section: DVec2| (slope * section.x).atan2(section.y);
        let leave = Element::Arc { apex: start, section: from.section, side, from: 0.0, to: angle(from.section) };
        let arrive = Element::Arc { apex: end, section: to.section, side: -side, from: -angle(to.section), to: 0.0 };
        let between = Element::Line { from: leave.point(1.0), to: arrive.point(0.0) };
        self.elements.extend([leave, between, arrive]);
        self.steepest = self.steepest.max(slope);
    }

    /// Height of the axis at a distance along the thread's direction.
    pub fn height(&self, along: f64) -> f64 {
        let along = self.first + (along - self.first).rem_euclid(self.period);
        let place = self.ends.partition_point(|end| *end < along).min(self.elements.len() - 1);
        match self.elements[place] {
            Element::Line { from, to } if to.x > from.x => {
                from.y + (to.y - from.y) * ((along - from.x) / (to.x - from.x)).clamp(0.0, 1.0)
            }
            Element::Line { from, .. } => from.y,
            Element::Arc { apex, section, side, .. } => {
                let across = ((along - apex.x) / section.x).clamp(-1.0, 1.0);
                apex.y - side * section.y * (1.0 - (1.0 - across * across).sqrt())
            }
        }
    }

    /// A part of an element: from one fraction of it to another.
    fn part(&self, part: usize) -> (&Element, f64, f64) {
        let cut = |place: usize| place as f64 / PARTS as f64;
        (&self.elements[part / PARTS], cut(part % PARTS), cut(part % PARTS + 1))
    }

    /// Length of the axis over one period in mm.
    pub fn length(&self) -> f64 {
        let parts = |element: &Element| {
            (0..16).map(|part| element.length(f64::from(part) / 16.0, f64::from(part + 1) / 16.0)).sum::<f64>()
        };
        self.elements.iter().map(parts).sum()
    }
}

impl Curve for Path {
    fn parts(&self) -> usize {
        PARTS * self.elements.len()
    }

    fn part_length(&self, part: usize) -> f64 {
        let (element, start, end) = self.part(part);
        element.length(start, end)
    }

    fn part_curvature(&self, part: usize) -> f64 {
        let (element, start, end) = self.part(part);
        element.curvature(start, end)
    }

    fn part_point(&self, part: usize, fraction: f64) -> DVec2 {
        let (element, start, end) = self.part(part);
        element.point(start + fraction * (end - start))
    }

    fn advance(&self) -> f64 {
        self.period
    }
}

/// Slope of the common tangent that passes from the top of one ellipse to the bottom of the next, whose apexes are `run`
/// apart and `drop` in height: the root of m·run − Σ(√(b² + a²m²) − b) = drop, of which the left side only rises with m
/// where the ellipses lie side by side.
fn tangent_slope(run: f64, drop: f64, first: DVec2, second: DVec2) -> f64 {
    let gained = |m: f64| {
        let spent = |section: DVec2| section.y.hypot(section.x * m) - section.y;
        m * run - spent(first) - spent(second)
    };
    let (mut low, mut high) = (0.0, 1.0);
    while gained(high) < drop && high < MAX_SLOPE {
        (low, high) = (high, 2.0 * high);
    }
    for _ in 0..64 {
        let middle = 0.5 * (low + high);
        if gained(middle) < drop {
            low = middle;
        } else {
            high = middle;
        }
    }
    high.min(MAX_SLOPE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn crossing(at: f64, height: f64) -> Crossing {
        Crossing { at, height, section: DVec2::new(0.3, 0.2) }
    }

    #[test]
    fn the_elements_join_and_are_smooth() {
        let path = Path::new(&[crossing(0.5, 0.2), crossing(1.5, 0.2), crossing(2.5, -0.2)], 3.0);
        let slope = |element: &Element, at: f64| {
            let (a, b) = (element.point((at - 1e-6).max(0.0)), element.point((at + 1e-6).min(1.0)));
            (b.y - a.y) / (b.x - a.x)
        };
        for pair in path.elements.windows(2) {
            assert!(pair[0].point(1.0).distance(pair[1].point(0.0)) < 1e-12, "{pair:?}");
            assert!((slope(&pair[0], 1.0) - slope(&pair[1], 0.0)).abs() < 1e-5, "{pair:?}");
        }
        assert_eq!(path.elements.len(), 7, "a float and two climbs");
        assert!((path.elements[6].point(1.0) - DVec2::new(3.5, 0.2)).length() < 1e-12);
    }

    #[test]
    fn circular_sections_give_the_arcs_of_peirce() {
        // Peirce 1937: p = (l − Dθ) cos θ + D sin θ and h = (l − Dθ) sin θ + D (1 − cos θ), D the sum of two diameters; an
        // axis at distance D/2 from the centre of a section bends on a circle of radius D/2.
        let (diameter, theta, length): (f64, f64, f64) = (0.4, 0.6, 0.9);
        let straight = length - diameter * theta;
        let run = straight * theta.cos() + diameter * theta.sin();
        let drop = straight * theta.sin() + diameter * (1.0 - theta.cos());
        let circle = DVec2::splat(diameter / 2.0);
        let at = |at: f64, height: f64| Crossing { at, height, section: circle };
        let path = Path::new(&[at(0.0, drop), at(run, 0.0)], 2.0 * run);
        assert!((path.steepest - theta.tan()).abs() < 1e-9, "{}", path.steepest);
        assert!((path.length() - 2.0 * length).abs() < 1e-9, "{}", path.length());
    }

    #[test]
    fn lengths_and_curvatures_of_arcs_have_their_closed_forms() {
        let arc = |section, from, to| Element::Arc { apex: DVec2::ZERO, section, side: 1.0, from, to };
        let quarter = arc(DVec2::splat(2.0), 0.0, PI / 2.0);
        assert!((quarter.length(0.0, 1.0) - PI).abs() < 1e-12);
        // The perimeter of the ellipse with semi-axes 2 and 1.
        let quarter = arc(DVec2::new(2.0, 1.0), 0.0, PI / 2.0);
        let length: f64 = (0..8).map(|part| quarter.length(f64::from(part) / 8.0, f64::from(part + 1) / 8.0)).sum();
        assert!((4.0 * length - 9.688_448_220_547_676).abs() < 1e-9, "{}", 4.0 * length);
        assert!(
            (quarter.curvature(0.0, 0.0) - 0.25).abs() < 1e-12 && (quarter.curvature(0.5, 1.0) - 2.0).abs() < 1e-12
        );
    }

    #[test]
    fn heights_agree_with_the_points_and_repeat() {
        let path = Path::new(&[crossing(0.5, 0.3), crossing(1.2, -0.1)], 1.5);
        for element in &path.elements {
            for part in 0..=10 {
                let point = element.point(f64::from(part) / 10.0);
                for turn in [-1.5, 0.0, 3.0] {
                    assert!((path.height(point.x + turn) - point.y).abs() < 1e-9, "{point}");
                }
            }
        }
    }

    #[test]
    fn sections_that_touch_make_an_upright_axis() {
        let touching = DVec2::new(0.5, 0.2);
        let at = |at: f64, height: f64| Crossing { at, height, section: touching };
        let path = Path::new(&[at(0.5, 0.2), at(1.5, -0.2)], 2.0);
        assert!(path.steepest > 1e3 && path.length().is_finite());
    }
}
