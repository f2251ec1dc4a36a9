//! What stops a projection, in words and as a problem that can be solved again elsewhere.

use nalgebra::SVector;
use serde_json::{Value, json};

use super::{
    Contact, KktReport, Partner, Problem,
    island::squeezed,
    paths::{Motions, swept_balls},
    solver::Outcome,
};
use crate::{
    error::{Error, Result},
    parallel::Peers,
};

/// Largest weight over the smallest: beyond it what is between is rounding.
const LARGEST_RATIO: f64 = 1e12;

/// Part of a step that would help bodies which do not touch yet.
const SHORT: f64 = 1e-3;

/// Bodies that a message names at most.
const NAMED: usize = 5;

/// Bodies that a look at all paths may visit, in all, or for each body where that is more: a quarter of them are pairs, which take some 200 bytes each.
const MOST_VISITS: f64 = 2e7;
const MOST_VISITS_OF_A_BODY: f64 = 100.0;

/// Refuses weights and steps that are not positive, and velocities that are not finite. Collective: the same on all ranks.
///
/// # Panics
/// If lengths differ.
pub(super) fn check<const D: usize>(peers: Peers, problem: &Problem<D>) -> Result<()> {
    let count = problem.balls.len();
    assert!(problem.weights.len() == count && problem.velocities.len() == count, "each ball has a weight and a velocity");
    peers.agree(check_bodies(problem))?;
    let ratio = weight_ratio(peers, problem);
    if ratio > LARGEST_RATIO {
        let text = format!(
            "bodies weigh {ratio:.1e} times as much as others, and forces are found up to {LARGEST_RATIO:e}; choose nearer densities"
        );
        return peers.agree(Err(error(problem, &[], &[], text)));
    }
    Ok(())
}

/// Refuses motions with which too many bodies may meet. Collective: the same on all ranks.
pub(super) fn check_ways<const D: usize>(peers: Peers, problem: &Problem<D>, motions: &Motions<D>) -> Result<()> {
    let [visits, bodies] = visits(peers, problem, motions);
    if visits <= MOST_VISITS.max(MOST_VISITS_OF_A_BODY * bodies) { Ok(()) } else { too_far(peers, problem, motions) }
}

fn check_bodies<const D: usize>(problem: &Problem<D>) -> Result<()> {
    if !(problem.step > 0.0 && problem.step.is_finite()) {
        let text = format!("a step of {} is none; try weaker forces or a fixed time.step", problem.step);
        return Err(error(problem, &[], &[], text));
    }
    // the weight of what no contact can move is infinite
    if let Some(body) = problem.weights.iter().position(|weight| weight.is_nan() || *weight <= 0.0) {
        let text = format!("body {} weighs {}; change its density or radius", problem.number(body), problem.weights[body]);
        return Err(error(problem, &[body], &[], text));
    }
    if let Some(body) = (0..problem.balls.len()).find(|&body| !displacement(problem, problem.velocities, body).is_finite()) {
        let text = format!("body {} has a velocity that is not finite; try a smaller time.step", problem.number(body));
        return Err(error(problem, &[body], &[], text));
    }
    Ok(())
}

/// How far a body moves in the step with these velocities.
fn displacement<const D: usize>(problem: &Problem<D>, velocities: &[SVector<f64, D>], body: usize) -> f64 {
    (velocities[body] * problem.step).norm()
}

/// The error of bodies that move so far that all may meet all, told by the rank of the farthest.
fn too_far<const D: usize>(peers: Peers, problem: &Problem<D>, motions: &Motions<D>) -> Result<()> {
    let way = |body: usize| displacement(problem, motions.velocities, body);
    let farthest = (0..problem.balls.len()).map(way).fold(0.0, f64::max);
    let all = peers.max(farthest);
    let body = (0..problem.balls.len()).find(|&body| way(body) == all);
    peers.agree(body.map_or(Ok(()), |body| {
        let radii = all / problem.balls[body].radius;
        let text = format!("body {} moves by {radii:.3e} of its radius in one step; try a smaller time.step", problem.number(body));
        Err(step_error(problem, &[body], &[], text))
    }))
}

/// About how many bodies are visited to find all pairs of paths, and how many there are.
fn visits<const D: usize>(peers: Peers, problem: &Problem<D>, motions: &Motions<D>) -> [f64; 2] {
    let along = |axis: usize, radius: f64| {
        let boxes = 4.0 * radius / problem.domain.size[axis];
        if problem.domain.periodic(axis) { boxes } else { boxes.min(1.0) }
    };
    let share = |radius: f64| (0..D).map(|axis| along(axis, radius)).product::<f64>();
    let mut sums = [swept_balls(problem, motions, 0.0).iter().map(|ball| share(ball.radius)).sum(), problem.balls.len() as f64];
    peers.sum(&mut sums);
    [sums[0] * sums[1], sums[1]]
}

