//! A step of bodies with bonds, rigid clusters or contacts without friction.

use std::time::Instant;

use nalgebra::SVector;

use super::{Granular, chains::GranularStep, rubbing::Rubbing, ties::Ties, velocities};
use crate::{
    body::Twist,
    contact::{ContactForce, KktReport, ProjectionShare},
    error::Result,
    interaction::Touch,
    motion::stepper::{Effort, StepOutcome},
    setup::State,
};

impl<const D: usize> Granular<D> {
    /// A step from motions without normal forces of contacts, with ties or without friction.
    pub(super) fn advance_with_ties(
        &self,
        state: &State<D>,
        mut moves: Vec<Twist<D>>,
        rubbing: Option<Rubbing<D>>,
        length: GranularStep,
        start: Instant,
    ) -> Result<StepOutcome<D>> {
        let (step, rubbed) = (length.length, rubbing.as_ref().map(|rubbing| &rubbing.changes[..]));
        let mut ties = Ties::new(self.peers(), &self.interactions, state, &self.bodies, &moves, length);
        let (mut active_contacts, mut adhesive_contacts, mut kkt_report) = (Vec::new(), Vec::new(), None);
        let (wanted, mut changes) = (velocities(&moves), vec![SVector::zeros(); moves.len()]);
        let touch = self.interactions.touch();
        if touch == Some(Touch::Hard) {
            let kept = self.keep_apart(state, ties.as_mut(), &moves, rubbed, length)?;
            active_contacts = apply(&kept.projection, &mut moves);
            (adhesive_contacts, changes) = (kept.adhesive_contacts, kept.changes);
            kkt_report = Some(kept.projection.projection.kkt_report);
        } else if let Some(ties) = &mut ties {
            moves.iter_mut().zip(ties.hold(self.peers(), &wanted, &changes)).for_each(|(twist, velocity)| twist.velocity = velocity);
        }
        match touch {
            None => self.refuse_outside(state)?,
            Some(Touch::Soft { .. }) => kkt_report = self.known.kkt_report,
            Some(Touch::Hard) => {}
        }
        let mut twists = moves.clone();
        if let Some(ties) = ties {
            self.refuse_missed(state.time, step, &ties)?;
            ties.turn(self.peers(), [&wanted, &changes], &mut moves, &mut twists);
        }
        if let Some(rubbing) = &rubbing {
            let friction = Some(self.friction_report(state, rubbing, &moves, &active_contacts));
            kkt_report = kkt_report.map(|report| KktReport { friction, ..report });
            active_contacts = rubbing.forces(state, active_contacts);
        }
        let contacts = [&self.known.contacts[..], &active_contacts].concat();
        let effort = Effort { contact: start.elapsed().as_secs_f64(), ..Effort::default() };
        Ok(StepOutcome { step, twists, moves, contacts, adhesive_contacts, kkt_report, shear: state.shear, wall: None, effort })
    }
}

/// Velocities as a projection finds them, into motions of the own bodies; and its forces, of bodies by number.
fn apply<const D: usize>(share: &ProjectionShare<D>, moves: &mut [Twist<D>]) -> Vec<ContactForce<D>> {
    let ProjectionShare { projection, view } = share;
    moves.iter_mut().zip(&projection.velocities).for_each(|(twist, velocity)| twist.velocity = *velocity);
    projection.forces.iter().map(|force| ContactForce { contact: view.numbered(&force.contact), ..*force }).collect()
}
