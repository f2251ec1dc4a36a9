//! The result of a run in a few lines for people.

use super::{
    AccuracySummary, Answer, InertiaSummary, ScalarSummary, Summary, answers, lengths_of_steps, plain,
    summary::{ContactSummary, FrictionSummary, MotionSummary, SolverSummary},
};

use crate::observe::NEAR;

/// Bars of a sparkline, from the lowest to the highest.
const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// Most bars of a sparkline.
const WIDTH: usize = 60;

/// The lines that a run ends with.
pub fn report(summary: &Summary) -> String {
    let bodies = match &summary.scalar {
        Some(scalar) => counted(scalar.inclusions.len(), "inclusion", "inclusions"),
        None => counted(summary.body_count(), "body", "bodies"),
    };
    let mut lines = vec![format!("{bodies}, fraction {:.4}, on {}", summary.fraction, counted(summary.ranks, "rank", "ranks"))];
    lines.extend(answers(summary).into_iter().map(|Answer { name, value }| format!("{name:<20} {value}")));
    lines.extend(summary.accuracy.as_ref().map(accuracy_line));
    lines.extend(summary.scalar.iter().flat_map(scalar_lines));
    if let Some(motion) = &summary.motion {
        lines.extend(motion_lines(summary, motion));
    }
    lines.extend(summary.inertia.as_ref().and_then(InertiaSummary::warning).map(|warning| format!("warning              {warning}")));
    lines.extend(summary.contact.as_ref().map(|contact| contact_line(contact, summary.flow.is_some())));
    lines.extend(
        summary.pairs.as_ref().map(|pairs| format!("coordination         {:.3} neighbours within {NEAR} radii", pairs.coordination)),
    );
    lines.extend(summary.solver.iter().flat_map(|solver| solver_lines(solver, summary.motion.is_none())));
    lines.join("\n")
}

fn motion_lines(summary: &Summary, motion: &MotionSummary) -> Vec<String> {
    let steps = counted(summary.steps, "step", "steps");
    let changed = match (motion.grown, motion.shrunk) {
        (0, 0) => String::new(),
        (grown, shrunk) => format!(", {grown} longer than the one before, {shrunk} shorter"),
    };
    let halved = if motion.halved > 0 { format!("; {} repeated with half the length", motion.halved) } else { String::new() };
    let lengths = format!("of {}{changed}{halved}", lengths_of_steps(motion.steps));
    let mut lines = vec![format!("time                 {} in {steps} {lengths}", plain(summary.time))];
    if motion.solves > 0 {
        let mean = motion.iterations as f64 / motion.solves as f64;
        lines.push(format!("solves               {}, of {mean:.1} iterations on average", motion.solves));
    }
    let named = [motion.assembly_seconds, motion.solve_seconds, motion.contact_seconds, motion.output_seconds];
    let [assembly, flow, contacts, files, rest] = parts_of_seconds(motion.seconds, named);
    lines.push(format!(
        "seconds              {:.2}: {assembly} assembly, {flow} flow, {contacts} contacts, {files} files, {rest} rest",
        motion.seconds
    ));
    lines
}

/// Parts of a time in hundredths of a second, rounded down, and what is left of the whole, so that what is shown adds up.
fn parts_of_seconds(whole: f64, parts: [f64; 4]) -> [String; 5] {
    let hundredths = parts.map(|part| (100.0 * part).floor());
    let rest = ((100.0 * whole).round() - hundredths.iter().sum::<f64>()).max(0.0);
    let [assembly, flow, contacts, files] = hundredths;
    [assembly, flow, contacts, files, rest].map(|hundredths| format!("{:.2}", hundredths / 100.0))
}

/// How the setting was found.
fn accuracy_line(accuracy: &AccuracySummary) -> String {
    let grids = accuracy.calibrated_on.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
    let found = match accuracy.calibration_seconds {
        Some(seconds) => format!("found on grids of {grids} ({seconds:.2} s before the last)"),
        None => format!("found earlier on grids of {grids}"),
    };
    let (asked, cells) = (accuracy.asked, accuracy.cells_per_radius);
    format!("accuracy             {asked} asked for, met with {cells} cells per radius and the most modes that they allow, {found}")
}

fn scalar_lines(scalar: &ScalarSummary) -> Vec<String> {
    let inclusions = &scalar.inclusions;
    let mut lines = Vec::new();
    if let Some(uzawa) = &scalar.uzawa {
        lines.push(format!("Uzawa's step         {:.3e}, diverges above about {:.3e}", uzawa.step, uzawa.bound));
    }
    lines.extend(scalar.warning.iter().map(|warning| format!("warning              {warning}")));
    let (lowest, highest, flux) = inclusions.iter().fold((f64::INFINITY, f64::NEG_INFINITY, 0.0_f64), |(low, high, flux), inclusion| {
        (low.min(inclusion.value), high.max(inclusion.value), flux.max(inclusion.flux.abs()))
    });
    if !inclusions.is_empty() {
        lines.push(format!("values               {lowest:.6} to {highest:.6}, largest net flux {flux:.1e}"));
    }
    lines
}

