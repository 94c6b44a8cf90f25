//! The page: the picture, what it teaches, the error budget and all points. It needs nothing from elsewhere.

use super::looks::{Looks, STYLE, others, shapes};
use super::panel::{NARROW, WIDE, panel};
use super::words::{Contest, chart_findings, contests, deviation, memory, percent, text, time, whole, with_error};
use crate::plan::BudgetPart;
use crate::plan::chart::{Chart, Cost, Point, Way};
use std::fmt::Write;

/// The page with names in braces where the chart goes.
const PAGE: &str = include_str!("page.html");

/// The chart as a page of its own.
pub fn chart_page(chart: &Chart) -> String {
    let looks = Looks::of(chart);
    let title = format!("{}: speed against accuracy", chart.cloth);
    let lines = |list: Vec<String>| list.join("\n");
    let findings = chart_findings(chart).iter().map(|finding| format!("<li>{}</li>", text(finding))).collect();
    let rows = chart.points.iter().map(row).collect();
    let values = [
        ("title", text(&title)),
        ("style", STYLE.into()),
        ("lead", text(&lead(chart))),
        ("panels", panels(chart, &looks)),
        ("legend", legend(chart, &looks)),
        ("reading", text(READING)),
        ("findings", lines(findings)),
        ("contests", contest_tables(chart)),
        ("budget_of", text(&chart.budget.configuration)),
        ("budget", budget(&chart.budget.parts)),
        ("rows", lines(rows)),
        ("refused", refused(chart)),
        ("made", text(&made(chart))),
    ];
    fill(PAGE, &values)
}

const READING: &str = "Names: “carried 2R 4096d” is a medium whose flights are placed “carried”, with cells of two fiber radii and 4096 directions; \
                       “fibers 256w” sends 256 walks of each direction through one realization of the fibers, then goes to the next. A curve is one way to model the cloth, with more and more walks; noise falls with the root of the walks, and time \
                       grows with them, so all of its marks follow from one measurement. Bold marks are those that no other of their \
                       engine class beats; a model whose error is not well known is judged by its upper bound. Error bars are one \
                       standard error up and down, the least and the most seconds to the sides.";

/// Put values where their names stand in braces.
fn fill(page: &str, values: &[(&str, String)]) -> String {
    let mut filled = String::with_capacity(page.len());
    let mut rest = page;
    // A value is never looked through for names.
    while let Some(open) = rest.find('{') {
        let name = rest[open + 1..].split('}').next().unwrap_or_default();
        filled += &rest[..open];
        match values.iter().find(|(known, _)| *known == name) {
            Some((_, value)) => {
                filled += value;
                rest = &rest[open + name.len() + 2..];
            }
            None => {
                filled.push('{');
                rest = &rest[open + 1..];
            }
        }
    }
    filled + rest
}

fn lead(chart: &Chart) -> String {
    let ways = chart.curves().map(|point| &point.name).collect::<std::collections::BTreeSet<_>>().len();
    format!(
        "{ways} ways to model this cloth, each held against walks through the fibers themselves: how many seconds they take, and by how much \
         of the scattered light they are off, by noise and by the model."
    )
}

fn panels(chart: &Chart, looks: &Looks) -> String {
    let mut html = String::new();
    for (class, size) in [("wide", WIDE), ("narrow", NARROW)] {
        for (cost, name) in
            [(Cost::All, "Error against all the time"), (Cost::Walks, "Error against the time of the walks alone")]
        {
            let [width, height] = size;
            let _ = writeln!(
                html,
                r#"<svg class="{class}" viewBox="0 0 {width} {height}" role="group" aria-label="{name}">{}</svg>"#,
                panel(chart, looks, cost, size)
            );
        }
    }
    html
}

