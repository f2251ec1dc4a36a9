//! Steps that lead nowhere, that are stopped, or in which bodies of given motion meet.

use std::{
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use nalgebra::{SVector, Vector2};
use turbid::{
    body::Twist,
    error::{Error, Result},
    geometry::{Axis, Domain},
    interaction::Interactions,
    motion::{
        Effort, Observation, Simulation, StepControl, StepLimits, StepOutcome, StepReport, StepStart, Stepper, StepperView, StopRequest,
    },
    parallel::Peers,
    petsc::Session,
    scene::{Scene, Scheme, Step, TimeSection},
    setup::State,
    system::ResidualMonitor,
};

use crate::Test;

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_step_that_leads_nowhere_is_split_and_the_run_comes_back_to_whole_steps),
        Test::of(an_automatic_step_that_leads_nowhere_is_shortened),
        Test::of(a_step_that_leads_nowhere_at_any_length_ends_the_run),
        Test::of(a_stop_in_the_rounds_of_a_step_leaves_the_run_as_it_was),
        Test::of(bodies_of_given_motion_that_meet_end_a_run_before_they_overlap),
        Test::of(bodies_of_given_motion_meet_images_of_each_other_in_a_sheared_box),
        Test::of(a_body_squeezed_by_given_motions_ends_a_run),
    ]
}

/// A point at a given velocity, of which steps across some times are too long.
struct Hurdles {
    interactions: Interactions<2>,
    control: StepControl,
    /// From, to, and the longest step in between.
    hurdles: Vec<[f64; 3]>,
    /// Whether the step itself fails, and not what is seen before it.
    late: bool,
}

impl Hurdles {
    fn refuse(&self, time: f64, step: f64) -> Result<()> {
        let hurdle = self.hurdles.iter().find(|[from, to, longest]| time < *to && time + step > *from && step > *longest);
        hurdle.map_or(Ok(()), |_| Err(Error::StepTooLong { text: "too long".into(), step }))
    }
}

impl Stepper<2> for Hurdles {
    fn evaluate(&mut self, state: &State<2>, longest: f64, _: ResidualMonitor) -> Result<Observation<2>> {
        let limits = StepLimits { stable: 1.0, accurate: f64::INFINITY, tried: longest };
        let step_size = self.control.next::<2>(Peers::Alone, &[], StepStart { time: state.time, last_step: state.last_step }, limits);
        if !self.late {
            self.refuse(state.time, step_size.natural)?;
        }
        let twists = vec![Twist { velocity: Vector2::x(), ..Twist::zero() }];
        Ok(Observation::of_motions(twists, step_size))
    }

    fn advance(&mut self, state: &State<2>, observation: &Observation<2>, step: f64, _: ResidualMonitor) -> Result<StepOutcome<2>> {
        if self.late {
            self.refuse(state.time, step)?;
        }
        let (moves, effort) = (observation.twists.clone(), Effort::default());
        Ok(StepOutcome {
            step,
            twists: moves.clone(),
            moves,
            contacts: Vec::new(),
            adhesive_contacts: Vec::new(),
            kkt_report: None,
            shear: state.shear,
            wall: None,
            effort,
        })
    }

    fn view(&self) -> StepperView<'_, 2> {
        StepperView { radii: &[0.5], interactions: &self.interactions, twists_now: None, flow: None }
    }

    fn free(&self) -> Vec<bool> {
        vec![true]
    }
}

fn hurdles(session: &Session, step: Step, hurdles: &[[f64; 3]], late: bool) -> Simulation<2> {
    let time = TimeSection { step, end: 2.0, scheme: Scheme::TwoStep, travel: 0.1, error: 1e-3, until: None };
    let control = StepControl { time, shift_period: None, protocol: None, longest: 0.25, by_twos: false };
    let stepper = Hurdles { interactions: Interactions::default(), control: control.clone(), hurdles: hurdles.to_vec(), late };
    let domain = Domain { size: [4.0, 4.0].into(), axes: [Axis::Periodic, Axis::Periodic] };
    let state = State::start(std::iter::once((SVector::repeat(1.0), Twist::zero())));
    Simulation::driven(session, Box::new(stepper), state, domain, control)
}

