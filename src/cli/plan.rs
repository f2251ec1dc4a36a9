//! `turbid plan`: what a run would build and what not, and what it would take.

use std::path::Path;

use crate::{
    error::Result,
    output::{duration, say},
    parallel::{memory_in_words, process_seconds},
    petsc::Session,
    plan::{Forecast, Plan, PlanReport},
    run::{self, Calibration, Estimate, Trial, coarsest},
    scene::Scene,
};

/// Prints the plan of a scene of dimension `D` whose runs write into `folder`, on as many ranks as there are or on so many others.
pub fn plan<const D: usize>(session: &Session, scene: &Scene, folder: &Path, ranks: Option<usize>) -> Result<()> {
    let world = session.world();
    let (count, begun) = (ranks.unwrap_or(world.size()), world.max(process_seconds()));
    let of = |scene: &Scene| world.agree(Plan::<D>::on(world.into(), scene).and_then(|plan| plan.report(count)));
    let time = |scene: &Scene, plan: &PlanReport| time::<D>(session, scene, plan, (count, begun));
    let (plan, time) = match scene.accuracy {
        None => {
            let plan = of(scene)?;
            let time = time(scene, &plan)?;
            (plan, time)
        }
        Some(accuracy) => match run::cached(world, folder, scene, false) {
            Some(calibration) => {
                let resolved = calibration.resolved(scene);
                let plan = of(&resolved)?.with_choice(chosen(&calibration));
                let time = time(&resolved, &plan)?;
                (plan, time)
            }
            None => {
                let choice =
                    format!("{accuracy} asked for: turbid run calibrates the resolution at its start and keeps it in its output folder");
                (of(&coarsest(scene))?.undecided(choice), "known once the resolution is".to_owned())
            }
        },
    };
    let free = world.available_memory_bytes();
    let scarce = if ranks.is_none() && plan.bytes() > free {
        format!("           only {} are free: turbid run asks for --force\n", memory_in_words(free))
    } else {
        String::new()
    };
    let shared = match ranks {
        Some(count) if plan.bytes().is_finite() => {
            format!("           {} on the fullest of {count} ranks\n", memory_in_words(plan.bytes_of_fullest(count)))
        }
        _ => String::new(),
    };
    let warning = scene.warning().map_or(String::new(), |warning| format!("warning    {warning}\n"));
    world.on_first_rank(|| say(&format!("{plan}{shared}{scarce}{warning}time       {time}")))
}

/// Unknowns of the grid up to which the first steps of the scene itself are taken.
const TRIED_UNKNOWNS: usize = 1_000_000;

/// How a resolution was chosen.
fn chosen(calibration: &Calibration) -> String {
    let Calibration { accuracy, cells_per_radius, estimates, .. } = calibration;
    let error = |estimate: &Estimate| format!("{} {:.1e}", estimate.quantity.word(), estimate.error);
    let errors = estimates.iter().map(error).collect::<Vec<_>>().join(", ");
    format!("{accuracy} asked for: {cells_per_radius} cells per radius and the most modes, calibrated; estimated errors: {errors}")
}

/// What a run is expected to take on so many ranks, of which the plan is; the program has taken some seconds until it began.
fn time<const D: usize>(session: &Session, scene: &Scene, plan: &PlanReport, (ranks, begun): (usize, f64)) -> Result<String> {
    if ranks == session.world().size() && plan.bytes() > session.world().available_memory_bytes() {
        return Ok("not predicted: there is not enough memory".into());
    }
    if plan.unknowns().is_none_or(|(grid, _)| grid <= TRIED_UNKNOWNS) {
        return Ok(match Trial::of::<D>(session, &Scene { accuracy: None, ..scene.clone() })? {
            Ok(trial) => tried(session, Trial { start: begun + trial.start, ..trial }, plan, ranks),
            Err(reason) => format!("not predicted: a run ends in its first steps: {reason}"),
        });
    }
    let Some((grid, multipliers)) = plan.unknowns().filter(|_| !scene.scalar()) else {
        return Ok("not predicted: no flow is solved".into());
    };
    let Some(forecast) = Forecast::of::<D>(session, scene, grid, multipliers)? else {
        return Ok("not predicted: no sample of the scene can be solved".into());
    };
    let (share, if_shared) = shared(session, plan, ranks);
    let [seconds, setup, solve, further] =
        [forecast.seconds(), forecast.setup, forecast.solve, forecast.of_further()].map(|seconds| brief(seconds * share));
    let iterations = forecast.iterations;
    Ok(match (forecast.solves, forecast.sampled) {
        (None, _) => {
            format!("about {seconds}{if_shared}, from a sample: {setup} of set-up, a solve of about {iterations} iterations")
        }
        (Some(solves), Some(sampled)) if !forecast.even() => format!(
            "about {seconds}{if_shared}, from a sample and its first {sampled} steps: {solves:.0} solves, {solve} for the first, which takes \
             about {iterations} iterations, and {further} for each further one"
        ),
        (Some(solves), Some(sampled)) => format!(
            "about {seconds}{if_shared}, from the first {sampled} steps of a sample: {solves:.0} steps at the speeds to which these come, of {solve} \
             each, which take about {iterations} iterations"
        ),
        (Some(solves), None) => format!(
            "about {seconds}{if_shared}, from a sample: {solves:.0} solves at the speeds of the start, {solve} for the first, which takes about \
             {iterations} iterations, and {further} for each further one"
        ),
    })
}

/// A length of time with two digits also where it is short.
fn brief(seconds: f64) -> String {
    match seconds {
        short if short < 0.01 => format!("{short:.4} s"),
        short if short < 1.0 => format!("{short:.2} s"),
        long => duration(long),
    }
}

/// What the seconds that this program's ranks take are to be multiplied with on so many ranks, and how that is said.
fn shared(session: &Session, plan: &PlanReport, ranks: usize) -> (f64, String) {
    match ranks == session.world().size() {
        true => (1.0, String::new()),
        false => (
            session.world().size() as f64 / ranks as f64 * plan.imbalance(),
            format!(" on {ranks} ranks, if each has a core and messages take no time"),
        ),
    }
}

/// What a run is expected to take whose first steps were taken.
fn tried(session: &Session, trial: Trial, plan: &PlanReport, ranks: usize) -> String {
    let (share, if_shared) = shared(session, plan, ranks);
    let [total, start, step] = [trial.total(), trial.start, trial.step].map(|seconds| brief(seconds * share));
    match trial.taken {
        0 => format!("about {total}{if_shared}, as a run of it has taken"),
        taken => format!(
            "about {total}{if_shared}, from its first {taken} steps: {:.0} steps at the speeds to which these come, of {step} each, after {start}",
            taken as f64 + trial.left.ceil()
        ),
    }
}
