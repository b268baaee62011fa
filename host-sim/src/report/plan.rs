//! The report of a plan: where the feed is below what the job asks for, and which limit of which axis says so.

use std::f64::consts::PI;

use super::ReportError;
use super::figures::per_minute;
use super::limited::{Axis, Cause, Limited, Share, Slow};
use super::page::{Layout, Page, escape};
use super::plan_figures::{feed_over_time, path_by_cause};
use super::series::{number, three_figures};
use crate::contour::Along;
use crate::job::{Job, Units};
use crate::path::Path;
use crate::plan::{Limits, Plan};

/// The report of a plan. `path` is the one that was planned, before or with its plan. Errors: a plan without motion; a picture that cannot
/// be drawn.
pub fn plan(job: &Job, path: &Path, plan: &Plan, limits: &Limits) -> Result<String, ReportError> {
    let limited = Limited::new(plan, limits).ok_or(ReportError::NoSamples)?;
    let units = job.units;
    let mut page = Page::new(&format!("Plan of {}", job.name()), &lead(job, path, &limited));
    page.facts(&facts(units, &limited));
    page.block(&limit_table(units, limits, path.pieces.iter().any(|piece| piece.height.is_some())));
    page.paragraph(&summary(&limited));
    page.heading("The feed, and what limits it");
    page.block("<div class=\"charts\">");
    page.figure(&[feed_over_time(units, plan, &limited)?], Layout::Single, OVER_TIME);
    page.figure(&[path_by_cause(job, path, plan, &limited)?], Layout::Single, IN_THE_PLANE);
    page.block("</div>");
    page.heading("What each limit takes");
    page.block(&share_table(units, &limited));
    page.paragraph(
        "Each place counts for the limit that holds its feed. On the way into a slow place and out of it that is an acceleration or a jerk, \
         though the place itself is the cause: what it costs with its surroundings stands in the next table.",
    );
    page.heading("The slowest places");
    if limited.slow.is_empty() {
        page.paragraph("Nowhere on its way is the feed lower than before and behind.");
    } else {
        page.block(&slow_table(job, plan, limits, &limited));
        page.paragraph(&format!(
            "The lowest of the {} where the feed is lower than before and behind. Time lost is what the way from the fastest place before it to \
             the fastest one behind it takes longer than at the feed that the job asks for.",
            match limited.slow.len() {
                1 => "one place".to_string(),
                count => format!("{count} places"),
            }
        ));
    }
    Ok(page.finish())
}

const OVER_TIME: &str = "The planned feed of the tool\u{2019}s centre over time, above the colour of what limits it: each coloured width is \
    time that the limit takes. The thin line is the feed that the job asks for, \
    as far as the picture reaches. Dots are places that are slower than their surroundings, in the \
    colour of what limits them there; the slowest have a number.";
const IN_THE_PLANE: &str = "The way of the tool\u{2019}s centre in the same colours, with the same dots and numbers. Dark is x, light is y, white is z.";

fn lead(job: &Job, path: &Path, limited: &Limited) -> String {
    let unit = job.units.short();
    format!(
        "Why the machine slows down: {} {unit} of way along {} segments at a feed of {} {unit}/min, weight w = {}, within the limits of the axes.",
        number(limited.way() / job.units.mm(), 1),
        job.contour.segments.len(),
        number(per_minute(job.units, job.feed.rate), 1),
        path.weight,
    )
}

fn facts(units: Units, limited: &Limited) -> Vec<(&'static str, String, &'static str)> {
    let (unit, feed) = (units.short(), feed_unit(units));
    vec![
        ("Time of the plan", number(limited.time(), 3), "s"),
        ("At the job\u{2019}s feed throughout", number(limited.own_time, 3), "s"),
        ("Length of the centre\u{2019}s way", number(limited.way() / units.mm(), 3), unit),
        ("Mean feed", number(per_minute(units, limited.way() / limited.time()), 1), feed),
        ("Largest feed", number(per_minute(units, limited.fastest), 1), feed),
    ]
}

fn feed_unit(units: Units) -> &'static str {
    match units {
        Units::Mm => "mm/min",
        Units::Inch => "in/min",
    }
}