fn reports(simulation: &mut Simulation<2>) -> Result<Vec<StepReport>> {
    let mut reports = Vec::new();
    while !simulation.over() {
        reports.push(step(simulation)?);
    }
    Ok(reports)
}

fn step<const D: usize>(simulation: &mut Simulation<D>) -> Result<StepReport> {
    let observation = simulation.evaluate(&mut |_, _| {})?;
    simulation.step(&observation, &mut |_, _| {})
}

fn a_step_that_leads_nowhere_is_split_and_the_run_comes_back_to_whole_steps(session: &Session) {
    for late in [false, true] {
        let mut simulation = hurdles(session, Step::Fixed(0.5), &[[0.6, 0.7, 0.13]], late);
        let reports = reports(&mut simulation).unwrap();
        let lengths: Vec<f64> = reports.iter().map(|report| report.length).collect();
        // the hurdle lies within the first quarter of the second step
        assert_eq!(lengths, [0.5, 0.125, 0.125, 0.25, 0.5, 0.5], "late: {late}");
        assert_eq!(reports.iter().map(|report| report.halvings).collect::<Vec<_>>(), [0, 2, 1, 0, 0, 0]);
        assert_eq!((simulation.state().time, simulation.state().bodies[0].center[0]), (2.0, 3.0));
        // a run that goes on from the middle of a split step does the same
        let mut resumed = hurdles(session, Step::Fixed(0.5), &[[0.6, 0.7, 0.13]], late);
        let mut state = simulation.state().clone();
        (state.time, state.last_step, state.steps) = (0.625, 0.125, 2);
        resumed.restore(state, turbid::mechanics::History::default()).unwrap();
        let again: Vec<f64> = self::reports(&mut resumed).unwrap().iter().map(|report| report.length).collect();
        assert_eq!(again, lengths[2..]);
    }
}

fn an_automatic_step_that_leads_nowhere_is_shortened(session: &Session) {
    let reports = reports(&mut hurdles(session, Step::Auto, &[[0.6, 0.7, 0.1]], false)).unwrap();
    assert!(reports.iter().any(|report| report.length == 0.0625 && report.halvings == 2), "{reports:?}");
    assert!((reports.iter().map(|report| report.length).sum::<f64>() - 2.0).abs() < 1e-12);
}

fn a_step_that_leads_nowhere_at_any_length_ends_the_run(session: &Session) {
    for late in [false, true] {
        let mut simulation = hurdles(session, Step::Fixed(0.5), &[[1.0, 1.1, 0.0]], late);
        let error = reports(&mut simulation).unwrap_err();
        assert_eq!((error.to_string().as_str(), error.exit_code()), ("too long; steps down to 7.812e-3 were tried", 1));
        assert_eq!(simulation.state().time, 1.0, "the state is the last good one");
    }
}

fn scene(text: &str) -> Scene {
    Scene::parse("steps", Path::new("."), text, &[]).unwrap()
}

const STOKES: &str = "flow = { model = \"stokes\" }\nresolution = { cells_per_radius = 3 }\nmethod = { inverse = \"transform\" }\n";
const INERTIA: &str =
    "flow = { model = \"navier-stokes\", density = 1.0 }\nresolution = { cells_per_radius = 3 }\nmethod = { inverse = \"transform\" }\n";
const DRY: &str = "flow = { model = \"none\" }\n";

