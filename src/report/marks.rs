//! Marks that say how long things are.

use super::colour::Colour;
use super::image::Image;
use super::layout::{Layout, Panel};
use super::text::Font;

const INK: Colour = [0.03; 3];
const FAINT: Colour = [0.25; 3];

/// Draw a scale bar under a panel, a round length of at most a quarter of it, and say how long it is.
pub fn scale_bar(image: &mut Image, body: Font, margin: usize, panel: &Panel) {
    let most = panel.width as f64 / 4.0 / panel.per_mm;
    let decade = 10f64.powf(most.log10().floor());
    let length = [5.0, 2.0, 1.0].map(|times| times * decade).into_iter().find(|length| *length <= most);
    let length = length.unwrap_or(decade);
    let thick = (margin / 8).max(2);
    let width = (length * panel.per_mm).round() as usize;
    let top = panel.top + panel.height + (margin / 4).max(2);
    let middle = top + body.height() / 2;
    image.fill([panel.left, middle - thick / 2, width, thick], INK);
    for end in [panel.left, panel.left + width - thick.min(width)] {
        image.fill([end, middle - 2 * thick, thick, 4 * thick], INK);
    }
    let text = format!("{} mm", round(length));
    body.write(image, [panel.left + width + margin / 2, top], &text, INK);
}

/// Mark z = 0 and the thickness of a cut: dashed lines through both, their names to the left.
pub fn heights(image: &mut Image, layout: &Layout, panel: &Panel, thickness: f64) {
    let top = panel.top + layout.room;
    let bottom = top + (thickness * panel.per_mm).round() as usize;
    let dash = (layout.margin / 4).max(4);
    for row in [top, bottom] {
        for start in (0..panel.width).step_by(2 * dash) {
            image.fill([panel.left + start, row, dash.min(panel.width - start), 1], FAINT);
        }
    }
    // An upright line with a bar at each end.
    let x = panel.left - layout.margin / 3;
    let bar = (layout.margin / 4).max(3);
    image.fill([x, top, 1, bottom - top + 1], INK);
    for row in [top, bottom] {
        image.fill([x - bar / 2, row, bar + 1, 1], INK);
    }
    let mut name = |text: &str, middle: usize| {
        let left = (x - bar).saturating_sub(layout.body.width(text));
        layout.body.write(image, [left, middle.saturating_sub(layout.body.height() / 2)], text, INK);
    };
    name("z = 0", top);
    name(&format!("{} mm", round(thickness)), bottom.max(top + layout.body.height()));
}

/// A length with three digits.
pub fn round(value: f64) -> String {
    let digits = (2.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

#[cfg(test)]
mod tests {
    use super::round;

    #[test]
    fn lengths_have_three_digits() {
        assert_eq!([0.5, 0.6804, 12.345, 200.0, 1.0].map(round), ["0.5", "0.68", "12.3", "200", "1"]);
    }
}