fn contact_line(contact: &ContactSummary, in_flow: bool) -> String {
    let gap =
        contact.smallest_gap.map_or("no two bodies near each other".into(), |gap| format!("smallest gap of all steps {gap:.1e} radii"));
    let residual = contact.kkt_residual.map_or(String::new(), |residual| format!(", residual {residual:.1e}"));
    let stick = contact.glue.as_ref().map_or(String::new(), |glue| format!(", {} that stick", glue.stuck));
    let friction = contact.friction.as_ref().map_or(String::new(), |friction| friction_part(friction, in_flow));
    format!("contacts             {} that bear a force{stick}, {gap}{residual}{friction}", contact.active)
}

fn friction_part(friction: &FrictionSummary, in_flow: bool) -> String {
    let FrictionSummary { residual, steps_above_tolerance, tolerance } = friction;
    // a flow takes no contact.tolerance
    let (of, or) = match in_flow {
        true => ("", ""),
        false => (" (ten times contact.tolerance)", ", or accept it with a larger contact.tolerance"),
    };
    let warning = match steps_above_tolerance {
        0 => String::new(),
        steps => format!(
            "; warning: in {} friction was found to a residual above {tolerance:.0e}{of}; choose a shorter time.step{or}",
            counted(*steps, "step", "steps")
        ),
    };
    format!("; friction residual {residual:.1e}{warning}")
}

fn solver_lines(solver: &SolverSummary, instant: bool) -> Vec<String> {
    let mut lines = vec![match solver.meshes {
        None => format!("unknowns             {} on the grid, {} multipliers", solver.grid_unknowns, solver.multiplier_unknowns),
        Some(made) => format!("unknowns             {} on the mesh; {} made", solver.grid_unknowns, counted(made, "mesh", "meshes")),
    }];
    if instant {
        lines.push(format!("iterations           {} to a residual of {:.1e}", solver.iterations, solver.residual));
        lines.push(format!(
            "seconds              {:.2} set-up, {:.2} assembly, {:.2} solve ({:.2} {}, {:.2} matrices, {:.2} surfaces, {:.2} Krylov)",
            solver.setup_seconds,
            solver.assembly_seconds,
            solver.solve_seconds,
            solver.inverse_seconds,
            solver.inverse,
            solver.matrix_seconds,
            solver.body_seconds,
            solver.krylov_seconds
        ));
    }
    lines
        .extend(solver.faster.map(|inverse| format!("faster               method.inverse = {inverse:?} suits this box and solves faster")));
    lines.push(format!("peak memory          {:.0} MB", solver.peak_memory_bytes / 1e6));
    lines
}

/// A curve as a line of bars from its lowest to its highest value; nothing for fewer than two finite values.
pub fn sparkline(values: impl Iterator<Item = f64>) -> Option<String> {
    let values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    if values.len() < 2 {
        return None;
    }
    let count = values.len().min(WIDTH);
    let mean = |bar: usize| {
        let part = &values[bar * values.len() / count..(bar + 1) * values.len() / count];
        part.iter().sum::<f64>() / part.len() as f64
    };
    let means: Vec<f64> = (0..count).map(mean).collect();
    let range =
        |values: &[f64]| values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(*value), high.max(*value)));
    let ((lowest, highest), (least, most)) = (range(&means), range(&values));
    let scale = if highest > lowest { (BARS.len() - 1) as f64 / (highest - lowest) } else { 0.0 };
    let line: String = means.iter().map(|mean| BARS[((mean - lowest) * scale).round() as usize]).collect();
    Some(format!("{line}   {least:.4} to {most:.4}"))
}

/// A number and what it counts.
pub(super) fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_of_parts_add_up_to_the_whole() {
        for (whole, parts) in [(1.239, [0.119, 0.349, 0.0, 0.009]), (0.004, [0.001; 4]), (10.0, [2.499; 4])] {
            let shown = parts_of_seconds(whole, parts);
            let sum: f64 = shown.iter().map(|part| part.parse::<f64>().unwrap_or(f64::NAN)).sum();
            assert_eq!(format!("{sum:.2}"), format!("{whole:.2}"), "{shown:?}");
        }
    }

    #[test]
    fn friction_that_was_not_found_names_what_helps() {
        let missed = |steps| FrictionSummary { residual: 2e-8, steps_above_tolerance: steps, tolerance: 1e-8 };
        assert_eq!(friction_part(&missed(0), false), "; friction residual 2.0e-8");
        let dry = friction_part(&missed(193), false);
        assert!(
            dry.ends_with(
                "in 193 steps friction was found to a residual above 1e-8 (ten times contact.tolerance); choose a shorter time.step, or accept it with a \
                 larger contact.tolerance"
            ),
            "{dry}"
        );
        assert!(
            friction_part(&missed(1), true).ends_with("in 1 step friction was found to a residual above 1e-8; choose a shorter time.step")
        );
    }

    #[test]
    fn a_sparkline_shows_the_range_and_needs_two_values() {
        assert_eq!(sparkline([1.0, 2.0].into_iter()).as_deref(), Some("▁█   1.0000 to 2.0000"));
        // a peak is in the range, though the bar that has it shows a mean
        assert!(
            sparkline((0..1000).map(|step| if step == 500 { 9.0 } else { 1.0 })).is_some_and(|line| line.ends_with("1.0000 to 9.0000"))
        );
        assert_eq!(sparkline([1.0, f64::NAN].into_iter()), None);
        assert!(sparkline((0..1000).map(f64::from)).is_some_and(|line| line.chars().count() < 90));
    }
}
