//! Bodies: where they are, how they move or what moves them. This module knows no fluid and no grid.

mod centers;
mod chains;
mod columns;
mod equilibrium;
mod fire;
mod halo;
mod membrane;
mod outline;
mod packing;
mod places;
mod regions;
mod relaxation;
mod row;
mod search;
mod share;
mod trajectory;
mod twist;

use nalgebra::{SMatrix, SVector};

use crate::geometry::Ball;
pub use centers::{parse_centers, read_centers};
pub use chains::{ChainForm, place_chains};
pub use columns::{read_text, usable};
pub use equilibrium::equilibrium;
pub use halo::{Halo, OwnBodies};
pub use membrane::{Membrane, parts};
pub use outline::{Outline, RestShape};
pub use packing::{pack, pack_on};
pub use places::{TOO_FEW, misplaced, read_places};
pub use regions::Regions;
pub use row::{RigidFunctional, Row};
pub use trajectory::{Path, Trajectories, Trajectory};
pub use twist::{Twist, components, planes, skew};

/// What decides the motion of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion<const D: usize> {
    /// Its motion is unknown; force and torque on it, besides those of the fluid, are given.
    Free {
        /// Net force on the body.
        force: SVector<f64, D>,
        /// Net torque on the body, as a skew matrix.
        torque: SMatrix<f64, D, D>,
    },
    /// Its motion is given; one that changes with time is that of the time which is looked at.
    Prescribed(Twist<D>),
}

/// A rigid body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body<const D: usize> {
    /// Its shape and place.
    pub ball: Ball<D>,
    /// What decides its motion.
    pub motion: Motion<D>,
}

impl<const D: usize> Body<D> {
    /// Whether its motion is unknown.
    pub fn free(&self) -> bool {
        matches!(self.motion, Motion::Free { .. })
    }

    /// Its motion, if that is given.
    pub fn given_motion(&self) -> Option<Twist<D>> {
        match self.motion {
            Motion::Prescribed(twist) => Some(twist),
            Motion::Free { .. } => None,
        }
    }
}
