//! What a study says to people: progress, table, sentences.

use super::{
    choice::Cheapest,
    knobs::{Knob, Turned},
    record::{Measured, Outcome, Record},
    report::{Findings, MethodFinding, Point},
};

/// What a run came to, in a line.
pub fn progress(record: &Record) -> String {
    let Record { setting, outcome } = record;
    let what = match outcome {
        Outcome::Failed(reason) => reason.clone(),
        Outcome::Measured(run) => {
            let value = if let [value] = run.values[..] { format!("{value:.6} in ") } else { String::new() };
            format!("{value}{} s, {:.0} iterations", seconds(run.seconds()), run.iterations)
        }
    };
    format!("{:<12} {:<48} {what}", setting.method, setting.words())
}

/// The table, the sentences and what there is to be said about knobs.
pub fn report(findings: &Findings) -> String {
    let table = table(findings).into_iter().map(|row| format!("| {} |", row.join(" | ")));
    let mut lines: Vec<String> = table.collect();
    lines.insert(1, format!("|{}", "-|".repeat(lines[0].matches('|').count() - 1)));
    lines.push(String::new());
    lines.extend(sentences(findings));
    for turned in &findings.turned {
        lines.push(String::new());
        lines.push(format!("Knobs of {}, {}, turned one at a time:", turned.at.method, turned.at.words()));
        lines.extend(turned.knobs.iter().map(|knob| format!("  {:<10} {:<18} {}", knob.name, knob.to, change(knob))));
        lines.extend(dominating(turned).map(|text| format!("  {text}")));
    }
    lines.join("\n")
}

/// Heads and rows of the table.
pub fn table(findings: &Findings) -> Vec<Vec<String>> {
    let in_time = findings.points.iter().any(|point| point.setting.step.is_some());
    let swept = findings.points.iter().any(|point| point.setting.tolerance.is_some());
    let head = |name: &str, shown: bool| shown.then(|| name.to_owned());
    let heads = [
        head("method", true),
        head("cells/radius", true),
        head("modes", true),
        head("tolerance", swept),
        head("step", in_time),
        head("unknowns", true),
        head("iterations", true),
        head("set-up s", true),
        head("solve s", true),
        head("MB", true),
        head(findings.name, true),
        head("error", true),
    ];
    let mut rows = vec![heads.into_iter().flatten().collect::<Vec<_>>()];
    rows.extend(findings.points.iter().map(|point| row(point, findings, (swept, in_time))));
    rows
}

fn row(point: &Point, findings: &Findings, (swept, in_time): (bool, bool)) -> Vec<String> {
    let none = || "-".to_owned();
    let of = |read: &dyn Fn(&Measured) -> String| point.measured.as_ref().map_or_else(none, read);
    let setting = &point.setting;
    let modes = point.measured.as_ref().and_then(|run| run.modes).or(setting.modes);
    let mut cells = vec![setting.method.clone(), cells_per_radius(point), modes.map_or_else(none, |modes| modes.to_string())];
    if swept {
        cells.push(setting.tolerance.map_or_else(none, |tolerance| format!("{tolerance:.0e}")));
    }
    if in_time {
        cells.push(setting.step.map_or_else(none, |step| step.length().to_string()));
    }
    cells.extend([
        of(&|run| thousands(run.unknowns)),
        of(&|run| format!("{:.0}", run.iterations)),
        of(&|run| seconds(run.setup_seconds)),
        of(&|run| seconds(run.solve_seconds)),
        of(&|run| format!("{:.0}", run.memory_bytes / 1e6)),
        point.value.map_or_else(none, |value| format!("{value:.6}")),
        error(point, findings.uncertainty()),
    ]);
    cells
}

fn error(point: &Point, uncertainty: f64) -> String {
    match (point.error, &point.remark) {
        (_, Some(remark)) => remark.clone(),
        (None, None) => "-".into(),
        (Some(_), None) if point.within_uncertainty => format!("within {}", percent(uncertainty)),
        (Some(error), None) if point.value.is_some() => signed(error),
        (Some(error), None) => percent(error),
    }
}

/// Cells across the smallest radius, or the spacing where there are no bodies.
pub fn cells_per_radius(point: &Point) -> String {
    match (point.cells_per_radius, point.setting.grid) {
        (Some(cells), _) => format!("{cells:.1}"),
        (None, super::setting::Fineness::CellsPerRadius(cells)) => format!("{cells:.1}"),
        (None, super::setting::Fineness::Spacing(spacing)) => format!("h = {spacing:.4}"),
    }
}

/// What was found, sentence by sentence.
pub fn sentences(findings: &Findings) -> Vec<String> {
    let mut lines = vec![match &findings.reference {
        Some(reference) => format!("Reference: {}.", reference.source),
        None => "No reference: it takes runs on at least two grids; give --exact, or more --resolutions or --budget.".to_owned(),
    }];
    lines.extend(findings.methods.iter().filter_map(orders));
    lines.push(cheapest(findings));
    lines.extend(findings.methods.iter().filter_map(|method| own_cheapest(method, findings)));
    lines.extend(written(findings));
    lines.extend(findings.notes.iter().map(|note| format!("{note}.")));
    lines
}