fn legend(chart: &Chart, looks: &Looks) -> String {
    let mut html = String::new();
    for group in [shapes(chart), looks.colours(), others(chart)] {
        let item = |(mark, words): (String, String)| {
            format!(r#"<span><svg viewBox="-13 -9 26 18" aria-hidden="true">{mark}</svg>{}</span>"#, text(&words))
        };
        let _ = writeln!(html, r#"<div class="legend">{}</div>"#, group.into_iter().map(item).collect::<String>());
    }
    html
}

/// The cheapest ways to some errors.
fn contest_tables(chart: &Chart) -> String {
    let mut html = String::new();
    for (cost, caption) in [(Cost::All, "Seconds in all"), (Cost::Walks, "Seconds of the walks alone")] {
        let all = contests(chart, cost);
        let gpu = all.iter().any(|one| one.gpu.is_some());
        let way = |way: &Option<Way>| match way {
            Some(way) => format!("<td>{}<td class=\"way\">{}", time(way.seconds), text(&way.point.name)),
            None => "<td><td class=\"way\">none comes so far".into(),
        };
        let row = |one: &Contest| {
            let on_gpu = if gpu { way(&one.gpu) } else { String::new() };
            format!("<tr><td>{}{}{}{on_gpu}</tr>", whole(one.error), way(&Some(one.fibers)), way(&one.medium))
        };
        let head = if gpu { "<th colspan=\"2\">medium, gpu" } else { "" };
        let _ = writeln!(
            html,
            "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{caption}\"><table><caption>{caption}</caption><thead><tr><th>error<th colspan=\"2\">the fibers, cpu<th colspan=\"2\">medium, cpu{head}</tr></thead><tbody>{}</tbody></table></div>",
            all.iter().map(row).collect::<String>()
        );
    }
    html
}

/// Bars with their standard errors, on one scale.
fn budget(parts: &[BudgetPart]) -> String {
    let most = parts.iter().filter_map(|part| part.size).map(|size| size.bounds[1]).fold(1e-9, f64::max);
    let mut html = String::new();
    for part in parts {
        let name = part.part.name();
        let (track, size) = match (&part.size, &part.missing) {
            (Some(size), _) => {
                let at = |share: f64| 100.0 * (share / most).min(1.0);
                let [low, high] = size.bounds.map(at);
                let bar = format!(
                    r#"<i style="width:{:.1}%"></i><b style="left:{low:.1}%;width:{:.1}%"></b>"#,
                    at(size.value),
                    high - low
                );
                (bar, deviation(size))
            }
            (None, _) => (String::new(), "not measured".to_owned()),
        };
        let _ = writeln!(
            html,
            r#"<div>{name}</div><div class="track">{track}</div><div class="size">{}</div><div class="what">{}</div>"#,
            text(&size),
            text(part.missing.as_ref().unwrap_or(&part.change))
        );
    }
    html
}

fn row(point: &Point) -> String {
    let on = if point.pareto || point.pareto_walks { "on" } else { "beaten" };
    let beyond = if point.walks > point.walks_made { " *" } else { "" };
    let cells = [
        point.class.name().into(),
        format!("{}{beyond}", point.walks),
        digits(point.total_s[0]),
        format!("{} to {}", digits(point.total_s[1]), digits(point.total_s[2])),
        digits(point.noise_free_cost_s),
        share(point.total_error.value, point.total_error.stderr),
        share(point.noise.value, point.noise.stderr),
        deviation(&point.model_error).trim_end_matches(" %").to_owned(),
        share(point.direct_error.value, point.direct_error.stderr),
        memory(point.bytes),
    ];
    let cells: String = cells.iter().map(|cell| format!("<td>{}", text(cell))).collect();
    format!(r#"<tr class="{on}"><td>{}{cells}</tr>"#, text(&point.name))
}

fn digits(seconds: f64) -> String {
    if seconds < 9.95 { format!("{seconds:.3}") } else { format!("{seconds:.1}") }
}

/// A share and its error in percent, without the unit.
fn share(value: f64, error: f64) -> String {
    with_error(value, error).trim_end_matches(" %").to_owned()
}

fn refused(chart: &Chart) -> String {
    if chart.refused.is_empty() {
        return String::new();
    }
    let item = |(name, why): &(String, String)| format!("<li>{}: {}</li>", text(name), text(why));
    let items: String = chart.refused.iter().map(item).collect();
    format!("<h2>Ways that this cloth does not admit</h2>\n<ul class=\"faint\">{items}</ul>")
}

fn made(chart: &Chart) -> String {
    let engines = chart.engines.iter().map(|(class, adapter)| format!("{}: {adapter}", class.name()));
    let rest = match chart.left_out {
        0 => String::new(),
        count => format!(" {count} more ways were left for want of time: a larger --time goes on with them."),
    };
    format!(
        "Light from {} degrees (θ, φ), {} exit cells on each side, seed {}. Engines: {}. All are held against {}, {} walks of each \
         direction with a noise of {}. The chart took {}. A * marks more walks than were made.{rest} chart.csv has all numbers.",
        chart.incident,
        chart.exit,
        chart.seed,
        engines.collect::<Vec<_>>().join("; "),
        chart.reference.name,
        chart.reference.walks,
        percent(chart.reference.noise),
        time(chart.spent_s)
    )
}

#[cfg(test)]
mod tests {
    use super::fill;

    #[test]
    fn values_stand_where_their_names_are_and_are_not_read_again() {
        let page = fill("a {x} { margin: 0 } {y}{x}", &[("x", "{y}".into()), ("y", "2".into())]);
        assert_eq!(page, "a {y} { margin: 0 } 2{y}");
    }
}
