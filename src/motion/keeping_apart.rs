//! What keeps bodies apart over a step, whatever the flow and the rule of the step say: of clusters and chains too.

use nalgebra::SVector;

use super::{
    clusters::ClusterMotions,
    contact_step::ContactStep,
    kept_measures::keep,
    quasi_static::{MOST_ROUNDS, Placed, QuasiStatic, velocities},
};
use crate::{
    body::Twist,
    contact::Projection,
    error::{Error, Result},
    geometry::{near_pairs, near_walls},
    interaction::Touch,
    scene::ConstraintMethod,
    setup::State,
};

/// Overlap, in radii, up to which clusters are kept apart in a step; the next one does the rest.
const APART: f64 = 1e-8;

/// Overlap, in radii, at which a run in which bodies do not notice contact ends.
const OVERLAP: f64 = 1e-6;

/// What to do where bodies on a fitted mesh overlap, which knows of no contact.
const FITTED_REMEDY: &str =
    "no mesh fits between bodies that touch: set a shorter time.step, or method.constraint = \"sharp\" with contact.model = \"inelastic\"";

impl<const D: usize> QuasiStatic<D> {
    /// Keeps bodies apart that want to move so without contact forces, and gives what presses. Where clusters cannot follow as one, what they can do is
    /// kept apart again, until both hold (alternating projections).
    pub(super) fn keep_apart(
        &self,
        contacts: &ContactStep<D>,
        wanted: &[SVector<f64, D>],
        state: &State<D>,
        moves: &mut [Twist<D>],
    ) -> Result<Projection<D>> {
        let mut projection = contacts.project(wanted, &[])?;
        moves.iter_mut().zip(&projection.velocities).for_each(|(twist, velocity)| twist.velocity = *velocity);
        let interactions = &self.suspension.setup().interactions;
        if interactions.cluster_of().is_empty() {
            return Ok(projection);
        }
        let smallest = self.radii.iter().copied().fold(f64::INFINITY, f64::min);
        let mut clusters = ClusterMotions::nearest(interactions.clusters().iter(), state, contacts.step, moves);
        clusters.carry(moves);
        for _ in 0..MOST_ROUNDS {
            let apart = contacts.project(&velocities(moves), &[])?;
            if largest_difference(moves, &apart.velocities) * contacts.step < APART * smallest {
                break;
            }
            let pushes: Vec<SVector<f64, D>> = apart.velocities.iter().zip(&*moves).map(|(apart, twist)| apart - twist.velocity).collect();
            clusters.follow(&pushes, moves);
        }
        projection.kkt_report.smallest_gap = contacts.smallest_gap_after(moves);
        Ok(projection)
    }

    /// Keeps rods, areas and volumes of chains over a step, and bodies apart, in turn where bodies touch; gives the smallest gap then, if contacts are kept and
    /// bodies are near each other, which chains that press against each other may leave a little below zero.
    pub(super) fn keep_chains(&self, placed: &Placed<D>, moves: &mut [Twist<D>], step: f64) -> Result<Option<f64>> {
        let interactions = &self.suspension.setup().interactions;
        if interactions.chains().is_empty() {
            return Ok(None);
        }
        let (centers, smallest) = (placed.state.centers(), self.radii.iter().copied().fold(f64::INFINITY, f64::min));
        let missed = keep(interactions, &centers, moves, step);
        missed.map_or(Ok(()), |missed| missed.check(placed.state.time, step))?;
        if interactions.touch() != Some(Touch::Hard) {
            return Ok(None);
        }
        // contacts that pull have done so
        let contacts = ContactStep { bounds: Vec::new(), ..self.contact_step(placed, step) };
        // what nothing was done to is as far apart as it was
        let rounds = if missed.is_some() { MOST_ROUNDS } else { 0 };
        for _ in 0..rounds {
            let apart = contacts.project(&velocities(moves), &[])?.velocities;
            if largest_difference(moves, &apart) * step < APART * smallest {
                break;
            }
            moves.iter_mut().zip(apart).for_each(|(twist, velocity)| twist.velocity = velocity);
            keep(interactions, &centers, moves, step);
        }
        // of surfaces, not of where they touch
        let gap = self.contact_step_of(placed, &placed.balls, step).smallest_gap_after(moves);
        Ok(Some(gap).filter(|gap| gap.is_finite()))
    }

    /// Where nothing keeps bodies apart, or too weakly, they may overlap, and a flow has no meaning then.
    pub(super) fn refuse_overlap(&self, placed: &Placed<D>, touch: Option<Touch>) -> Result<()> {
        let (overlap, remedy) = match touch {
            Some(Touch::Hard) => return Ok(()),
            Some(Touch::Soft { overlap, remedy }) => (overlap, remedy),
            None if self.suspension.setup().constraint == ConstraintMethod::Fitted => (OVERLAP, FITTED_REMEDY),
            None => (OVERLAP, "set contact.model = \"inelastic\" or a shorter time.step"),
        };
        let Placed { state, domain, balls, .. } = placed;
        let pairs = near_pairs(domain, balls, 0.0).into_iter().map(|pair| (pair.first, Some(pair.second), pair.gap));
        let walls = near_walls(domain, balls, 0.0).into_iter().map(|pair| (pair.body, None, pair.gap));
        let Some((body, other, gap)) = pairs.chain(walls).find(|&(body, _, gap)| gap < -overlap * balls[body].radius) else {
            return Ok(());
        };
        let other = other.map_or("a wall".to_owned(), |other| format!("body {other}"));
        Err(Error::Diverged(format!("at time {} body {body} overlaps {other} by {:.1e}; {remedy}", state.time, -gap)))
    }
}

/// Largest difference of velocities.
pub(super) fn largest_difference<const D: usize>(twists: &[Twist<D>], velocities: &[SVector<f64, D>]) -> f64 {
    twists.iter().zip(velocities).map(|(twist, velocity)| (twist.velocity - velocity).norm()).fold(0.0, f64::max)
}
