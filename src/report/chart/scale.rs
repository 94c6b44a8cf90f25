//! Logarithmic axes.

/// A logarithmic axis: values from `low` to `high` lie between two places.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    low: f64,
    high: f64,
    places: [f64; 2],
}

impl Scale {
    /// An axis that holds all positive values of some, with a margin; a decade around 1 if there are none.
    pub fn of(values: impl Iterator<Item = f64>, places: [f64; 2]) -> Scale {
        let (mut low, mut high) = (f64::INFINITY, 0.0f64);
        for value in values.filter(|value| value.is_finite() && *value > 0.0) {
            (low, high) = (low.min(value), high.max(value));
        }
        if low > high {
            (low, high) = (0.5, 5.0);
        }
        let margin = (high / low).powf(0.04).max(1.15);
        Scale { low: low / margin, high: high * margin, places }
    }

    /// Where a value lies; values beyond the axis lie at its ends.
    pub fn place(&self, value: f64) -> f64 {
        let share = (value.max(self.low).min(self.high) / self.low).ln() / (self.high / self.low).ln();
        self.places[0] + share * (self.places[1] - self.places[0])
    }

    /// Values with a line, and whether they have a label: powers of ten; of few decades also twice and five times these; the other
    /// multiples where there is room.
    pub fn ticks(&self) -> Vec<(f64, bool)> {
        let decades = (self.high / self.low).log10();
        let labelled: &[u32] = if decades < 3.0 { &[1, 2, 5] } else { &[1] };
        let mut ticks = Vec::new();
        for power in self.low.log10().floor() as i32..=self.high.log10().ceil() as i32 {
            for digit in 1..10u32 {
                let value = f64::from(digit) * 10f64.powi(power);
                let seen = labelled.contains(&digit) || decades < 5.0;
                if value >= self.low && value <= self.high && seen {
                    ticks.push((value, labelled.contains(&digit)));
                }
            }
        }
        ticks
    }
}

/// A number of an axis without zeros that say nothing: 0.02, 5, 200, 10⁵.
pub fn label(value: f64) -> String {
    let power = value.log10().round() as i32;
    if (-3..4).contains(&power) {
        let digits = (-value.log10().floor()).max(0.0) as usize;
        return format!("{value:.digits$}");
    }
    let raised: String = power.to_string().chars().map(raise).collect();
    let digit = (value / 10f64.powi(power)).round();
    if digit == 1.0 { format!("10{raised}") } else { format!("{digit}·10{raised}") }
}

fn raise(c: char) -> char {
    match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        c => c.to_digit(10).and_then(|digit| char::from_u32(0x2070 + digit)).unwrap_or(c),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_lie_where_their_values_do() {
        let scale = Scale::of([0.02, 7.0].into_iter(), [100.0, 400.0]);
        let labelled: Vec<f64> = scale.ticks().into_iter().filter(|tick| tick.1).map(|tick| tick.0).collect();
        assert_eq!(
            labelled.iter().map(|value| label(*value)).collect::<Vec<_>>(),
            ["0.02", "0.05", "0.1", "0.2", "0.5", "1", "2", "5"]
        );
        // Equal factors are equal distances.
        let at = |value| scale.place(value);
        assert!((at(0.2) - at(0.02) - (at(2.0) - at(0.2))).abs() < 1e-9);
        assert_eq!((at(1e-9), at(1e9)), (100.0, 400.0));
    }

    #[test]
    fn labels_say_what_they_mean() {
        let written = [0.001, 0.5, 30.0, 1000.0, 1e5, 2e-7].map(label);
        assert_eq!(written, ["0.001", "0.5", "30", "1000", "10⁵", "2·10⁻⁷"]);
    }
}