/// A limit in mm in the job's unit.
fn limit(units: Units, value: f64) -> String {
    if value.is_finite() { three_figures(value / units.mm()) } else { "none".to_string() }
}

fn limit_table(units: Units, limits: &Limits, has_z: bool) -> String {
    let unit = units.short();
    let axis = |name: &str, number: usize| {
        let of = [limits.velocity, limits.acceleration, limits.jerk, limits.corner_step];
        let cells: String = of.iter().map(|limit_of| format!("<td>{}</td>", limit(units, limit_of[number]))).collect();
        format!("<tr><th scope=\"row\">{name}</th>{cells}</tr>")
    };
    let (feed, across) = (limit(units, limits.feed), limit(units, limits.centripetal));
    let path = format!("<tr><th scope=\"row\">path</th><td>{feed}</td><td>{across}</td><td></td><td></td></tr>");
    format!(
        "<div class=\"scroll\"><table class=\"plan limits\"><caption>Limits</caption><thead><tr><td></td><th scope=\"col\">velocity, \
         {unit}/s</th><th scope=\"col\">acceleration, {unit}/s\u{b2}</th><th scope=\"col\">jerk, {unit}/s\u{b3}</th><th scope=\"col\">step at \
         a corner, {unit}/s</th></tr></thead><tbody>{}{}{}{path}</tbody></table></div>",
        axis("x", 0),
        axis("y", 1),
        if has_z { axis("z", 2) } else { String::new() }
    )
}

fn percent(part: f64) -> String {
    format!("{}\u{a0}%", number(100.0 * part, 1))
}

/// What takes most of the time that is lost.
fn summary(limited: &Limited) -> String {
    /// A part of the time that is worth no sentence.
    const LITTLE: f64 = 0.01;
    let lost = limited.time() - limited.own_time;
    if lost < LITTLE * limited.own_time {
        return "The machine runs at the feed that the job asks for almost everywhere.".to_string();
    }
    let mut by_loss: Vec<&Share> = limited.shares.iter().filter(|share| share.lost > 0.05 * lost).collect();
    by_loss.sort_by(|a, b| b.lost.total_cmp(&a.lost).then(a.cause.cmp(&b.cause)));
    let part = |(k, share): (usize, &Share)| {
        let goes = if k == 0 { " goes" } else { "" };
        format!("{}{goes} to {}", percent(share.lost / lost), share.cause.name())
    };
    let parts: Vec<String> = by_loss.into_iter().take(4).enumerate().map(part).collect();
    let where_to = match parts.split_last() {
        Some((last, [])) => format!(" Of the time lost, {last}."),
        Some((last, before)) => format!(" Of the time lost, {} and {last}.", before.join(", ")),
        None => String::new(),
    };
    format!(
        "The plan takes {} s, {} more than the feed that the job asks for would take throughout.{where_to}",
        number(limited.time(), 2),
        percent(lost / limited.own_time),
    )
}

fn share_table(units: Units, limited: &Limited) -> String {
    let row = |share: &Share| {
        format!(
            "<tr><th scope=\"row\">{}{}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
            share.cause.swatch(),
            share.cause.name(),
            number(share.time, 3),
            percent(share.time / limited.time()),
            number(share.way / units.mm(), 2),
            percent(share.way / limited.way()),
            number(share.lost, 3),
        )
    };
    let rows: String = limited.shares.iter().map(row).collect();
    format!(
        "<div class=\"scroll\"><table class=\"plan\"><thead><tr><th scope=\"col\" class=\"words\">limit</th><th scope=\"col\">time, s</th>\
         <th scope=\"col\">of the time</th><th scope=\"col\">way, {}</th><th scope=\"col\">of the way</th><th scope=\"col\">time lost, s</th></tr>\
         </thead><tbody>{rows}<tr class=\"sum\"><th scope=\"row\">all</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr></tbody>\
         </table></div>",
        units.short(),
        number(limited.time(), 3),
        percent(1.0),
        number(limited.way() / units.mm(), 2),
        percent(1.0),
        number(limited.time() - limited.own_time, 3),
    )
}

