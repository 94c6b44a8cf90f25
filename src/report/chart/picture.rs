//! The picture that stands alone.

use super::looks::{Looks, STYLE, others, shapes};
use super::panel::{WIDE, panel};
use super::words::text;
use crate::plan::chart::{Chart, Cost};
use std::fmt::Write;

const GAP: f64 = 16.0;
const HEAD: f64 = 34.0;
/// Height of a line of the legend, and width of one of its characters.
const LINE: f64 = 22.0;
const CHARACTER: f64 = 6.7;

/// Both frames and the legend, as an SVG that needs nothing else.
pub fn chart_picture(chart: &Chart) -> String {
    let looks = Looks::of(chart);
    let [wide, high] = WIDE;
    let width = 2.0 * wide + GAP;
    let (mut legend, mut y) = (String::new(), HEAD + high + LINE);
    for group in [shapes(chart), looks.colours(), others(chart)] {
        let mut x = 60.0;
        for (mark, words) in group {
            let room = 46.0 + CHARACTER * words.chars().count() as f64;
            if x + room > width {
                (x, y) = (60.0, y + LINE);
            }
            let _ = write!(
                legend,
                r#"<g transform="translate({x:.0} {y:.0})">{mark}<text x="16" y="4">{}</text></g>"#,
                text(&words)
            );
            x += room;
        }
        y += LINE;
    }
    let engines = chart.engines.iter().map(|(class, adapter)| format!("{} is {adapter}", class.name()));
    let note = format!("{}; seed {}", engines.collect::<Vec<_>>().join(", "), chart.seed);
    let height = y + 12.0;
    format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img" aria-label="Speed against accuracy: {name}"><style>{STYLE}</style><rect class="paper" width="{width}" height="{height}"/><text class="title" x="50" y="20">{name}: speed against accuracy</text><g transform="translate(0 {HEAD})">{}</g><g transform="translate({} {HEAD})">{}</g>{legend}<text class="small" x="50" y="{:.0}">{}</text></svg>
"#,
        panel(chart, &looks, Cost::All, WIDE),
        wide + GAP,
        panel(chart, &looks, Cost::Walks, WIDE),
        y,
        text(&note),
        name = text(&chart.cloth),
    )
}
