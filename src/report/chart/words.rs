//! What a chart teaches, in sentences made from its numbers.

use crate::plan::chart::{Chart, Class, Cost, Point, Way};
use crate::plan::{Deviation, Part};
use crate::scene::Placement;

/// Errors at which ways are compared.
const ERRORS: [f64; 5] = [0.2, 0.1, 0.05, 0.02, 0.01];
/// Costs that differ by less than this factor are called equal.
const EQUAL: f64 = 1.25;

/// Text inside of an element or an attribute.
pub fn text(words: &str) -> String {
    let escape = |c: char| match c {
        '&' => "&amp;".into(),
        '<' => "&lt;".into(),
        '>' => "&gt;".into(),
        '"' => "&quot;".into(),
        c if c.is_control() && c != '\n' => " ".into(),
        c => c.to_string(),
    };
    // A percent sign stays with its number.
    words.replace(" %", "\u{a0}%").chars().map(escape).collect()
}

/// A time with two or three digits and its unit.
pub fn time(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => format!("{:.2} ms", 1e3 * s),
        s if s < 0.1 => format!("{:.0} ms", 1e3 * s),
        s if s < 9.95 => format!("{s:.2} s"),
        s if s < 600.0 => format!("{s:.0} s"),
        s => format!("{:.0} min", s / 60.0),
    }
}

/// Memory with its unit.
pub fn memory(bytes: usize) -> String {
    match bytes as f64 / 1024.0 {
        kib if kib < 1000.0 => format!("{kib:.0} KiB"),
        kib if kib < 10_240.0 => format!("{:.1} MiB", kib / 1024.0),
        kib => format!("{:.0} MiB", kib / 1024.0),
    }
}

/// A share in percent with as many digits as it is worth.
pub fn percent(share: f64) -> String {
    match 100.0 * share {
        value if !value.is_finite() => "without bound".into(),
        value if value < 0.995 => format!("{value:.2} %"),
        value if value < 9.95 => format!("{value:.1} %"),
        value => format!("{value:.0} %"),
    }
}

/// All that is known of a point, in four lines.
pub fn of_point(point: &Point) -> String {
    let Point { total_error, noise, model_error, total_s, .. } = point;
    let reach = if point.walks > point.walks_made { ", more than were made" } else { "" };
    format!(
        "{} on {}\n{} walks of each direction{reach}\nerror {} (of it noise {}, model {})\n{} in all ({} to {}), of it {} of preparation\n{} of \
         walks without the noise of the clock; {}",
        point.name,
        point.class.name(),
        point.walks,
        with_error(total_error.value, total_error.stderr),
        percent(noise.value),
        deviation(model_error),
        time(total_s[0]),
        time(total_s[1]),
        time(total_s[2]),
        time(point.prepare_s),
        time(point.noise_free_cost_s),
        memory(point.bytes),
    )
}

/// A share and its error in percent.
pub fn with_error(value: f64, error: f64) -> String {
    if value == 0.0 && error == 0.0 {
        return "none".into();
    }
    let digits = if 100.0 * error < 0.095 { 2 } else { 1 };
    format!("{:.digits$} ± {:.digits$} %", 100.0 * value, 100.0 * error)
}

/// Media against the fibers themselves, at one error.
pub struct Contest<'a> {
    /// The error.
    pub error: f64,
    /// The cheapest medium on the processor, if any comes so far.
    pub medium: Option<Way<'a>>,
    /// The fibers themselves.
    pub fibers: Way<'a>,
    /// The cheapest medium of the gpu engine.
    pub gpu: Option<Way<'a>>,
}

impl Contest<'_> {
    /// Whether the fibers are cheaper than all media on the processor; none where they are about equal.
    fn fibers_win(&self) -> Option<bool> {
        match &self.medium {
            None => Some(true),
            Some(way) if way.seconds > EQUAL * self.fibers.seconds => Some(true),
            Some(way) if self.fibers.seconds > EQUAL * way.seconds => Some(false),
            Some(_) => None,
        }
    }
}

/// Media against the fibers themselves, from rough to fine.
pub fn contests(chart: &Chart, cost: Cost) -> Vec<Contest<'_>> {
    let one = |error: f64| {
        let medium = |class| chart.cheapest(error, class, cost, |point| !point.explicit);
        let fibers = chart.cheapest(error, Class::Cpu, cost, |point| point.explicit)?;
        Some(Contest { error, medium: medium(Class::Cpu), fibers, gpu: medium(Class::Gpu) })
    };
    ERRORS.into_iter().filter_map(one).collect()
}

/// Plain sentences: who wins where, what no medium reaches, what memory it takes, and where the error comes from.
pub fn chart_findings(chart: &Chart) -> Vec<String> {
    let mut sentences = Vec::new();
    if chart.curves().any(|point| point.class == Class::Cpu && !point.explicit) {
        sentences.extend(winners(chart, Cost::All, "With the preparation, on the processor,"));
        sentences.extend(winners(chart, Cost::Walks, "Of the walks alone, on the processor,"));
    }
    sentences.extend(limits(chart));
    sentences.extend(on_gpu(chart));
    sentences.extend(papers(chart));
    sentences.push(budget(chart));
    sentences
}

