//! What a study says to people: progress, sentences, knobs.

use super::{
    choice::Cheapest,
    digits::{percent, seconds, signed, two_digits},
    knobs::{Knob, Turned},
    record::{Outcome, Record},
    report::{Findings, MethodFinding},
    table::{at_wanted, table},
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
    let mut lines = markdown(table(findings));
    lines.push(String::new());
    lines.extend(sentences(findings));
    let wanted = at_wanted(findings);
    if wanted.len() > 2 {
        lines.push(String::new());
        lines.extend(markdown(wanted));
    }
    for turned in &findings.turned {
        lines.push(String::new());
        lines.push(format!("Knobs of {}, {}, turned one at a time:", turned.at.method, turned.at.words()));
        let uncertainty = findings.uncertainty();
        lines.push(format!("  {:<10} {:<18} {:<24} {}", "knob", "turned to", "changes the quantity by", "and leaves an error of"));
        let line = |knob: &Knob| format!("  {:<10} {:<18} {:<24} {}", knob.name, knob.to, change(knob), left(knob, uncertainty));
        lines.extend(turned.knobs.iter().map(|knob| line(knob).trim_end().to_owned()));
        lines.extend(dominating(turned).map(|text| format!("  {text}")));
    }
    lines.join("\n")
}

fn markdown(table: Vec<Vec<String>>) -> Vec<String> {
    let mut lines: Vec<String> = table.into_iter().map(|row| format!("| {} |", row.join(" | "))).collect();
    lines.insert(1, format!("|{}", "-|".repeat(lines[0].matches('|').count() - 1)));
    lines
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
    let Cheapest { setting, error, seconds: time, measured, .. } = method.cheapest.as_ref().filter(|own| Some(*own) != best)?;
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
    Some(format!(
        "As written ({}, {}) the scene is {error} and takes {} s.",
        setting.method,
        setting.words(),
        seconds(run.whole_seconds(findings.times))
    ))
}

/// What a knob changed, in words.
pub fn change(knob: &Knob) -> String {
    match (knob.change, &knob.remark) {
        (Some(change), None) => signed(change),
        (Some(change), Some(remark)) => format!("{} ({remark})", signed(change)),
        (None, remark) => remark.clone().unwrap_or_default(),
    }
}

/// What error a turned knob leaves, and in what time, in words.
pub fn left(knob: &Knob, uncertainty: f64) -> String {
    match (knob.error, knob.seconds) {
        (Some(error), Some(time)) => format!("{}, {} s", within(error.abs(), uncertainty), seconds(time)),
        _ => String::new(),
    }
}

/// Which knob dominates, in words.
pub fn dominating(turned: &Turned) -> Option<String> {
    let knob = turned.dominating()?;
    let (verb, it) = if knob.name == "modes" { ("dominate", "them") } else { ("dominates", "it") };
    Some(format!("the {} {verb} the error: turn {it} first for more accuracy.", knob.name))
}

fn within(error: f64, uncertainty: f64) -> String {
    if error <= uncertainty { format!("within {}", percent(uncertainty)) } else { percent(error) }
}

fn ranks(count: usize) -> String {
    if count == 1 { "1 rank".into() } else { format!("{count} ranks") }
}
