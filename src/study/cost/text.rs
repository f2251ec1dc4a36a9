//! What a study says to people.

use super::{
    cheapest::Cheapest,
    findings::{Findings, MethodFinding},
    format::{percent, seconds, signed, two_digits},
    sensitivity::{ParameterChange, Sensitivity},
    table::{at_wanted, settings},
};
use crate::experiment::table::markdown;

/// The table, the sentences and what there is to be said about parameters.
pub fn report(findings: &Findings) -> String {
    let mut lines = vec![markdown(&settings(findings)), String::new()];
    lines.extend(sentences(findings));
    let head = format!("for {}", percent(findings.wanted));
    let wanted = at_wanted(findings, &head);
    if wanted.len() > 1 {
        lines.extend([String::new(), markdown(&wanted)]);
    }
    for sensitivity in &findings.sensitivities {
        let Sensitivity { at, parameters } = sensitivity;
        lines.extend([String::new(), format!("Parameters of {}, {}, changed one at a time:", at.method, at.words())]);
        let line = |[name, to, change, left]: [&str; 4]| format!("  {name:<10} {to:<18} {change:<24} {left}").trim_end().to_owned();
        lines.push(line(["parameter", "set to", "changes the quantity by", "and leaves an error of"]));
        let uncertainty = findings.uncertainty();
        lines.extend(parameters.iter().map(|change| line([change.name, &change.to, &change_words(change), &left(change, uncertainty)])));
        lines.extend(dominating(sensitivity).map(|text| format!("  {text}")));
    }
    lines.join("\n")
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

/// What a parameter changed, in words.
pub fn change_words(parameter: &ParameterChange) -> String {
    match (parameter.change, &parameter.remark) {
        (Some(change), None) => signed(change),
        (Some(change), Some(remark)) => format!("{} ({remark})", signed(change)),
        (None, remark) => remark.clone().unwrap_or_default(),
    }
}

/// What error a changed parameter leaves, and in what time, in words.
pub fn left(parameter: &ParameterChange, uncertainty: f64) -> String {
    match (parameter.error, parameter.seconds) {
        (Some(error), Some(time)) => format!("{}, {} s", within(error.abs(), uncertainty), seconds(time)),
        _ => String::new(),
    }
}

/// Which parameter dominates, in words.
pub fn dominating(sensitivity: &Sensitivity) -> Option<String> {
    let parameter = sensitivity.dominating()?;
    let (verb, it) = if parameter.name == "modes" { ("dominate", "them") } else { ("dominates", "it") };
    Some(format!("the {} {verb} the error: turn {it} first for more accuracy.", parameter.name))
}

fn within(error: f64, uncertainty: f64) -> String {
    if error <= uncertainty { format!("within {}", percent(uncertainty)) } else { percent(error) }
}

fn ranks(count: usize) -> String {
    if count == 1 { "1 rank".into() } else { format!("{count} ranks") }
}