/// Two disks that are pressed together, and meet in the first step: flow and contacts take several rounds to agree.
fn a_stop_in_the_rounds_of_a_step_leaves_the_run_as_it_was(session: &Session) {
    for flow in [STOKES, INERTIA] {
        let scene = scene(&format!(
            "domain = {{ size = [4.0, 4.0], y = \"walls\" }}\n{flow}contact = {{ model = \"inelastic\" }}\ntime = {{ end = 0.6, step = 0.1 }}\n\
             bodies = [{{ centers = [[1.4, 2.0]], radius = 0.5, density = 1.0, force = [9.0, 0.0] }},\n\
             {{ centers = [[2.405, 2.0]], radius = 0.5, density = 1.0, force = [-9.0, 0.0] }}]\n"
        ));
        let mut whole = Simulation::<2>::new(session, &scene).unwrap();
        let mut stopped = Simulation::<2>::new(session, &scene).unwrap();
        let flag = Arc::new(AtomicBool::new(false));
        stopped.heed(StopRequest::of(flag.clone()));
        let mut stops = 0;
        while !whole.over() {
            let solves = whole.evaluate(&mut |_, _| {}).unwrap();
            // a run that is not asked twice
            let mut iterations = 0;
            let found = stopped.evaluate(&mut |_, _| {
                iterations += 1;
                flag.store(true, Ordering::Relaxed);
            });
            flag.store(false, Ordering::Relaxed);
            let observation = match found {
                Ok(observation) => observation,
                Err(Error::Stopped { time, .. }) => {
                    assert!(solves.effort.solves > 1 && iterations < solves.effort.iterations && time == whole.state().time);
                    stops += 1;
                    stopped.evaluate(&mut |_, _| {}).unwrap()
                }
                Err(error) => panic!("{error}"),
            };
            assert_eq!(observation.effort.iterations, solves.effort.iterations);
            whole.step(&solves, &mut |_, _| {}).unwrap();
            stopped.step(&observation, &mut |_, _| {}).unwrap();
            assert_eq!(whole.state(), stopped.state());
        }
        assert!(stops > 0, "no step took more than one round");
    }
}

/// Runs to the error that ends it; gives it with the last state and the smallest gap of the last step.
fn end<const D: usize>(session: &Session, text: &str) -> (String, State<D>, f64) {
    let mut simulation = Simulation::<D>::new(session, &scene(text)).unwrap();
    let mut gap = f64::NAN;
    for _ in 0..40 {
        match step(&mut simulation) {
            Ok(report) => gap = report.kkt_report.map_or(f64::NAN, |report| report.smallest_gap),
            Err(error) => return (error.to_string(), simulation.whole_state().into_owned(), gap),
        }
    }
    panic!("nothing ends {text}");
}