/// Who is cheaper at which errors.
fn winners(chart: &Chart, cost: Cost, begin: &str) -> Option<String> {
    let all = contests(chart, cost);
    let at = |wins: Option<bool>| {
        let errors: Vec<String> =
            all.iter().filter(|one| one.fibers_win() == wins).map(|one| whole(one.error)).collect();
        (!errors.is_empty()).then(|| listed(&errors))
    };
    let [fibers, medium, equal] = [Some(true), Some(false), None].map(at);
    let mut parts = Vec::new();
    parts.extend(fibers.map(|errors| format!("the fibers themselves are cheapest at an error of {errors}")));
    parts.extend(medium.map(|errors| format!("a medium is cheapest at {errors}")));
    parts.extend(equal.map(|errors| format!("both cost about as much at {errors}")));
    let example = all.iter().rev().find_map(|one| Some((one, one.medium.as_ref()?)));
    let example = example.map_or(String::new(), |(one, way)| {
        let [medium, fibers] = [way.seconds, one.fibers.seconds].map(time);
        format!("; at {} {} takes {medium} and {} {fibers}", whole(one.error), way.point.name, one.fibers.point.name)
    });
    (!parts.is_empty()).then(|| format!("{begin} {}{example}.", parts.join(", ")))
}

/// A round share in percent.
pub fn whole(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

fn listed(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [only] => only.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")).replace(" %,", ",").replace(" % and", " and"),
    }
}

/// The best medium, and the smallest.
fn limits(chart: &Chart) -> Option<String> {
    let media = chart.curves().filter(|point| !point.explicit);
    let best = media.min_by(|a, b| a.model_error.bounds[1].total_cmp(&b.model_error.bounds[1]))?;
    let fibers = chart.curves().find(|point| point.explicit)?;
    Some(format!(
        "More walks mend noise, not the model: the best medium, {}, stays off by {} of the scattered light; it takes {}, a \
         realization of the fibers {}.",
        best.name,
        deviation(&best.model_error),
        memory(best.bytes),
        memory(fibers.bytes)
    ))
}

/// What the gpu engine does for media.
fn on_gpu(chart: &Chart) -> Option<String> {
    let (_, adapter) = chart.engines.iter().find(|(class, _)| *class == Class::Gpu)?;
    let ratio = |point: &Point| {
        let there = chart.curves().find(|other| other.class == Class::Gpu && other.name == point.name)?;
        // The least seconds are those of many walks, which a start of the device weighs least in.
        let per_walk = |point: &Point| point.seconds[1] / point.walks as f64;
        Some(per_walk(point) / per_walk(there))
    };
    let media = chart.curves().filter(|point| point.class == Class::Cpu && !point.explicit);
    let mut ratios: Vec<f64> = media.filter_map(ratio).collect();
    ratios.sort_by(f64::total_cmp);
    let (least, most) = (ratios.first()?, ratios.last()?);
    Some(format!(
        "Through a medium the gpu engine makes {:.1} times as many walks a second as the cpu engine ({least:.1} to {most:.1}), on {adapter}.",
        ratios[ratios.len() / 2]
    ))
}

/// How the paper's placement does.
fn papers(chart: &Chart) -> Option<String> {
    let best = |at_hit: bool| {
        let of = |point: &&Point| !point.explicit && (point.placement == Some(Placement::AtHit)) == at_hit;
        chart.curves().filter(of).min_by(|a, b| a.model_error.bounds[1].total_cmp(&b.model_error.bounds[1]))
    };
    let (paper, other) = (best(true)?, best(false)?);
    Some(format!(
        "Flights that start at the hit, as in the paper, leave {} at best ({}); such as start where light leaves the fiber leave {} ({}).",
        deviation(&paper.model_error),
        paper.name,
        deviation(&other.model_error),
        other.name
    ))
}

/// The parts of the error of the scene's own medium.
fn budget(chart: &Chart) -> String {
    let size = |wanted: Part| {
        let part = chart.budget.parts.iter().find(|part| part.part == wanted);
        part.and_then(|part| part.size).map(|size| deviation(&size))
    };
    let part = |wanted: Part| size(wanted).map(|size| format!("{} {size}", wanted.name()));
    let parts: Vec<String> =
        [Part::Directions, Part::Cells, Part::Averaging, Part::Medium].into_iter().filter_map(part).collect();
    let total = size(Part::Total).unwrap_or_default();
    let parts =
        if parts.is_empty() { "no part was measured".into() } else { format!("of the parts: {}", parts.join(", ")) };
    format!("The model of {} is off by {total} in all; {parts}.", chart.budget.configuration)
}

/// A deviation with its error; one that noise may hide, whose square is below three of its standard errors, by the bound that it
/// keeps 39 times in 40.
pub fn deviation(deviation: &Deviation) -> String {
    let Deviation { value, stderr, bounds } = deviation;
    let error = bounds[1].powi(2) - value.powi(2);
    match value.powi(2) {
        square if square >= 3.0 * error => with_error(*value, *stderr),
        square => format!("less than {}", percent((square + 2.0 * error).sqrt())),
    }
}