/// The error of an island that was not solved.
pub(super) fn failure<const D: usize>(problem: &Problem<D>, contacts: &[Contact<D>], outcome: &Outcome) -> Error {
    let both = contacts.iter().flat_map(|contact| [Some(contact.body), contact.other()]);
    let is_ball = |body: &usize| problem.wall.is_none_or(|wall| *body != wall.place);
    let mut bodies: Vec<usize> = both.flatten().filter(is_ball).collect();
    bodies.sort_unstable();
    bodies.dedup();
    let given: Vec<usize> = bodies.iter().copied().filter(|&body| !problem.gives_way(body)).collect();
    let what = match outcome {
        Outcome::Infeasible if given.is_empty() => {
            let jammed = squeezed(problem, contacts, SHORT * problem.step);
            let remedy = if jammed {
                ", however short the step: they are jammed; place fewer of them, or end before"
            } else {
                "; try a smaller time.step"
            };
            format!("bodies are squeezed with no way out{remedy}")
        }
        Outcome::Infeasible => {
            let motion = if given.len() == 1 { "motion" } else { "motions" };
            format!(
                "bodies are squeezed with no way out by prescribed {motion} ({}); change the {motion}, or end before",
                named(problem, &given)
            )
        }
        _ => "the solver stopped before the forces were found; try a smaller time.step".to_owned(),
    };
    let (count, pairs) = (bodies.len(), contacts.len());
    let text = format!("contact of {count} bodies ({}) at {pairs} places failed: {what}", named(problem, &bodies));
    step_error(problem, &bodies, contacts, text)
}

/// The numbers of the first few of some bodies.
fn named<const D: usize>(problem: &Problem<D>, bodies: &[usize]) -> String {
    let named: Vec<String> = bodies.iter().take(NAMED).map(|&body| problem.number(body).to_string()).collect();
    named.join(", ") + if bodies.len() > NAMED { ", .." } else { "" }
}

/// The error of a problem to which contacts were added again and again.
pub(super) fn endless<const D: usize>(problem: &Problem<D>, rounds: usize, contacts: usize) -> Error {
    let text = format!("new contacts appear after {rounds} rounds with {contacts} contacts; try a smaller time.step");
    step_error(problem, &(0..problem.balls.len()).collect::<Vec<_>>(), &[], text)
}

/// The largest weight of a body that gives way over the smallest.
fn weight_ratio<const D: usize>(peers: Peers, problem: &Problem<D>) -> f64 {
    let (least, most) = problem
        .weights
        .iter()
        .filter(|weight| weight.is_finite())
        .fold((f64::INFINITY, 0.0_f64), |(least, most), &weight| (least.min(weight), most.max(weight)));
    peers.max(most) / peers.min(least)
}

/// The error of forces that do not keep bodies apart.
pub(super) fn unkept<const D: usize>(peers: Peers, problem: &Problem<D>, found: &KktReport) -> Error {
    let (residual, contacts, ratio) = (found.kkt_residual, found.pairs, weight_ratio(peers, problem));
    let text = format!(
        "the forces found at {contacts} contacts leave a residual of {residual:.1e} radii, between bodies whose weights differ by a factor \
         of {ratio:.1e}; try densities nearer to each other or a smaller time.step"
    );
    step_error(problem, &(0..problem.balls.len()).collect::<Vec<_>>(), &[], text)
}

/// The error of a step that a shorter one may do without.
fn step_error<const D: usize>(problem: &Problem<D>, bodies: &[usize], contacts: &[Contact<D>], text: String) -> Error {
    Error::Contact { text, island: island(problem, bodies, contacts), step: Some(problem.step) }
}

fn error<const D: usize>(problem: &Problem<D>, bodies: &[usize], contacts: &[Contact<D>], text: String) -> Error {
    Error::Contact { text, island: island(problem, bodies, contacts), step: None }
}

/// A problem as JSON, to solve it again.
fn island<const D: usize>(problem: &Problem<D>, bodies: &[usize], contacts: &[Contact<D>]) -> String {
    let Problem { domain, balls, weights, velocities, step, .. } = *problem;
    let body = |&body: &usize| {
        let (ball, velocity) = (&balls[body], velocities[body].as_slice());
        // an infinite weight becomes null
        json!({ "index": problem.number(body), "radius": ball.radius, "center": ball.center.as_slice(), "wanted": velocity, "weight": weights[body] })
    };
    let touches =
        |contact: &Contact<D>| touch(&problem.wall.map_or(*contact, |wall| wall.of_box(*contact)).renamed(|body| problem.number(body)));
    let periodic: Vec<bool> = (0..D).map(|axis| domain.periodic(axis)).collect();
    json!({
        "size": domain.size.as_slice(),
        "periodic": periodic,
        "shift": domain.slide().map(|slide| slide.shift()),
        "step": step,
        "bodies": bodies.iter().map(body).collect::<Vec<_>>(),
        "contacts": contacts.iter().map(touches).collect::<Vec<_>>(),
    })
    .to_string()
}

fn touch<const D: usize>(contact: &Contact<D>) -> Value {
    let partner = match contact.partner {
        Partner::Body(other) => json!({ "body": other }),
        Partner::Wall { axis, upper } => json!({ "axis": axis, "upper": upper }),
    };
    let (image, normal) = (&contact.image[..], contact.normal.as_slice());
    json!({ "body": contact.body, "partner": partner, "image": image, "normal": normal, "gap": contact.gap })
}