/// Their gap of 1 closes at a speed of 1.7, or on a path `1.6 (3 t^2 - 2 t^3)`; a body at a speed of 1 is .75 from a wall.
fn bodies_of_given_motion_that_meet_end_a_run_before_they_overlap(session: &Session) {
    let films = format!("{STOKES}lubrication = {{ model = \"pairwise\" }}\n");
    let contact = "contact = { model = \"inelastic\" }\n";
    let pair = |motions: [&str; 2]| {
        let body = |x: f64, motion: &str| format!("{{ centers = [[{x}, 2.0]], radius = 0.5, density = 1.0, motion = {motion} }}");
        format!("bodies = [{}, {}]\n", body(1.0, motions[0]), body(3.0, motions[1]))
    };
    let apart = pair(["{ velocity = [0.85, 0.0] }", "{ velocity = [-0.85, 0.0] }"]);
    let along = pair(["{ path = [[0.0, 0.0, 0.0], [1.0, 1.6, 0.0]] }", "\"fixed\""]);
    // fluid that is squeezed out between bodies allows short steps only where it has inertia
    for (flow, step, last) in [(STOKES, 0.0625, 0.5625), (INERTIA, 0.015625, 0.578125), (&films, 0.0625, 0.5625), (DRY, 0.0625, 0.5625)] {
        for (bodies, time) in [(&apart, "at time 0.588"), (&along, "at time 0.584")] {
            let text =
                format!("domain = {{ size = [6.0, 4.0], y = \"walls\" }}\n{flow}{contact}time = {{ end = 2.0, step = {step} }}\n{bodies}");
            let (error, state, gap) = end::<2>(session, &text);
            assert!(error.contains(time) && error.contains("bodies 0 and 1 meet"), "{flow}: {error}");
            assert_eq!(state.time, last);
            let found = 2.0 * ((state.bodies[1].center - state.bodies[0].center).norm() - 1.0);
            assert!(gap > 0.0 && (gap - found).abs() < 1e-12, "{gap} {found}");
        }
    }
    let at_wall = "bodies = [{ centers = [[1.0, 1.25]], radius = 0.5, density = 1.0, motion = { velocity = [0.0, -1.0] } }]\n";
    for flow in [STOKES, DRY] {
        let text = format!("domain = {{ size = [6.0, 4.0], y = \"walls\" }}\n{flow}{contact}time = {{ end = 2.0, step = 0.1 }}\n{at_wall}");
        let (error, state, _) = end::<2>(session, &text);
        assert!(error.contains("at time 0.75") && error.contains("body 0 and the lower wall along y meet"), "{error}");
        assert!((state.time - 0.7).abs() < 1e-12);
    }
    let spheres = "bodies = [{ centers = [[1.0, 2.0, 2.0]], radius = 0.5, density = 1.0, motion = { velocity = [1.0, 0.0, 0.0] } },\n\
                   { centers = [[2.25, 2.0, 2.0]], radius = 0.5, density = 1.0, motion = \"fixed\" }]\n";
    let text = format!("domain = {{ size = [4.0, 4.0, 4.0] }}\n{DRY}{contact}time = {{ end = 2.0, step = 0.1 }}\n{spheres}");
    assert!(end::<3>(session, &text).0.contains("at time 0.25"));
}

fn bodies_of_given_motion_meet_images_of_each_other_in_a_sheared_box(session: &Session) {
    let text = "domain = { size = [4.0, 4.0] }\nflow = { model = \"stokes\", drive = { shear_rate = 1.0, periodic = \"sheared\" } }\n\
                resolution = { cells_per_radius = 3 }\ncontact = { model = \"inelastic\" }\ntime = { end = 2.0, step = 0.08 }\n\
                bodies = [{ centers = [[1.0, 0.3], [3.0, 3.7]], radius = 0.5, motion = \"fixed\" }]\n";
    let (error, state, _) = end::<2>(session, text);
    assert!(error.contains("bodies 0 and 1 meet"), "{error}");
    // the image above is at x = 1 + 4 t and .6 higher: it touches after 1.2 / 4
    assert!(error.contains("at time 0.3") && state.time < 0.3, "{error} {}", state.time);
}

/// Steps are halved as long as that leaves room, and no further than to a 64th.
fn a_body_squeezed_by_given_motions_ends_a_run(session: &Session) {
    let bodies = "bodies = [{ centers = [[1.0, 2.0]], radius = 0.5, density = 1.0, motion = { velocity = [0.5, 0.0] } },\n\
                  { centers = [[2.13, 2.0]], radius = 0.5, density = 1.0 },\n\
                  { centers = [[3.26, 2.0]], radius = 0.5, density = 1.0, motion = { velocity = [-0.5, 0.0] } }]\n";
    for flow in [STOKES, INERTIA, DRY] {
        let text = format!(
            "domain = {{ size = [6.0, 4.0], y = \"walls\" }}\n{flow}contact = {{ model = \"inelastic\" }}\ntime = {{ end = 2.0, step = 0.1 }}\n{bodies}"
        );
        let (error, state, _) = end::<2>(session, &text);
        assert!(error.contains("at time") && error.contains("(0, 1, 2)") && error.contains("prescribed motions (0, 2)"), "{flow}: {error}");
        let gap = |one: usize, other: usize| (state.bodies[one].center - state.bodies[other].center).norm() - 1.0;
        assert!(gap(0, 1) > -1e-6 && gap(1, 2) > -1e-6);
    }
}
