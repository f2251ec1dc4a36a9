//! Bodies in a flow, resolved in their dimension: numbers only, nothing left to choose.

use std::rc::Rc;

use nalgebra::SVector;

use super::state::GivenPlace;
use crate::{
    body::{Body, Motion, Row, Trajectories, Twist},
    constraint::{FlowMethod, Precision, method_of, method_with_inertia},
    error::Result,
    flow::{Drive, InverseMethod, IteratedInverse, Stokes, StokesInverse},
    geometry::{Domain, Protocol},
    grid::Grid,
    interaction::{Interaction, Interactions},
    scene::{ConstraintMethod, MultiplierSolver, Tolerance},
    surface::{Shape, area, lever},
};

/// Shift of the operator times the square of the spacing beyond which the velocity of a light body is read inside it. That is less exact, but the jumps of
/// steady flow say more of how mobile a surface is than the grid does there.
const LARGEST_SHIFT: f64 = 30.0;

/// Tolerance of the fluid alone over that of the whole.
const INNER: f64 = 0.01;

/// A body with the order of its multiplier modes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SuspendedBody<const D: usize> {
    /// The body.
    pub body: Body<D>,
    /// Highest order of its modes.
    pub order: usize,
}

/// Masses per volume, all positive, and motions at the start.
#[derive(Debug, Clone, PartialEq)]
pub struct Inertia<const D: usize> {
    /// Mass per volume of the fluid.
    pub fluid: f64,
    /// Mass per volume of each body.
    pub bodies: Vec<f64>,
    /// How each body, if it is free, moves at the start.
    pub starts: Vec<Twist<D>>,
}

/// What to solve.
#[derive(Debug, Clone)]
pub struct Setup<const D: usize> {
    /// The box.
    pub domain: Domain<D>,
    /// Spacing asked for; whole numbers of cells make it differ a little along each axis.
    pub spacing: f64,
    /// Viscosity of the fluid.
    pub viscosity: f64,
    /// What drives the flow now.
    pub drive: Drive<D>,
    /// A drive that changes with time, and what it is multiplied by: the rate of this protocol.
    pub changing_drive: Option<(Drive<D>, Protocol)>,
    /// The bodies.
    pub bodies: Vec<SuspendedBody<D>>,
    /// How those move whose given motion changes with time.
    pub trajectories: Trajectories<D>,
    /// What fluid and bodies weigh, if they have inertia.
    pub inertia: Option<Inertia<D>>,
    /// What makes bodies rigid.
    pub constraint: ConstraintMethod,
    /// What bodies do to each other besides the flow.
    pub interactions: Interactions<D>,
    /// What inverts the fluid.
    pub inverse: InverseMethod,
    /// When the linear solver ends.
    pub tolerance: Tolerance,
}

impl<const D: usize> Setup<D> {
    /// The same with another interaction.
    pub fn with(self, interaction: impl Interaction<D> + 'static) -> Setup<D> {
        Setup { interactions: self.interactions.with(interaction), ..self }
    }

    /// Turns the box to that of a time, and a shear whose rate changes to that of then.
    pub fn turn_to(&mut self, domain: Domain<D>) {
        self.domain = domain;
        if let (Drive::Shear(rate), Some(_)) = (&mut self.drive, self.domain.protocol()) {
            *rate = self.domain.shear_rate();
        }
    }

    /// Turns motions that are given, and a drive that changes, to those of a time.
    pub fn prescribe(&mut self, time: f64) {
        if let Some((drive, factor)) = &self.changing_drive {
            self.drive = drive.scaled(factor.rate(time));
        }
        self.trajectories.twists(time).for_each(|(body, twist)| self.bodies[body].body.motion = Motion::Prescribed(twist));
    }

    /// The drive, at its strongest where it changes with time.
    pub fn strongest_drive(&self) -> Drive<D> {
        self.changing_drive.as_ref().map_or(self.drive, |(drive, factor)| drive.scaled(factor.fastest()))
    }

