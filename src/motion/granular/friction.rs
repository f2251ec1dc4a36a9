//! A step of granular bodies with friction at contacts.

use std::time::Instant;

use nalgebra::{SMatrix, SVector};

use super::{Granular, chains::GranularStep};
use crate::{
    body::Twist,
    contact::{FRICTION_TOLERANCE, Problem, ProblemShare},
    error::{Error, Result},
    friction::{FrictionProjection, FrictionShare, SurfaceFriction, project_with_friction},
    interaction::Touch,
    motion::stepper::{Effort, StepOutcome},
    petsc::{Stage, enter},
    setup::State,
};

impl<const D: usize> Granular<D> {
    /// Residual to which forces with friction are found.
    pub(super) fn friction_tolerance(&self) -> f64 {
        self.interactions.friction().map_or(FRICTION_TOLERANCE, |friction| friction.tolerance)
    }

    /// A step of bodies that want to move so, with friction. Collective.
    pub(super) fn advance_with_friction(&self, state: &State<D>, wanted: &[Twist<D>], length: GranularStep) -> Result<StepOutcome<D>> {
        let start = Instant::now();
        let coefficient = self.interactions.friction().map_or(0.0, |friction| friction.coefficient);
        if self.interactions.touch() != Some(Touch::Hard) {
            return Err(Error::refused(format!(
                "contact.friction = {coefficient}: acts with contact.model = \"inelastic\"; set that or remove it"
            )));
        }
        let kept = self.project_with_friction(state, wanted, &self.interactions.surfaces(), length)?;
        let moves: Vec<Twist<D>> = kept.velocities.iter().zip(&kept.spins).map(|(&velocity, &spin)| Twist { velocity, spin }).collect();
        let contacts = [self.known.contacts.clone(), kept.forces].concat();
        let effort = Effort { contact: start.elapsed().as_secs_f64(), ..Effort::default() };
        let (twists, adhesive_contacts, kkt_report) = (moves.clone(), Vec::new(), Some(kept.kkt_report));
        let step = length.length;
        Ok(StepOutcome { step, twists, moves, contacts, adhesive_contacts, kkt_report, shear: state.shear, wall: None, effort })
    }

    /// Velocities and spins that keep contacts with friction, next to those wanted. Collective.
    fn project_with_friction(
        &self,
        state: &State<D>,
        moves: &[Twist<D>],
        surfaces: &SurfaceFriction,
        GranularStep { length: step, push }: GranularStep,
    ) -> Result<FrictionProjection<D>> {
        let (_stage, peers) = (enter(Stage::Contacts), self.peers());
        let (numbers, balls) = (state.numbers(), state.balls(&self.radii));
        let weights: Vec<f64> = self.bodies.iter().map(|body| body.mass / push).collect();
        let inertias: Vec<f64> = self.bodies.iter().map(|body| body.inertia).collect();
        let velocities: Vec<SVector<f64, D>> = moves.iter().map(|twist| twist.velocity).collect();
        let spins: Vec<SMatrix<f64, D, D>> = moves.iter().map(|twist| twist.spin).collect();
        let problem = Problem { numbers: Some(&numbers), ..Problem::new(&self.domain, &balls, &weights, &velocities, step) };
        let share = ProblemShare { problem, regions: &self.regions, spanning: (&self.session).into() };
        let last = state.contact_history.iter().map(|contact| (contact.identity(), contact.tangential)).collect();
        let (tolerance, last) = (self.friction_tolerance(), &last);
        let starts = &state.twists();
        let friction = FrictionShare { surfaces, starts, spins: &spins, inertias: &inertias, duration: push, tolerance, last };
        project_with_friction(peers, &share, &friction, &state.memory())
    }
}
