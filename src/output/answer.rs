//! What a run answers, in a few lines: the numbers that its scene is about. The terminal and the report show the same ones.

use super::{
    ForceSummary, MeanSpeed, MeanViscosity, Modulus, OscillationSummary, QuantitySummary, SettlingSummary, SteadyMean, Summary,
    numbers::{DECIMALS, decimals, fixed, number, vector, with_bar},
    summary::ViscositySummary,
};

/// One line of an answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Name of the quantity.
    pub name: &'static str,
    /// The value, with its interval if there is one, or why there is none.
    pub value: String,
}

/// A mean velocity below this part of the root mean square of the velocities is rounding.
const AT_REST: f64 = 1e-10;

impl Answer {
    fn new(name: &'static str, value: String) -> Answer {
        Answer { name, value }
    }
}

/// The answers of a run, the first one first.
pub fn answers(summary: &Summary) -> Vec<Answer> {
    let oscillation = summary.oscillation.iter().flat_map(of_oscillation);
    let viscosity = summary.viscosity.iter().flat_map(|viscosity| of_viscosity(viscosity, summary.steps > 0));
    let without = summary.no_viscosity.iter().map(|why| Answer::new("relative viscosity", format!("none: {why}")));
    let drag = summary.accuracy.as_ref().and_then(|accuracy| accuracy.drag);
    let of_accuracy = drag.map(|drag| Answer::new("drag", with_bar(drag.root_mean_square, drag.bar)));
    oscillation
        .chain(of_shear_at_a_stress(summary))
        .chain(of_loaded_wall(summary))
        .chain(viscosity)
        .chain(of_rheometry(summary))
        .chain(without)
        .chain(of_accuracy)
        .chain(of_forces(summary))
        .chain(of_objects(summary))
        .chain(of_velocities(summary))
        .chain(of_flow(summary))
        .chain(of_scalar(summary))
        .collect()
}

fn of_oscillation(oscillation: &OscillationSummary) -> Vec<Answer> {
    let cycles = if oscillation.cycles == 1 { "one cycle".to_owned() } else { format!("{} cycles", oscillation.cycles) };
    let modulus = |Modulus { value, interval }: &Modulus| match interval {
        Some([low, high]) => format!("{} (95 %) over {cycles}", with_bar(*value, 0.5 * (high - low))),
        None => format!("{} over {cycles}", number(*value, 5)),
    };
    let third = oscillation.harmonics.get(2).map_or(String::new(), |third| format!(", third harmonic {:.2} %", 100.0 * third));
    let complex = format!(
        "{} times the fluid's, ahead of the strain by {:.2} degrees{third}",
        number(oscillation.complex_viscosity, 5),
        oscillation.phase
    );
    vec![
        Answer::new("storage modulus", modulus(&oscillation.storage_modulus)),
        Answer::new("loss modulus", modulus(&oscillation.loss_modulus)),
        Answer::new("complex viscosity", complex),
    ]
}

fn of_viscosity(viscosity: &ViscositySummary, in_time: bool) -> Vec<Answer> {
    let mut lines: Vec<Answer> = viscosity.mean.iter().flat_map(of_mean).collect();
    let too_short = viscosity.too_short.as_ref().filter(|_| viscosity.mean.is_none());
    let relative = match viscosity.interval {
        Some([low, high]) => with_bar(viscosity.relative, 0.5 * (high - low)),
        None => fixed(viscosity.relative, DECIMALS),
    };
    let walls = viscosity.from_walls.map_or(String::new(), |walls| format!("   (from the force on the walls: {})", fixed(walls, DECIMALS)));
    let when = if in_time { " at the end" } else { "" };
    lines.push(Answer::new("relative viscosity", format!("{relative}{when}{walls}")));
    lines.extend(split(viscosity.relative, &viscosity.parts.in_words(), DECIMALS).map(|parts| Answer::new("made up of", parts)));
    lines.extend(too_short.map(|short| Answer::new("mean viscosity", short.text())));
    lines
}

fn of_mean(mean: &MeanViscosity) -> Vec<Answer> {
    let [from, to] = mean.strains;
    let value = format!("{} (95 %) from strain {from:.2} to {to:.2}", with_bar(mean.relative, mean.half_width()));
    let parts = split(mean.relative, &mean.parts.in_words(), decimals(mean.half_width())).map(|parts| Answer::new("made up of", parts));
    [Answer::new("mean viscosity", value)].into_iter().chain(parts).collect()
}

/// Names of what a rheometer and a look at contacts tell besides the viscosity, with their columns.
const RHEOMETRY: [(&str, &str); 4] = [
    ("N1", "first_normal_difference"),
    ("N2", "second_normal_difference"),
    ("particle pressure", "particle_pressure"),
    ("contacts of a body", "contact_number"),
];