    /// How the shear or the drive changes with time, if one of them does.
    pub fn protocol(&self) -> Option<Protocol> {
        self.domain.protocol().or_else(|| self.changing_drive.as_ref().map(|(_, factor)| *factor))
    }

    /// The motions of all bodies, the fastest of those that change with time.
    pub fn fastest_motions(&self) -> Vec<Motion<D>> {
        let mut motions: Vec<Motion<D>> = self.bodies.iter().map(|suspended| suspended.body.motion).collect();
        self.trajectories.fastest().for_each(|(body, twist)| motions[body] = Motion::Prescribed(twist));
        motions
    }

    /// Rows that make bodies with these centres move as one, for velocities of their images in the box: one that lies `r` away from its centre moves
    /// slower by the background over `r`, unless images slide and the flow takes that along.
    pub fn welds_in_the_box(&self, centers: &[SVector<f64, D>]) -> Vec<Row<D>> {
        let faster = |body: usize| {
            let center = &centers[body];
            self.drive.background(&(center - self.domain.wrap(*center))) - self.domain.image_velocity(center)
        };
        let mut rows = self.interactions.welds(centers);
        for row in &mut rows {
            row.rate -= row.ends.iter().map(|(body, side)| side.direction.dot(&faster(*body))).sum::<f64>();
        }
        rows
    }

    /// What fills the blocks of the bodies, where the operator of the fluid has a shift.
    ///
    /// # Panics
    /// For a fitted mesh, which has no such blocks.
    pub fn method(&self, shift: f64) -> Rc<FlowMethod<D>> {
        let (word, epsilon) = (self.constraint.word(), self.constraint.epsilon());
        let precision = Precision::for_tolerance(self.tolerance.at_an_instant());
        let method = match &self.inertia {
            Some(inertia) => {
                let (spin_up_of, inside) = (self.spin_ups_of_rotations(inertia), self.inside(inertia, shift));
                method_with_inertia(word, epsilon, precision, shift, spin_up_of, inside)
            }
            None => method_of(word, epsilon, precision),
        };
        method.expect("a fitted mesh has no blocks on a grid")
    }

    /// The grid for so many ranks, seen from one of them.
    ///
    /// # Errors
    /// It does not fit.
    pub fn grid(&self, ranks: usize, rank: usize) -> Result<Grid<D>> {
        let grid = if self.may_be_oblique() { Grid::oblique } else { Grid::new };
        grid(&self.domain, self.spacing, ranks, rank)
    }

    /// Whether lines of the grid may be oblique, for images that are displaced by parts of a cell: jumps and interpolation of `sharp` know where nodes are; with
    /// inertia a flow is carried from grid to grid, whose nodes must stay.
    pub fn may_be_oblique(&self) -> bool {
        self.constraint == ConstraintMethod::Sharp && self.inertia.is_none() && self.domain.slide().is_some()
    }

    /// The inverse of the fluid that is called for.
    ///
    /// # Errors
    /// The box does not allow it, or PETSc has no memory for it.
    pub fn inverse_of(&self, stokes: &Stokes<D>, grid: &Grid<D>) -> Result<Box<dyn StokesInverse<D>>> {
        let inverse = self.inverse.set_up(stokes, grid)?;
        match self.inner_tolerance() {
            Some(tolerance) if !inverse.exact() => Ok(Box::new(IteratedInverse::new(inverse, tolerance))),
            _ => Ok(inverse),
        }
    }

    /// Whether that is exact.
    pub fn inverts_exactly(&self) -> bool {
        self.inverse.is_exact(&self.domain) || self.inner_tolerance().is_some()
    }

