//! The draft as a grid.

use super::colour::Colour;
use super::image::Image;
use crate::scene::Weave;

const BLACK: Colour = [0.01; 3];
const WHITE: Colour = [1.0; 3];
const LINE: Colour = [0.45; 3];
/// Largest side of a cell as a share of the square.
const LARGEST: f64 = 0.16;

/// Draw one repeat of the draft into the upper right corner of a square (left, top, side): black where the warp lies over
/// the weft, the yarns' colours above and to the left. Says the columns that it takes.
pub fn draw(image: &mut Image, [left, top, side]: [usize; 3], weave: &Weave, yarns: &[Colour]) -> usize {
    let (ends, picks) = (weave.ends.len(), weave.picks.len());
    let most = ends.max(picks) as f64 + 1.5;
    let cell = (side as f64 / most).min(LARGEST * side as f64);
    // Two strips of yarns, one and a half cells wide with their gap, but wide enough to be seen.
    let strip = (cell.max(0.04 * side as f64)).round() as usize;
    let gap = (strip / 3).max(2);
    let cell = cell.min((side - strip - gap) as f64 / ends.max(picks) as f64);
    let [wide, high] = [ends, picks].map(|count| (count as f64 * cell).round() as usize);
    let (corner_x, corner_y) = (left + side - wide, top + strip + gap);
    let edge = |index: usize| (index as f64 * cell).round() as usize;
    for (end, yarn) in weave.ends.iter().enumerate() {
        let (from, to) = (edge(end), edge(end + 1));
        image.fill([corner_x + from, top, to - from, strip], yarns[*yarn]);
        for pick in 0..picks {
            // The first pick is the lowest row.
            let (low, high) = (edge(picks - 1 - pick), edge(picks - pick));
            let colour = if weave.warp_over(end, pick) { BLACK } else { WHITE };
            image.fill([corner_x + from, corner_y + low, to - from, high - low], colour);
        }
    }
    let column = corner_x - gap - strip;
    for (pick, yarn) in weave.picks.iter().enumerate() {
        let (low, high) = (edge(picks - 1 - pick), edge(picks - pick));
        image.fill([column, corner_y + low, strip, high - low], yarns[*yarn]);
    }
    // Lines between cells that are large enough for them.
    let lines = |count: usize| (0..=count).filter(move |index| cell >= 5.0 || *index == 0 || *index == count);
    for (x, width) in [(corner_x, wide), (column, strip)] {
        for index in lines(picks) {
            image.fill([x, corner_y + edge(index), width + 1, 1], LINE);
        }
    }
    for (y, height) in [(corner_y, high), (top, strip)] {
        for index in lines(ends) {
            image.fill([corner_x + edge(index), y, 1, height + 1], LINE);
        }
    }
    for y in [top, top + strip] {
        image.fill([corner_x, y, wide + 1, 1], LINE);
    }
    for x in [column, column + strip] {
        image.fill([x, corner_y, 1, high + 1], LINE);
    }
    wide + gap + strip
}
