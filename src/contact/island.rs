//! Islands: bodies that push each other, whose velocities are one problem apart from all others.

use clarabel::algebra::CscMatrix;
use nalgebra::SVector;

use super::{
    Contact, Problem, Solver, View,
    loaded_wall::carrier,
    solver::{
        Outcome,
        clarabel::solve_by_clarabel,
        lower_bounds::solve_above,
        program::{Answer, Program},
        sharing::Sharing,
    },
};
use crate::{linalg::dot, parallel::Peers, petsc::Session};

/// Smallest violation, in radii, that the unknowns are scaled by: impossible constraints by rounding are none.
const SMALLEST_SCALE: f64 = 1e-6;

/// Bodies in a row that has hardly a bend would get out of the way only by moves so many times as long as their overlap: they are squeezed.
const FAR: f64 = 1e3;

/// The body of a contact that gives way, the first if both do.
pub(crate) fn free_body<const D: usize>(problem: &Problem<D>, contact: &Contact<D>) -> usize {
    contact.other().filter(|_| !problem.gives_way(contact.body)).unwrap_or(contact.body)
}

/// The forces at the contacts of one island, from a guess.
pub(crate) fn solve_island<const D: usize>(problem: &Problem<D>, contacts: &[Contact<D>], guess: &[f64]) -> Outcome {
    solve_by(problem, contacts, guess, &[Solver::Sparse, Solver::General])
}

/// The same by given methods, each of which is tried if those before it fail.
pub(crate) fn solve_by<const D: usize>(problem: &Problem<D>, contacts: &[Contact<D>], guess: &[f64], solvers: &[Solver]) -> Outcome {
    let unit = Unit::new(problem, contacts);
    if unit.violation <= 0.0 {
        return Outcome::Solved { forces: vec![0.0; contacts.len()], iterations: 0, solver: Solver::Formula };
    }
    if let [contact] = contacts {
        let force = -problem.gap_after(contact, problem.velocities) / (problem.mobility(contact) * problem.step);
        return Outcome::Solved { forces: vec![force.max(problem.lower_bound(contact))], iterations: 0, solver: Solver::Formula };
    }
    let bodies = free_bodies(problem, contacts);
    match solve_program(problem, contacts, guess, &unit, program(problem, contacts, &bodies, &unit), solvers) {
        Outcome::NotConverged if squeezed(problem, contacts, problem.step) => Outcome::Infeasible,
        outcome => outcome,
    }
}

/// Whether all velocities that let nothing overlap in a step of this length move bodies [`FAR`] as far as they would overlap, or there are none.
///
/// Weights and velocities wanted have no part in that, and multipliers `z` prove it without being a solution: where `A x + c >= 0`,
/// `|x| >= -c.z / |A^T z|`.
pub(crate) fn squeezed<const D: usize>(problem: &Problem<D>, contacts: &[Contact<D>], step: f64) -> bool {
    let weights: Vec<f64> = problem.weights.iter().map(|weight| if weight.is_finite() { 1.0 } else { f64::INFINITY }).collect();
    let given = |(body, velocity): (usize, &SVector<f64, D>)| if problem.gives_way(body) { SVector::zeros() } else { *velocity };
    let velocities: Vec<SVector<f64, D>> = problem.velocities.iter().enumerate().map(given).collect();
    let alike = Problem { weights: &weights, velocities: &velocities, step, ..*problem };
    let unit = Unit::new(&alike, contacts);
    if unit.violation <= 0.0 {
        return false;
    }
    let program = program(&alike, contacts, &free_bodies(&alike, contacts), &unit);
    let Some(Answer { multipliers, .. }) = solve_by_clarabel(&program) else { return false };
    let mut unknowns = vec![0.0; program.transposed.m];
    let multipliers: Vec<f64> = multipliers.iter().map(|multiplier| multiplier.max(0.0)).collect();
    program.apply_transpose(&multipliers, &mut unknowns);
    -program.dot(&program.offsets, &multipliers) > FAR * dot(&unknowns, &unknowns).sqrt()
}

/// The forces at the contacts of an island that all ranks solve together, from a guess. Collective: each rank gives the contacts of
/// its own bodies that give way, with the same guess as others for those that it shares with them.
pub(crate) fn solve_together<const D: usize>(
    session: &Session,
    view: &View<D>,
    problem: &Problem<D>,
    contacts: &[Contact<D>],
    guess: &[f64],
) -> Outcome {
    let unit = Unit::new(problem, contacts).over(session.world().into());
    if unit.violation <= 0.0 {
        return Outcome::Solved { forces: vec![0.0; contacts.len()], iterations: 0, solver: Solver::Formula };
    }
    let bodies = free_bodies(problem, contacts);
    let answered = contacts.iter().map(|contact| view.answers(contact.identity())).collect();
    let sharing = Sharing::new(session, &view.halo, &bodies, answered);
    let program = Program { sharing: Some(&sharing), ..program(problem, contacts, &bodies, &unit) };
    solve_program(problem, contacts, guess, &unit, program, &[Solver::Distributed])
}

