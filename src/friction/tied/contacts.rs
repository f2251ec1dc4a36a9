//! Which contacts take part in friction where all bodies are known.

use crate::{
    contact::{
        Contact, Problem,
        paths::{Motions, common_motion, paths},
    },
    parallel::Peers,
};

/// Contacts of bodies that come nearer than so many radii of the smaller one on their way with the velocities of the problem.
pub fn contacts_on_the_way<const D: usize>(problem: &Problem<D>, nearness: f64) -> Vec<Contact<D>> {
    let common = common_motion(Peers::Alone, problem, problem.velocities);
    let motions = Motions { velocities: problem.velocities, common };
    let near = paths(problem, &motions, nearness, |_| true).into_iter();
    near.filter(|path| path.smallest_gap < nearness * path.contact.smaller_radius(problem.balls)).map(|path| path.contact).collect()
}
