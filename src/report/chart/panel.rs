//! One frame of the picture: error against a cost.

use super::labels::{Placer, Spot};
use super::looks::{Looks, shape, size};
use super::scale::{Scale, label};
use super::words::{of_point, text};
use crate::plan::chart::{Chart, Class, Cost, Point};
use std::fmt::Write;

/// Size of a frame with its axes and its title, and of one for narrow screens.
pub const WIDE: [f64; 2] = [520.0, 430.0];
pub const NARROW: [f64; 2] = [370.0, 430.0];
/// Room on the left, above, on the right and below.
const MARGIN: [f64; 4] = [50.0, 34.0, 16.0, 44.0];
/// Height of the letters of names.
const LETTERS: f64 = 11.0;

/// The frame, as the content of an SVG of this size.
pub fn panel(chart: &Chart, looks: &Looks, cost: Cost, [width, height]: [f64; 2]) -> String {
    let [left, top, right, bottom] = MARGIN;
    let frame = [left, top, width - left - right, height - top - bottom];
    let costs = chart.points.iter().flat_map(|point| bars(point, cost)[0]);
    let errors =
        chart.points.iter().flat_map(|point| [100.0 * point.total_error.value, 100.0 * point.total_error.bounds[1]]);
    let x = Scale::of(costs, [left, width - right]);
    let y = Scale::of(errors, [height - bottom, top]);
    let place = |point: &Point| (x.place(cost.of(point)), y.place(100.0 * point.total_error.value));
    let (title, below) = match cost {
        Cost::All => ("All the time: preparation and walks", "seconds in all"),
        Cost::Walks => ("The walks alone, at an even speed", "seconds of the walks, events × time of an event"),
    };
    let mut svg = format!(r#"<text class="title" x="{left}" y="18">{title}</text>"#);
    svg += &axes(&x, &y, below, frame);
    let marked = |point: &&Point| on_front(point, cost);
    // What is beaten lies beneath.
    for first in chart.curves() {
        let points: Vec<&Point> =
            chart.points.iter().filter(|point| point.name == first.name && point.class == first.class).collect();
        let path: Vec<String> =
            points.iter().map(|point| place(point)).map(|(x, y)| format!("{x:.1} {y:.1}")).collect();
        let colour = looks.colour(first);
        let _ = write!(svg, r#"<g {colour}><path class="curve" data-c="{}" d="M{}"/></g>"#, key(first), path.join("L"));
        points.into_iter().filter(|point| !marked(point)).for_each(|point| svg += &mark(point, looks, cost, &x, &y));
    }
    let mut front: Vec<&Point> = chart.points.iter().filter(marked).collect();
    front.sort_by(|a, b| cost.of(a).total_cmp(&cost.of(b)));
    for class in [Class::Cpu, Class::Gpu] {
        let own: Vec<(f64, f64)> =
            front.iter().filter(|point| point.class == class).map(|point| place(point)).collect();
        svg += &stairs(&own, class);
    }
    front.iter().for_each(|point| svg += &mark(point, looks, cost, &x, &y));
    svg + &names(&front, place, frame)
}

/// Whether nothing of its class beats a point.
fn on_front(point: &Point, cost: Cost) -> bool {
    match cost {
        Cost::All => point.pareto,
        Cost::Walks => point.pareto_walks,
    }
}

/// Ends of the error bars along both axes; errors in percent.
fn bars(point: &Point, cost: Cost) -> [[f64; 2]; 2] {
    let along = match cost {
        Cost::All => [point.total_s[1], point.total_s[2]],
        Cost::Walks => [point.noise_free_cost_s; 2],
    };
    [along, point.total_error.bounds.map(|error| 100.0 * error)]
}

/// A point with its error bars and, for whoever points at it or comes to it by keyboard, what it is.
fn mark(point: &Point, looks: &Looks, cost: Cost, x: &Scale, y: &Scale) -> String {
    let on = if on_front(point, cost) { " on" } else { "" };
    let (px, py) = (x.place(cost.of(point)), y.place(100.0 * point.total_error.value));
    let [[low, high], [good, bad]] = bars(point, cost);
    let [low, high, good, bad] = [x.place(low), x.place(high), y.place(good), y.place(bad)];
    let colour = looks.colour(point).replace(r#"class="fibers""#, "");
    let fibers = if point.explicit { " fibers" } else { "" };
    let focus = if on.is_empty() { "-1" } else { "0" };
    format!(
        r#"<g class="m {}{on}{fibers}" {colour} data-c="{}" tabindex="{focus}"><title>{}</title><path class="bar" d="M{low:.1} {py:.1}H{high:.1}M{px:.1} {bad:.1}V{good:.1}"/><path d="{}"/></g>"#,
        point.class.name(),
        key(point),
        text(&of_point(point)),
        shape(point, px, py)
    )
}

/// What the marks of a configuration on an engine class have in common.
fn key(point: &Point) -> String {
    text(&format!("{} {}", point.class.name(), point.name))
}

/// The front: of all that is no dearer, the best.
fn stairs(points: &[(f64, f64)], class: Class) -> String {
    let Some((x, y)) = points.first() else { return String::new() };
    let mut path = format!("M{x:.1} {y:.1}");
    points[1..].iter().for_each(|(x, y)| {
        let _ = write!(path, "H{x:.1}V{y:.1}");
    });
    format!(r#"<path class="front {}" d="{path}"/>"#, class.name())
}

/// Names of the configurations on the front, each once, where there is room.
fn names(front: &[&Point], place: impl Fn(&Point) -> (f64, f64), frame: [f64; 4]) -> String {
    let cover = |point: &&Point| {
        let ((x, y), size) = (place(point), 1.2 * size(point.bytes));
        [x - size, y - size, 2.0 * size, 2.0 * size]
    };
    let mut placer = Placer::new(frame, LETTERS, front.iter().map(cover).collect());
    let mut named: Vec<&str> = Vec::new();
    let mut svg = String::new();
    // The most accurate ones have the first choice of room.
    for point in front.iter().rev() {
        if named.contains(&point.name.as_str()) {
            continue;
        }
        let (x, y) = place(point);
        let Some(Spot { x: tx, y: ty, ends, led }) = placer.place(&point.name, x, y) else { continue };
        named.push(&point.name);
        if led {
            let _ = write!(svg, r#"<path class="lead" d="M{x:.1} {y:.1}L{tx:.1} {:.1}"/>"#, ty - 0.3 * LETTERS);
        }
        let anchor = if ends { "end" } else { "start" };
        let _ = write!(
            svg,
            r#"<text class="name small" x="{tx:.1}" y="{ty:.1}" text-anchor="{anchor}">{}</text>"#,
            text(&point.name)
        );
    }
    svg
}

/// Frame, lines, numbers and words.
fn axes(x: &Scale, y: &Scale, below: &str, [left, top, width, height]: [f64; 4]) -> String {
    let (end, foot) = (left + width, top + height);
    let mut svg = String::new();
    for (value, labelled) in x.ticks() {
        let (at, class) = (x.place(value), if labelled { "strong" } else { "line" });
        let _ = write!(svg, r#"<path class="{class}" d="M{at:.1} {top}V{foot}"/>"#);
        if labelled {
            let _ = write!(
                svg,
                r#"<text class="small" x="{at:.1}" y="{}" text-anchor="middle">{}</text>"#,
                foot + 16.0,
                label(value)
            );
        }
    }
    for (value, labelled) in y.ticks() {
        let (at, class) = (y.place(value), if labelled { "strong" } else { "line" });
        let _ = write!(svg, r#"<path class="{class}" d="M{left} {at:.1}H{end}"/>"#);
        if labelled {
            let _ = write!(
                svg,
                r#"<text class="small" x="{}" y="{:.1}" text-anchor="end">{}</text>"#,
                left - 6.0,
                at + 4.0,
                label(value)
            );
        }
    }
    let (across, along) = (left + width / 2.0, top + height / 2.0);
    format!(
        r#"{svg}<rect class="frame" x="{left}" y="{top}" width="{width}" height="{height}"/><text x="{across}" y="{}" text-anchor="middle">{below}</text><text transform="translate(14 {along}) rotate(-90)" text-anchor="middle">error, % of the scattered light</text>"#,
        foot + 36.0
    )
}