    /// The word for what inverts the fluid.
    pub fn inverse_word(&self) -> &'static str {
        if self.constraint == ConstraintMethod::Fitted { "direct" } else { self.inverse.word() }
    }

    /// A faster inverse of the fluid that the box allows, if there is one.
    pub fn faster_inverse(&self) -> Option<InverseMethod> {
        let iterated = self.constraint != ConstraintMethod::Fitted && self.inertia.is_none() && !self.inverts_exactly();
        Some(InverseMethod::fastest(&self.domain)).filter(|fastest| iterated && *fastest != self.inverse)
    }

    /// Centres of all bodies.
    pub fn centers(&self) -> Vec<SVector<f64, D>> {
        self.bodies.iter().map(|suspended| suspended.body.ball.center).collect()
    }

    /// Whether each body moves as the fluid inside it does: if it is free and lighter than the fluid, in short steps.
    fn inside(&self, inertia: &Inertia<D>, shift: f64) -> Vec<bool> {
        let short = shift * self.spacing * self.spacing > LARGEST_SHIFT;
        let light = |(suspended, density): (&SuspendedBody<D>, &f64)| short && suspended.body.free() && *density < inertia.fluid;
        self.bodies.iter().zip(&inertia.bodies).map(light).collect()
    }

    /// The spin-up of each body by a unit multiplier of rotation: the torque on it over its moment of inertia; 0 for prescribed motion.
    fn spin_ups_of_rotations(&self, inertia: &Inertia<D>) -> Vec<f64> {
        let of_body = |(suspended, density): (&SuspendedBody<D>, &f64)| {
            let Body { ball, .. } = suspended.body;
            let torque = area(D, ball.radius) * lever(D, ball.radius);
            if suspended.body.free() { -inertia.fluid * torque / (density * ball.moment_of_inertia()) } else { 0.0 }
        };
        self.bodies.iter().zip(&inertia.bodies).map(of_body).collect()
    }

    /// Tolerance of the fluid alone, where a method needs each solve of it to be exact and the inverse is not.
    ///
    /// Extra stresses are told apart by what the exact flow makes of them, and Uzawa's iteration is one on the multipliers.
    pub fn inner_tolerance(&self) -> Option<f64> {
        let exact = matches!(self.constraint, ConstraintMethod::Penalty(_) | ConstraintMethod::MeanValue(MultiplierSolver::Uzawa(_)));
        exact.then(|| INNER * self.tolerance.at_an_instant())
    }

    /// Half the distance between bodies: in 2D others cut the logarithm of a body's mobility there.
    pub fn reach(&self) -> f64 {
        0.5 * (self.domain.volume() / self.bodies.len() as f64).powf(1.0 / D as f64)
    }

    /// Force that gives a body of this shape a unit velocity in unbounded fluid.
    pub fn resistance(&self, shape: &dyn Shape<D>) -> f64 {
        let modes = shape.modes(1);
        self.viscosity * modes.force_factor() / modes.isolated_mobility(self.reach())[(0, 0)]
    }

    /// Numbers of the bodies whose motion is given.
    pub fn given_motions(&self) -> Vec<usize> {
        (0..self.bodies.len()).filter(|&body| !self.bodies[body].body.free()).collect()
    }

    /// Where they are at a time.
    pub fn given_places(&self, time: f64) -> Vec<(usize, GivenPlace<D>)> {
        let start = |body: usize| self.bodies[body].body.ball.center;
        let steady = |(body, suspended): (usize, &SuspendedBody<D>)| {
            Some((body, GivenPlace::steady(start(body), &suspended.body.given_motion()?, time)))
        };
        let mut places: Vec<_> = self.bodies.iter().enumerate().filter_map(steady).collect();
        for (body, (displacement, angle)) in self.trajectories.displacements(time) {
            places
                .iter_mut()
                .filter(|(given, _)| *given == body)
                .for_each(|(_, place)| *place = GivenPlace::displaced(start(body), displacement, angle));
        }
        places
    }

    /// Part of the box that bodies fill.
    pub fn fraction(&self) -> f64 {
        self.bodies.iter().map(|suspended| suspended.body.ball.volume()).sum::<f64>() / self.domain.volume()
    }
}
