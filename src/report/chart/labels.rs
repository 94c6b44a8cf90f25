//! Names beside points, none on top of another.

/// A rectangle: left, top, width, height.
pub type Box4 = [f64; 4];

/// Width of a character of the labels over their height.
const CHARACTER: f64 = 0.56;
/// Distances from the point, in heights of the letters.
const NEAR: f64 = 0.8;
const FAR: f64 = 2.2;

/// Where a name stands, and whether it begins there or ends there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Its base line's beginning or end.
    pub x: f64,
    /// Its base line.
    pub y: f64,
    /// It ends at `x`.
    pub ends: bool,
    /// It stands so far from its point that a line leads there.
    pub led: bool,
}

/// Places names in a frame.
pub struct Placer {
    frame: Box4,
    taken: Vec<Box4>,
    height: f64,
}

impl Placer {
    /// In a frame with letters of this height; `taken` are boxes that no name may cover.
    pub fn new(frame: Box4, height: f64, taken: Vec<Box4>) -> Placer {
        Placer { frame, taken, height }
    }

    /// A free spot for a name at a point; none where there is no room.
    pub fn place(&mut self, name: &str, x: f64, y: f64) -> Option<Spot> {
        let (height, width) = (self.height, CHARACTER * self.height * name.chars().count() as f64);
        let mut spots = Vec::new();
        for (away, led) in [(NEAR, false), (FAR, true), (2.0 * FAR, true), (3.5 * FAR, true)] {
            let away = away * height;
            let aslant = 0.7 * away;
            for (dx, dy) in [(away, 0.0), (aslant, -aslant), (aslant, aslant), (0.0, -away), (0.0, away)] {
                let y = y + dy + 0.35 * height;
                spots.push(Spot { x: x + dx, y, ends: false, led });
                spots.push(Spot { x: x - dx, y, ends: true, led });
            }
        }
        let cover = |spot: &Spot| {
            let left = if spot.ends { spot.x - width } else { spot.x };
            [left, spot.y - 0.8 * height, width, height]
        };
        let spot = spots.into_iter().find(|spot| {
            let own = cover(spot);
            inside(own, self.frame) && self.taken.iter().all(|taken| apart(own, *taken))
        })?;
        self.taken.push(cover(&spot));
        Some(spot)
    }
}

fn inside(a: Box4, b: Box4) -> bool {
    a[0] >= b[0] && a[1] >= b[1] && a[0] + a[2] <= b[0] + b[2] && a[1] + a[3] <= b[1] + b[3]
}

fn apart(a: Box4, b: Box4) -> bool {
    a[0] + a[2] <= b[0] || b[0] + b[2] <= a[0] || a[1] + a[3] <= b[1] || b[1] + b[3] <= a[1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_covers_another_or_leaves_the_frame() {
        let mut placer = Placer::new([0.0, 0.0, 400.0, 200.0], 10.0, vec![[195.0, 95.0, 10.0, 10.0]]);
        let spots: Vec<Spot> =
            (0..8).filter_map(|i| placer.place("carried 4R 1024d", 200.0, 100.0 + f64::from(i))).collect();
        assert!(spots.len() > 5, "only {} found room", spots.len());
        let all = placer.taken.clone();
        for (i, a) in all.iter().enumerate() {
            assert!(inside(*a, placer.frame));
            assert!(all[..i].iter().all(|b| apart(*a, *b)), "{a:?} covers another");
        }
        // A frame with no room has no name.
        assert_eq!(Placer::new([0.0, 0.0, 20.0, 20.0], 10.0, vec![]).place("carried", 10.0, 10.0), None);
    }
}
