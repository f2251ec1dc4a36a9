//! Runs in two halves whose shear changes with time: the second one goes on as if there had been no end between.

use nalgebra::SVector;
use turbid::{
    petsc::Session,
    run::{Options, Run, RunFolder},
    scene::Scene,
};

use crate::{
    Test,
    objects::{begin, clear, folder, scene},
};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(the_only_step_after_a_jump_of_the_rate_may_be_cut_short),
        Test::of(a_run_that_ends_within_its_first_step_goes_on_as_if_it_had_not),
        Test::of(a_resumed_run_solves_as_exactly_as_the_rate_of_the_instant_asks),
        Test::of(what_follows_a_step_that_the_end_cuts_short_is_not_kept),
    ]
}

const JUMPS: &str = "[{ until = 0.33, rate = 1.0 }, { until = 0.7, rate = -1.5 }, { rate = 0.4 }]";

/// Disks in a box that is sheared at a rate, in such steps.
fn sheared(rate: &str, step: &str, end: f64) -> Scene {
    scene(&format!(
        "domain.size = [6.0, 6.0]\nflow.drive = {{ shear_rate = {rate}, periodic = \"sheared\" }}\nresolution.cells_per_radius = 4\n\
         bodies = [{{ radius = 1.0, centers = [[1.5, 1.2], [4.1, 1.5], [2.5, 4.2]] }}]\ncontact.model = \"inelastic\"\n\
         time = {{ end = {end}, step = {step} }}\noutput = {{ picture = false, report = false }}\n"
    ))
}

/// The time, the bodies and the viscosity at the end of a run.
fn completed(mut run: Run<2>) -> (f64, Vec<SVector<f64, 2>>, f64) {
    while run.advance().unwrap() {}
    let state = run.state().unwrap();
    let end = (state.time, state.centers(), run.viscosity().map_or(f64::NAN, |viscosity| viscosity.relative()));
    run.finish().unwrap();
    end
}

/// How far a run that is split ends from one that is not, in radii and in the viscosity.
fn missed(session: &Session, rate: &str, step: &str, [split, end]: [f64; 2]) -> f64 {
    let paths = ["whole", "half"].map(|name| folder(session, name));
    let whole = completed(begin::<2>(session, &sheared(rate, step, end), &paths[0]));
    completed(begin::<2>(session, &sheared(rate, step, split), &paths[1]));
    session.world().barrier();
    let mut folder = RunFolder::to_resume(session.world(), &paths[1]).unwrap();
    let (scene, checkpoint) = folder.read(&[format!("time.end={end}")]).unwrap();
    let halves = completed(Run::<2>::resume(session, &scene, folder, &checkpoint, Options::default()).unwrap());
    paths.iter().for_each(|path| clear(session, path));
    assert_eq!(whole.0, halves.0);
    let farthest = whole.1.iter().zip(&halves.1).map(|(one, other)| (one - other).norm()).fold(0.0, f64::max);
    farthest.max((whole.2 - halves.2).abs())
}

/// The step from 0.7 on would be longer than all since the jump before.
fn the_only_step_after_a_jump_of_the_rate_may_be_cut_short(session: &Session) {
    for split in [0.79, 0.8, 0.81] {
        let missed = missed(session, JUMPS, "\"auto\"", [split, 0.9]);
        assert!(missed < 1e-10, "{split}: {missed:e}");
    }
}

/// The first step to be kept was the short one.
fn a_run_that_ends_within_its_first_step_goes_on_as_if_it_had_not(session: &Session) {
    for split in [0.005, 0.02] {
        let missed = missed(session, "1.0", "\"auto\"", [split, 0.3]);
        assert!(missed < 1e-10, "{split}: {missed:e}");
    }
}

/// The rate at the start is five times that at the split.
fn a_resumed_run_solves_as_exactly_as_the_rate_of_the_instant_asks(session: &Session) {
    let missed = missed(session, "{ amplitude = 0.4, frequency = 1.0 }", "0.02", [0.22, 0.24]);
    assert!(missed < 1e-10, "{missed:e}");
}

/// Steps are rounded to whole cells, of which the way to the end has one and the natural step two.
fn what_follows_a_step_that_the_end_cuts_short_is_not_kept(session: &Session) {
    for split in [0.45, 0.47, 0.48] {
        let missed = missed(session, JUMPS, "\"auto\"", [split, 0.6]);
        assert!(missed < 1e-10, "{split}: {missed:e}");
    }
}