fn slow_table(job: &Job, plan: &Plan, limits: &Limits, limited: &Limited) -> String {
    let units = job.units;
    let row = |(order, slow): &(usize, Slow)| {
        let (place, at) = (&plan.course.places[slow.at], limited.points[slow.at]);
        let coordinate = |mm: f64| number(mm / units.mm(), if units == Units::Mm { 2 } else { 3 });
        format!(
            "<tr><th scope=\"row\">{order}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>\
             <td class=\"words\">{}{}</td></tr>",
            number(limited.times[slow.at], 3),
            coordinate(at.re),
            coordinate(at.im),
            place.piece,
            along(plan, slow.at),
            three_figures(per_minute(units, plan.speed[slow.at])),
            three_figures(per_minute(units, place.feed)),
            number(slow.lost, 3),
            limited.causes[slow.at].swatch(),
            escape(&words(units, plan, limits, limited.causes[slow.at], slow.at)),
        )
    };
    let rows: String = limited.numbered().iter().map(row).collect();
    let (unit, feed) = (units.short(), feed_unit(units));
    format!(
        "<div class=\"scroll\"><table class=\"plan\"><thead><tr><th scope=\"col\" class=\"words\">no.</th><th scope=\"col\">at, s</th><th \
         scope=\"col\">x, {unit}</th><th scope=\"col\">y, {unit}</th><th scope=\"col\">piece</th><th scope=\"col\">segment</th><th \
         scope=\"col\">feed, {feed}</th><th scope=\"col\">job asks</th><th scope=\"col\">time lost, s</th><th scope=\"col\" \
         class=\"words\">what limits it</th></tr></thead><tbody>{rows}</tbody></table></div>"
    )
}

/// The segment of the contour that a place is on, or the node that it goes round.
fn along(plan: &Plan, at: usize) -> String {
    let piece = plan.course.places[at].piece;
    match plan.from.iter().position(|&from| from == piece).and_then(|part| plan.pieces.get(part)).map(|part| part.along)
    {
        Some(Along::Segment { segment, .. }) => segment.to_string(),
        Some(Along::Fill { node, .. }) => format!("node {node}"),
        None => String::new(),
    }
}

