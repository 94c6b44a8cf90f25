//! How far a run has come.

use fiberwalk::measure::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::{Duration, Instant};

/// Time between two lines of progress where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(10);

/// Shows how far a run has come: a bar on a terminal, now and then a line elsewhere.
pub struct Watch {
    /// The bar.
    pub bar: ProgressBar,
    line_due: Instant,
}

impl Watch {
    pub fn new() -> Watch {
        let template = "{bar:30} {percent}% {msg}, {eta} left";
        let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
        Watch { bar: ProgressBar::new(1).with_style(style), line_due: Instant::now() + LINE_EVERY }
    }

    pub fn show(&mut self, progress: Progress) {
        let rate = progress.walks as f64 / self.bar.elapsed().as_secs_f64();
        let message = format!("{rate:.2e} walks/s, noise {:.1} %", 100.0 * progress.noise);
        if self.bar.is_hidden() && Instant::now() >= self.line_due {
            self.line_due += LINE_EVERY;
            let planned = progress.planned.unwrap_or(progress.walks);
            let share = progress.walks as f64 / planned as f64;
            let left = planned.saturating_sub(progress.walks) as f64 / rate;
            eprintln!("{:.0} % done, {message}, {left:.0} s left", 100.0 * share);
        }
        if let Some(planned) = progress.planned {
            self.bar.set_length(planned.max(progress.walks));
        }
        self.bar.set_position(progress.walks);
        self.bar.set_message(message);
    }
}