fn orders(method: &MethodFinding) -> Option<String> {
    let seconds = method.seconds_exponent.map(|exponent| format!("seconds grow as h^{exponent:.1}"))?;
    let order = match method.order {
        Some(order) => format!("the error falls as h^{order:.1} (predicted h^{:.1})", method.predicted_order),
        None => format!("too few errors are known to tell an order (predicted h^{:.1})", method.predicted_order),
    };
    Some(format!("{}: {order}, {seconds}.", method.method))
}

fn cheapest(findings: &Findings) -> String {
    let wanted = percent(findings.wanted);
    match findings.cheapest() {
        Some(found) => format!(
            "Cheapest for {wanted}: {}, {}: error {}, {} s for the whole scene on {}.",
            found.setting.method,
            found.setting.words(),
            within(found.error, findings.uncertainty()),
            seconds(found.seconds),
            ranks(findings.ranks)
        ),
        None if findings.uncertainty() >= findings.wanted => format!(
            "No setting is known to reach {wanted}: the reference itself is uncertain by {}; give --exact, or more --resolutions or --budget.",
            percent(findings.uncertainty())
        ),
        None => format!("No measured setting reaches {wanted} and keeps it on all finer grids."),
    }
}

fn own_cheapest(method: &MethodFinding, findings: &Findings) -> Option<String> {
    let best = findings.cheapest();
    let Cheapest { setting, error, seconds: time, measured } = method.cheapest.as_ref().filter(|own| Some(*own) != best)?;
    let ratio = best.map_or(String::new(), |best| format!(", {} times as long", two_digits(time / best.seconds)));
    Some(match measured {
        true => format!(
            "{} takes {} s for it ({}: error {}){ratio}.",
            method.method,
            seconds(*time),
            setting.words(),
            within(*error, findings.uncertainty())
        ),
        false => format!("{} is predicted to take {} s for it ({}){ratio}.", method.method, seconds(*time), setting.words()),
    })
}

fn written(findings: &Findings) -> Option<String> {
    let setting = findings.written.as_ref()?;
    let point = findings.point(setting)?;
    let run = point.measured.as_ref()?;
    let error = point.error.map_or("of an unknown error".into(), |error| {
        if point.within_uncertainty {
            format!("right within {}", percent(findings.uncertainty()))
        } else {
            format!("wrong by {}", percent(error))
        }
    });
    Some(format!("As written ({}, {}) the scene is {error} and takes {} s.", setting.method, setting.words(), seconds(run.seconds())))
}

/// What a knob changed, in words.
pub fn change(knob: &Knob) -> String {
    match (knob.change, &knob.remark) {
        (Some(change), None) => signed(change),
        (Some(change), Some(remark)) => format!("{} ({remark})", signed(change)),
        (None, remark) => remark.clone().unwrap_or_default(),
    }
}

/// Which knob dominates, in words.
pub fn dominating(turned: &Turned) -> Option<String> {
    let knob = turned.dominating()?;
    Some(format!("the {} dominates the error: turn it first for more accuracy.", knob.name))
}

fn within(error: f64, uncertainty: f64) -> String {
    if error <= uncertainty { format!("within {}", percent(uncertainty)) } else { percent(error) }
}

fn ranks(count: usize) -> String {
    if count == 1 { "1 rank".into() } else { format!("{count} ranks") }
}

/// A part of one as percent with two digits.
pub fn percent(part: f64) -> String {
    format!("{} %", two_digits(100.0 * part.abs()))
}

fn signed(part: f64) -> String {
    format!("{}{}", if part < 0.0 { "-" } else { "+" }, percent(part))
}

/// A positive number with two digits, or as many as it has before the point.
fn two_digits(number: f64) -> String {
    if number == 0.0 || !number.is_finite() {
        return number.to_string();
    }
    let decimals = (1.0 - number.log10().floor()).clamp(0.0, 8.0) as usize;
    format!("{number:.decimals$}")
}

/// Seconds with three digits.
pub fn seconds(seconds: f64) -> String {
    let decimals = if seconds > 0.0 { (2.0 - seconds.log10().floor()).clamp(0.0, 4.0) as usize } else { 0 };
    format!("{seconds:.decimals$}")
}

fn thousands(count: f64) -> String {
    if count < 1e4 { format!("{count:.0}") } else { format!("{:.0} k", count / 1e3) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_matter() {
        assert_eq!([0.01, 0.000321, 0.5, 1.234, 0.0].map(percent), ["1.0 %", "0.032 %", "50 %", "123 %", "0 %"]);
        assert_eq!([0.00212, 0.0123, 1.5, 123.4].map(seconds), ["0.0021", "0.0123", "1.50", "123"]);
        assert_eq!(signed(-0.00172), "-0.17 %");
        assert_eq!([450.0, 136_107.0].map(thousands), ["450", "136 k"]);
    }
}
