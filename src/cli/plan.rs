//! `turbid plan`: what a run would build and what not, and what it would take.

use std::path::Path;

use crate::{
    error::Result,
    output::say,
    petsc::Session,
    plan::{Plan, PlanReport},
    run,
    scene::Scene,
    study::{Calibration, Estimate, Forecast, coarsest},
};

/// Prints the plan of a scene of dimension `D` whose runs write into `folder`, on as many ranks as there are or on so many others.
pub fn plan<const D: usize>(session: &Session, scene: &Scene, folder: &Path, ranks: Option<usize>) -> Result<()> {
    let world = session.world();
    let count = ranks.unwrap_or(world.size());
    let of = |scene: &Scene| world.agree(Plan::<D>::on(world.into(), scene).and_then(|plan| plan.report(count)));
    let time = |scene: &Scene, plan: &PlanReport| time::<D>(session, scene, plan, count);
    let (plan, time) = match scene.accuracy {
        None => {
            let plan = of(scene)?;
            let time = time(scene, &plan)?;
            (plan, time)
        }
        Some(accuracy) => match run::cached(world, folder, scene) {
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
        format!("           only {:.0} MB are free: turbid run asks for --force\n", free / 1e6)
    } else {
        String::new()
    };
    let shared = match ranks {
        Some(count) if plan.bytes().is_finite() => {
            format!("           {:.0} MB on the fullest of {count} ranks\n", (plan.bytes_of_fullest(count) / 1e6).ceil())
        }
        _ => String::new(),
    };
    world.on_first_rank(|| say(&format!("{plan}{shared}{scarce}time       {time}")))
}

/// How a resolution was chosen.
fn chosen(calibration: &Calibration) -> String {
    let Calibration { accuracy, cells_per_radius, estimates, .. } = calibration;
    let error = |estimate: &Estimate| format!("{} {:.1e}", estimate.quantity.word(), estimate.error);
    let errors = estimates.iter().map(error).collect::<Vec<_>>().join(", ");
    format!("{accuracy} asked for: {cells_per_radius} cells per radius and the most modes, calibrated; estimated errors: {errors}")
}

/// What a run is expected to take on so many ranks, of which the plan is.
fn time<const D: usize>(session: &Session, scene: &Scene, plan: &PlanReport, ranks: usize) -> Result<String> {
    if ranks == session.world().size() && plan.bytes() > session.world().available_memory_bytes() {
        return Ok("not predicted: there is not enough memory".into());
    }
    let Some((grid, multipliers)) = plan.unknowns().filter(|_| !scene.scalar()) else {
        return Ok("not predicted: no flow is solved".into());
    };
    let Some(forecast) = Forecast::of::<D>(session, scene, grid, multipliers)? else {
        return Ok("not predicted: no sample of the scene can be solved".into());
    };
    // the sample was solved by the ranks of this program
    let share = session.world().size() as f64 / ranks as f64 * plan.imbalance();
    let (share, if_shared) = match ranks == session.world().size() {
        true => (1.0, String::new()),
        false => (share, format!(" on {ranks} ranks, if each has a core and messages take no time")),
    };
    let [seconds, setup, solve] = [forecast.seconds(), forecast.setup, forecast.solve].map(|seconds| seconds * share);
    let iterations = forecast.iterations;
    Ok(match (forecast.solves, forecast.sampled) {
        (None, _) => {
            format!("about {seconds:.1} s{if_shared}, from a sample: {setup:.1} s of set-up, a solve of about {iterations} iterations")
        }
        (Some(solves), Some(sampled)) if !forecast.even() => format!(
            "about {seconds:.0} s{if_shared}, from a sample and its first {sampled} steps: {solves:.0} solves, of {solve:.1} s for the first, which takes \
             about {iterations} iterations"
        ),
        (Some(solves), Some(sampled)) => format!(
            "about {seconds:.0} s{if_shared}, from the first {sampled} steps of a sample: {solves:.0} steps at the speeds to which these come, of {solve:.2} s \
             each, which take about {iterations} iterations"
        ),
        (Some(solves), None) => format!(
            "about {seconds:.0} s{if_shared}, from a sample: {solves:.0} solves at the speeds of the start, of {solve:.1} s for the first, which takes about \
             {iterations} iterations"
        ),
    })
}