fn solve_program<const D: usize>(
    problem: &Problem<D>,
    contacts: &[Contact<D>],
    guess: &[f64],
    unit: &Unit,
    program: Program,
    solvers: &[Solver],
) -> Outcome {
    let in_units = |force: f64, contact: &Contact<D>| force / unit.force(problem, contact);
    let guess: Vec<f64> = contacts.iter().zip(guess).map(|(contact, &force)| in_units(force, contact)).collect();
    let lower_bounds: Vec<f64> = contacts.iter().map(|contact| in_units(problem.lower_bound(contact), contact)).collect();
    match solve_above(program, &lower_bounds, &guess, solvers) {
        Ok((Answer { multipliers, iterations, .. }, solver)) => {
            let forces = contacts.iter().zip(multipliers).map(|(contact, multiplier)| multiplier * unit.force(problem, contact)).collect();
            Outcome::Solved { forces, iterations, solver }
        }
        Err(outcome) => outcome,
    }
}

/// The unit of a gap times the root of a weight.
struct Unit {
    /// The largest violation by the velocities wanted; of contacts that may pull also the largest gap.
    violation: f64,
    /// The unit: that violation, but not too small a part of a radius.
    scale: f64,
}

impl Unit {
    fn new<const D: usize>(problem: &Problem<D>, contacts: &[Contact<D>]) -> Self {
        let (mut violation, mut scale) = (0.0f64, 0.0f64);
        for contact in contacts {
            let root = problem.mobility(contact).sqrt();
            let gap = problem.gap_after(contact, problem.velocities) / root;
            violation = violation.max(if problem.lower_bound(contact) < 0.0 { gap.abs() } else { -gap });
            scale = scale.max(SMALLEST_SCALE * contact.smaller_radius(problem.balls) / root);
        }
        Self { violation, scale: scale.max(violation) }
    }

    /// The unit of the contacts of all ranks.
    fn over(self, peers: Peers) -> Self {
        Self { violation: peers.max(self.violation), scale: peers.max(self.scale) }
    }

    /// The force of a multiplier of one.
    fn force<const D: usize>(&self, problem: &Problem<D>, contact: &Contact<D>) -> f64 {
        self.scale / (problem.mobility(contact).sqrt() * problem.step)
    }
}

/// The program whose unknowns are the changes of `velocity dt sqrt(weight)`.
fn program<const D: usize>(problem: &Problem<D>, contacts: &[Contact<D>], bodies: &[usize], unit: &Unit) -> Program<'static> {
    let (mut starts, mut rows, mut values, mut offsets) = (vec![0], Vec::new(), Vec::new(), Vec::new());
    for contact in contacts {
        let root = problem.mobility(contact).sqrt();
        let mut push = |(body, direction): (usize, SVector<f64, D>)| {
            let direction = problem.wall.map_or(direction, |wall| wall.along(body, direction));
            if let Ok(place) = bodies.binary_search(&carrier(problem.wall, body)) {
                rows.extend(place * D..(place + 1) * D);
                values.extend(direction.iter().map(|component| component / (problem.weights[body].sqrt() * root)));
            }
        };
        let (own, other) = ((contact.body, -contact.normal), contact.other().map(|other| (other, contact.normal)));
        // the body has the smaller index, unless a wall carries it, so that rows are sorted
        if carrier(problem.wall, own.0) == own.0 {
            push(own);
            other.into_iter().for_each(push);
        } else {
            other.into_iter().for_each(&mut push);
            push(own);
        }
        starts.push(rows.len());
        offsets.push(problem.gap_after(contact, problem.velocities) / (root * unit.scale));
    }
    Program { transposed: CscMatrix::new(bodies.len() * D, contacts.len(), starts, rows, values), width: D, offsets, sharing: None }
}

/// Bodies of contacts that give way, in order.
fn free_bodies<const D: usize>(problem: &Problem<D>, contacts: &[Contact<D>]) -> Vec<usize> {
    let both = contacts.iter().flat_map(|contact| [Some(contact.body), contact.other()]);
    let mut bodies: Vec<usize> = both.flatten().filter(|&body| problem.gives_way(body)).map(|body| carrier(problem.wall, body)).collect();
    bodies.sort_unstable();
    bodies.dedup();
    bodies
}