/// What limits the speed at a place, in words.
fn words(units: Units, plan: &Plan, limits: &Limits, cause: Cause, at: usize) -> String {
    /// The part of an acceleration that a bend has taken where the bend is what counts.
    const MOST: f64 = 0.5;
    let places = &plan.course.places;
    let (place, speed, unit) = (&places[at], plan.speed[at], units.short());
    let (before, after) = (&places[at.saturating_sub(1)], &places[(at + 1).min(places.len() - 1)]);
    let (name, kappa) = (cause.name(), place.curvature());
    let bend = || format!("in a bend of radius {} {unit}", three_figures(1.0 / kappa / units.mm()));
    let across = |axis: Axis| place.bend.0[axis.number()].abs() * speed * speed;
    match cause {
        Cause::Job | Cause::Rest => name.to_string(),
        Cause::Machine => format!("{name}, {} {}", limit(units, limits.feed * 60.0), feed_unit(units)),
        Cause::Velocity(axis) => format!("{name}, {} {unit}/s", limit(units, limits.velocity[axis.number()])),
        Cause::Centripetal => format!("{name}, {} {unit}/s\u{b2}, {}", limit(units, limits.centripetal), bend()),
        Cause::Acceleration(axis) => {
            let most = limits.acceleration[axis.number()];
            let why = if across(axis) > MOST * most { bend() } else { "where the feed changes".to_string() };
            format!("{name}, {} {unit}/s\u{b2}, {why}", limit(units, most))
        }
        Cause::Jerk(axis) => {
            let changes = (after.curvature() - before.curvature()).abs() > 0.2 * kappa;
            let why = match (changes, across(axis) > 0.1 * limits.acceleration[axis.number()]) {
                (true, _) => "where the bend changes".to_string(),
                (false, true) => bend(),
                (false, false) => "where the feed changes".to_string(),
            };
            format!("{name}, {} {unit}/s\u{b3}, {why}", limit(units, limits.jerk[axis.number()]))
        }
        Cause::Corner(axis) => {
            let [into, out] = if place.step == 0.0 { [before, place] } else { [place, after] };
            let turn = into.direction.angle(out.direction) * 180.0 / PI;
            let change = out.direction - into.direction;
            let step = change.0[axis.number()].abs() * speed;
            let most = limits.corner_step[axis.number()];
            let why = if step > 0.95 * most {
                format!("{} {unit}/s", limit(units, most))
            } else {
                "what its acceleration makes up to the next one".to_string()
            };
            format!("{name}, {why}, at a turn of {}\u{b0}", three_figures(turn))
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use shared::piece::Order;

    use super::super::page::tests::{assert_balanced, assert_self_contained};
    use super::*;
    use crate::plan::{Manner, planned as plan_of};

    /// 20 mm a side, from the middle of one on.
    pub const SQUARE: &str = "units = \"mm\"\nclosed = true\n[feed]\nrate = 3000.0\n\
        [[segment]]\nline = { start = [10.0, 0.0], to = [20.0, 0.0] }\n[[segment]]\nline = { to = [20.0, 20.0] }\n\
        [[segment]]\nline = { to = [0.0, 20.0] }\n[[segment]]\nline = { to = [0.0, 0.0] }\n[[segment]]\nline = { to = [10.0, 0.0] }\n";

    /// A common router's.
    pub fn limits() -> Limits {
        Limits {
            velocity: [80.0; 3],
            acceleration: [400.0; 3],
            jerk: [8000.0; 3],
            corner_step: [3.125; 3],
            feed: f64::INFINITY,
            centripetal: f64::INFINITY,
        }
    }

    /// A job, its path before it is planned, and its plan.
    pub fn planned(text: &str, order: Order) -> (Job, Path, Plan) {
        let job = Job::from_toml("part <1>.toml", text).unwrap();
        let path = Path::new(&job, order).unwrap();
        let (_, plan) = plan_of(&path, &limits(), &Manner::USUAL).unwrap();
        (job, path, plan)
    }

    /// A legend names what occurs and nothing else; names from a person are escaped.
    #[test]
    fn pages_name_what_occurs() {
        let (job, path, found) = planned(include_str!("../../../examples/bracket.toml"), Order::First);
        let html = plan(&job, &path, &found, &limits()).unwrap();
        assert_balanced(&html);
        assert_self_contained(&html);
        for words in ["part &lt;1&gt;.toml", "job\u{2019}s feed", "x jerk", "y jerk", "corner step of x", "node 5"] {
            assert!(html.contains(words), "{words}");
        }
        for words in ["x velocity", "acceleration across the path", "machine\u{2019}s feed"] {
            assert!(!html.contains(words), "{words}");
        }
        assert!(html.contains("mm/s, at a turn of 90.0\u{b0}"));
    }

    /// The pieces before and after planning are the same curves, so either path draws the same page, each time.
    #[test]
    fn pages_do_not_depend_on_which_path_is_given() {
        let (job, path, found) = planned(SQUARE, Order::First);
        let (with_profiles, _) = plan_of(&path, &limits(), &Manner::USUAL).unwrap();
        let html = plan(&job, &path, &found, &limits()).unwrap();
        assert_eq!(html, plan(&job, &with_profiles, &found, &limits()).unwrap());
    }

    /// A feed that the machine does not have is the machine's, not the job's.
    #[test]
    fn the_machines_feed_is_told_from_the_jobs() {
        let (job, path, _) = planned(SQUARE, Order::First);
        let slow = Limits { feed: 20.0, ..limits() };
        let (_, found) = plan_of(&path, &slow, &Manner::USUAL).unwrap();
        let html = plan(&job, &path, &found, &slow).unwrap();
        assert!(html.contains("machine\u{2019}s feed") && !html.contains(">job\u{2019}s feed"));
    }

    #[test]
    fn nothing_to_draw_is_said() {
        let (job, path, mut found) = planned(SQUARE, Order::First);
        found.time = 0.0;
        assert_eq!(plan(&job, &path, &found, &limits()), Err(ReportError::NoSamples));
    }
}
