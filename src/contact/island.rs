//! Islands: bodies that push each other, whose velocities are one problem apart from all others.

use clarabel::algebra::CscMatrix;
use nalgebra::SVector;

use super::{Contact, Problem, active::polish, groups::Groups, interior::interior_point, program::Program, pulling::solve_above};

/// Smallest violation, in radii, that the unknowns are scaled by: impossible constraints by rounding are none.
const SMALLEST_SCALE: f64 = 1e-6;
/// Overlap left over, in the scale of the largest violation, and work of the forces on open gaps, as a part of all their
/// work, up to which a solution is one. A contact that is about to press may have a little of both, gap and force.
const TOLERANCE: f64 = 1e-7;

/// How an island was solved.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Outcome {
    /// By forces, one for each contact, in so many iterations.
    Solved {
        /// The forces.
        forces: Vec<f64>,
        /// Iterations of the interior-point method.
        iterations: usize,
    },
    /// Not at all: no velocities let nothing overlap.
    Squeezed,
    /// Not at all: the solver gave up.
    Stalled,
}

/// The contacts of each island, as places in `contacts`; bodies that do not give way and walls connect nothing.
pub(super) fn islands<const D: usize>(problem: &Problem<D>, contacts: &[Contact<D>]) -> Vec<Vec<usize>> {
    let mut groups = Groups::new(problem.balls.len());
    for contact in contacts {
        if let Some(other) = contact.other().filter(|&other| problem.gives_way(contact.body) && problem.gives_way(other)) {
            groups.join(contact.body, other);
        }
    }
    let mut members = vec![Vec::new(); problem.balls.len()];
    for (place, contact) in contacts.iter().enumerate() {
        members[groups.root(free_body(problem, contact))].push(place);
    }
    members.retain(|contacts| !contacts.is_empty());
    members
}

/// The body of a contact that gives way, the first if both do.
pub(super) fn free_body<const D: usize>(problem: &Problem<D>, contact: &Contact<D>) -> usize {
    contact.other().filter(|_| !problem.gives_way(contact.body)).unwrap_or(contact.body)
}

/// The forces at the contacts of one island.
pub(super) fn solve_island<const D: usize>(problem: &Problem<D>, contacts: &[Contact<D>]) -> Outcome {
    let unit = Unit::new(problem, contacts);
    if unit.violation <= 0.0 {
        return Outcome::Solved { forces: vec![0.0; contacts.len()], iterations: 0 };
    }
    if let [contact] = contacts {
        let force = -problem.gap_after(contact, problem.velocities) / (problem.mobility(contact) * problem.step);
        return Outcome::Solved { forces: vec![force.max(problem.floor(contact))], iterations: 0 };
    }
    let program = program(problem, contacts, &unit);
    let floors: Vec<f64> = contacts.iter().map(|contact| problem.floor(contact) / unit.force(problem, contact)).collect();
    let in_units = |(contact, multiplier): (&Contact<D>, f64)| multiplier * unit.force(problem, contact);
    match solve_above(program, &floors) {
        Ok((multipliers, iterations)) => Outcome::Solved { forces: contacts.iter().zip(multipliers).map(in_units).collect(), iterations },
        Err(outcome) => outcome,
    }
}

/// The multipliers of a program, and the iterations of the interior-point method; or what went wrong.
pub(super) fn solve(program: &Program) -> Result<(Vec<f64>, usize), Outcome> {
    let Some(interior) = interior_point(program) else { return Err(Outcome::Stalled) };
    let multipliers = polish(program, &interior.multipliers);
    match program.solved(&multipliers, TOLERANCE) {
        true => Ok((multipliers, interior.iterations)),
        false if interior.infeasible => Err(Outcome::Squeezed),
        false => Err(Outcome::Stalled),
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
            violation = violation.max(if problem.floor(contact) < 0.0 { gap.abs() } else { -gap });
            scale = scale.max(SMALLEST_SCALE * contact.smaller_radius(problem.balls) / root);
        }
        Self { violation, scale: scale.max(violation) }
    }

    /// The force of a multiplier of one.
    fn force<const D: usize>(&self, problem: &Problem<D>, contact: &Contact<D>) -> f64 {
        self.scale / (problem.mobility(contact).sqrt() * problem.step)
    }
}

/// The program whose unknowns are the changes of `velocity dt sqrt(weight)`.
fn program<const D: usize>(problem: &Problem<D>, contacts: &[Contact<D>], unit: &Unit) -> Program {
    let bodies = free_bodies(problem, contacts);
    let (mut starts, mut rows, mut values, mut offsets) = (vec![0], Vec::new(), Vec::new(), Vec::new());
    for contact in contacts {
        let root = problem.mobility(contact).sqrt();
        let mut push = |body: usize, direction: SVector<f64, D>| {
            if let Ok(place) = bodies.binary_search(&body) {
                rows.extend(place * D..(place + 1) * D);
                values.extend(direction.iter().map(|component| component / (problem.weights[body].sqrt() * root)));
            }
        };
        // the body has the smaller index, so that rows are sorted
        push(contact.body, -contact.normal);
        if let Some(other) = contact.other() {
            push(other, contact.normal);
        }
        starts.push(rows.len());
        offsets.push(problem.gap_after(contact, problem.velocities) / (root * unit.scale));
    }
    Program { transposed: CscMatrix::new(bodies.len() * D, contacts.len(), starts, rows, values), offsets }
}

/// Bodies of contacts that give way, in order.
fn free_bodies<const D: usize>(problem: &Problem<D>, contacts: &[Contact<D>]) -> Vec<usize> {
    let both = contacts.iter().flat_map(|contact| [Some(contact.body), contact.other()]);
    let mut bodies: Vec<usize> = both.flatten().filter(|&body| problem.gives_way(body)).collect();
    bodies.sort_unstable();
    bodies.dedup();
    bodies
}