/// Normal stresses over viscosity of the fluid and shear rate, and contacts, of a sheared suspension: means over the steady part, or what is at the end.
fn of_rheometry(summary: &Summary) -> Vec<Answer> {
    if summary.viscosity.is_some() { of_quantities(summary, &RHEOMETRY) } else { Vec::new() }
}

/// The rate that a stress decides.
fn of_shear_at_a_stress(summary: &Summary) -> Vec<Answer> {
    let decided = summary.flow.as_ref().is_some_and(|flow| flow.drive == "shear-stress");
    if decided { of_quantities(summary, &[("shear rate", "shear_rate")]) } else { Vec::new() }
}

/// What a layer under a given pressure is pressed for.
fn of_loaded_wall(summary: &Summary) -> Vec<Answer> {
    of_quantities(summary, &[("layer friction", "stress_ratio"), ("solid fraction", "solid_fraction")])
}

/// How chains and cells are shaped, and how much inertia bodies have that move.
fn of_objects(summary: &Summary) -> Vec<Answer> {
    let shapes = of_quantities(summary, &[("end-to-end distance", "end_to_end"), ("cell inclination", "inclination")]);
    let moves = |(_, column): &(&str, &str)| {
        summary.quantities.get(*column).and_then(QuantitySummary::representative).is_some_and(|value| value > 0.0)
    };
    let lines: Vec<_> = [("Reynolds number", "reynolds"), ("Stokes number", "stokes")].into_iter().filter(moves).collect();
    let of_fastest = |Answer { name, value }| Answer::new(name, value + " (fastest body)");
    shapes.into_iter().chain(of_quantities(summary, &lines).into_iter().map(of_fastest)).collect()
}

