//! A chart in words.

use super::super::show::{budget_lines, grouped};
use fiberwalk::plan::chart::{Chart, Engines, Store};
use fiberwalk::report::chart_findings;
use fiberwalk::scene::{Scene, Source};
use std::fmt::Write;
use std::time::Duration;

/// What is going to be done.
pub fn notes(source: &Source, scene: &Scene, engines: &Engines, store: &Store, time: Duration) -> Vec<String> {
    let mut lines = vec![format!("{}: {}", source.file, scene.name)];
    for (class, adapter) in engines.names() {
        lines.push(format!("{} engine: {adapter}", class.name()));
    }
    lines.extend(engines.without.as_ref().map(|why| format!("no gpu engine: {why}")));
    let (spent, time) = (store.head.spent, time.as_secs_f64());
    if spent > 0.0 {
        let left = (time - spent).max(0.0);
        lines.push(format!("goes on with a chart that has had {spent:.0} s: {left:.0} s are left"));
    }
    lines
}

/// The error budget, the front, and where the files are.
pub fn findings(chart: &Chart) -> String {
    let mut text = budget_lines(&chart.budget);
    let _ =
        writeln!(text, "no faster way is as accurate ({} s in all, with preparation)", grouped(chart.spent_s as u64));
    let _ = writeln!(text, "  {:>9}  {:>7}  {:<4}  {:>9}  configuration", "seconds", "error %", "on", "walks");
    let mut front: Vec<_> = chart.points.iter().filter(|point| point.pareto).collect();
    front.sort_by(|a, b| {
        (a.class, a.total_s[0]).partial_cmp(&(b.class, b.total_s[0])).unwrap_or(std::cmp::Ordering::Equal)
    });
    for point in front {
        let (seconds, error) = (point.total_s[0], 100.0 * point.total_error.value);
        let walks = grouped(point.walks);
        let _ = writeln!(text, "  {seconds:>9.3}  {error:>7.2}  {:<4}  {walks:>9}  {}", point.class.name(), point.name);
    }
    for sentence in chart_findings(chart) {
        let _ = writeln!(text, "{sentence}");
    }
    text
}
