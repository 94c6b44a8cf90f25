//! How far a chart has come.

use fiberwalk::plan::chart::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::{Duration, Instant};

/// Time between two lines of progress where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(10);

/// Shows how far a chart has come: a bar on a terminal, now and then a line elsewhere.
pub struct Watch {
    /// The bar.
    pub bar: ProgressBar,
    line_due: Instant,
}

impl Watch {
    pub fn new() -> Watch {
        let style = ProgressStyle::with_template("{bar:30} {percent}% {msg}");
        let bar = ProgressBar::new(1000).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        Watch { bar, line_due: Instant::now() + LINE_EVERY }
    }

    pub fn show(&mut self, progress: &Progress) {
        let Progress { spent, time, doing, measured, .. } = progress;
        let share = (spent / time).min(1.0);
        let message = format!("{measured} configurations, {doing}, {:.0} s left", (time - spent).max(0.0));
        if self.bar.is_hidden() && Instant::now() >= self.line_due {
            self.line_due = Instant::now() + LINE_EVERY;
            eprintln!("{:.0} % done, {message}", 100.0 * share);
        }
        self.bar.set_position((1000.0 * share) as u64);
        self.bar.set_message(message);
    }
}