/// Lines of quantities, by their columns: means over the steady part, or what is at the end; none of those that a run does not have.
fn of_quantities(summary: &Summary, lines: &[(&'static str, &str)]) -> Vec<Answer> {
    let when = if summary.steps > 0 { " at the end" } else { "" };
    let line = |&(name, column): &(&'static str, &str)| {
        let quantity = summary.quantities.get(column)?;
        let value = match (&quantity.mean, quantity.last) {
            (Some(SteadyMean { value, interval: [low, high], .. }), _) if low < high => with_bar(*value, 0.5 * (high - low)) + " (95 %)",
            (Some(mean), _) => number(mean.value, 4),
            (None, Some(last)) => number(last, 4) + when,
            (None, None) => return None,
        };
        Some(Answer::new(name, value))
    };
    lines.iter().filter_map(line).collect()
}

/// The sum of parts in words, rounded such that what is written adds up; nothing for a single part.
pub fn split(total: f64, parts: &[(&'static str, f64)], decimals: usize) -> Option<String> {
    let rounded = rounded(total, parts, decimals);
    let mut text = String::new();
    for (place, ((name, _), value)) in parts.iter().zip(&rounded).enumerate() {
        let sign = match (place, *value < 0.0) {
            (0, true) => "\u{2212}",
            (0, false) => "",
            (_, true) => " \u{2212} ",
            (_, false) => " + ",
        };
        text += &format!("{sign}{:.decimals$} {name}", value.abs());
    }
    (parts.len() > 1).then_some(text)
}

/// Parts rounded to the decimals that are written, of which the largest takes up what rounding leaves.
fn rounded(total: f64, parts: &[(&'static str, f64)], decimals: usize) -> Vec<f64> {
    let unit = 10f64.powi(decimals as i32);
    let mut steps: Vec<f64> = parts.iter().map(|(_, value)| (value * unit).round()).collect();
    let left = (total * unit).round() - steps.iter().sum::<f64>();
    let largest = (0..steps.len()).max_by(|&one, &two| steps[one].abs().total_cmp(&steps[two].abs()));
    if let Some(largest) = largest.filter(|_| left.abs() <= parts.len() as f64) {
        steps[largest] += left;
    }
    steps.into_iter().map(|step| step / unit).collect()
}

fn of_forces(summary: &Summary) -> Vec<Answer> {
    let Some(forces) = &summary.forces else { return Vec::new() };
    let (names, of) = match forces.bodies {
        1 => (["force on the body", "torque on the body"], "by the fluid".to_owned()),
        count => (["mean force", "mean torque"], format!("by the fluid on each of {count} bodies with prescribed motion")),
    };
    let torque = |torque: &Vec<f64>| if let [torque] = torque[..] { number(torque, 6) } else { vector(torque) };
    let mut lines = vec![Answer::new(names[0], format!("{}   ({of})", vector(&forces.mean)))];
    lines.extend(forces.mean_torque.as_ref().map(|mean| Answer::new(names[1], format!("{}   ({of})", torque(mean)))));
    lines.extend(of_drag(forces));
    lines
}

fn of_drag(forces: &ForceSummary) -> Option<Answer> {
    let (name, unit) = match forces.mean.len() {
        2 => ("drag coefficient", "= F / (μ U)"),
        _ => ("drag ratio", "times Stokes' drag 6π μ a U"),
    };
    let ratio = number(forces.drag_ratio?, 6);
    Some(Answer::new(name, format!("{ratio} {unit}, U past the body in the mean over the box")))
}

fn of_velocities(summary: &Summary) -> Vec<Answer> {
    // bodies in a shear go with it: their mean says nothing
    let Some(velocities) = summary.velocities.as_ref().filter(|_| summary.viscosity.is_none()) else { return Vec::new() };
    let mut lines = velocities.settling.as_ref().map_or(Vec::new(), of_settling);
    let (name, spread) = match velocities.bodies {
        1 => ("body velocity", String::new()),
        count => ("mean body velocity", format!("   (of {count} free bodies, which fluctuate by {})", number(velocities.fluctuation, 4))),
    };
    lines.push(Answer::new(name, vector(&beyond_rounding(&velocities.mean, velocities.fluctuation)) + &spread));
    lines
}

/// A mean velocity without what is rounding beside the velocities, whose fluctuation this is.
fn beyond_rounding(mean: &[f64], fluctuation: f64) -> Vec<f64> {
    let speed = mean.iter().fold(fluctuation, |speed, component| speed.hypot(*component));
    mean.iter().map(|&component| if component.abs() > AT_REST * speed { component } else { 0.0 }).collect()
}

fn of_settling(settling: &SettlingSummary) -> Vec<Answer> {
    let ratio =
        settling.stokes_ratio.map_or(String::new(), |ratio| format!(", {} of Stokes' velocity of one body alone", number(ratio, 5)));
    let mut lines = Vec::new();
    match (&settling.mean, &settling.too_short) {
        (Some(MeanSpeed { mean, interval: [low, high], times: [from, to] }), _) => {
            let mean = with_bar(*mean, 0.5 * (high - low));
            lines.push(Answer::new("mean settling speed", format!("{mean} (95 %) from time {from:.4} to {to:.4}")));
        }
        (None, Some(short)) => lines.push(Answer::new("mean settling speed", short.text())),
        (None, None) => {}
    }
    let when = if lines.is_empty() { "" } else { " at the end" };
    lines.push(Answer::new("settling speed", format!("{} along gravity{when}{ratio}", number(settling.speed, 6))));
    lines
}

fn of_flow(summary: &Summary) -> Vec<Answer> {
    let Some(flow) = &summary.flow else { return Vec::new() };
    let velocity =
        || vec![Answer::new("mean flow velocity", vector(&flow.mean_velocity)), Answer::new("flow rate", vector(&flow.flow_rate))];
    let gradient = || vec![Answer::new("pressure gradient", vector(&flow.pressure_gradient))];
    match flow.drive {
        "mean-velocity" => [gradient(), velocity()].concat(),
        "pressure-gradient" | "body-force" => [velocity(), gradient()].concat(),
        _ => Vec::new(),
    }
}

fn of_scalar(summary: &Summary) -> Vec<Answer> {
    let Some(scalar) = &summary.scalar else { return Vec::new() };
    let conduction = scalar.conduction.as_ref().map(|conduction| {
        Answer::new(
            "conductivity",
            format!("{:.6} of what is around the inclusions, mean flux {}", conduction.conductivity, vector(&conduction.mean_flux)),
        )
    });
    conduction.into_iter().chain([Answer::new("energy", format!("{:.6}", scalar.energy))]).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_of_velocities_that_cancel_is_zero() {
        assert_eq!(beyond_rounding(&[3e-13, -0.25], 0.5), [0.0, -0.25]);
        assert_eq!(beyond_rounding(&[3e-13, -4e-13], 0.0), [3e-13, -4e-13]);
        assert_eq!(beyond_rounding(&[0.0, 0.0], 0.0), [0.0, 0.0]);
    }

    #[test]
    fn parts_are_written_such_that_they_add_up() {
        let parts = [("flow", 1.333_34), ("lubrication", 0.333_34), ("contacts", -0.111_06)];
        let total = parts.iter().map(|(_, value)| value).sum::<f64>();
        let rounded = rounded(total, &parts, DECIMALS);
        assert!((rounded.iter().sum::<f64>() - (total * 1e4).round() / 1e4).abs() < 1e-12);
        assert_eq!(split(total, &parts, DECIMALS).unwrap(), "1.3334 flow + 0.3333 lubrication \u{2212} 0.1111 contacts");
        assert_eq!(split(1.0, &parts[..1], DECIMALS), None);
    }
}
