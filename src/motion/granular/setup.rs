//! Bodies without a fluid, resolved in their dimension.

use nalgebra::{SMatrix, SVector};

use crate::{
    body::{Trajectories, Twist},
    geometry::Domain,
    interaction::Interactions,
    setup::{State, WallMotion},
};

/// A body without a fluid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GranularBody<const D: usize> {
    /// Radius.
    pub radius: f64,
    /// Place at the start.
    pub center: SVector<f64, D>,
    /// Motion at the start, and for ever if nothing can change it.
    pub twist: Twist<D>,
    /// Mass, infinite if its motion is given.
    pub mass: f64,
    /// Moment of inertia.
    pub inertia: f64,
    /// Acceleration by the forces on it besides contacts.
    pub acceleration: SVector<f64, D>,
    /// The same of its spin.
    pub spin_up: SMatrix<f64, D, D>,
}

/// A wall that a load presses on the bodies: the upper one across an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct WallLoad {
    /// The axis.
    pub axis: usize,
    /// The force that presses it towards the bodies.
    pub force: f64,
    /// Its mass.
    pub mass: f64,
    /// Numbers of the bodies that are fixed to it, ascending; they have no mass besides.
    pub fixed: Vec<usize>,
}

/// A dry scene resolved in its dimension.
#[derive(Debug, Clone)]
pub struct GranularSetup<const D: usize> {
    /// The box.
    pub domain: Domain<D>,
    /// The bodies.
    pub bodies: Vec<GranularBody<D>>,
    /// How those move whose given motion changes with time.
    pub trajectories: Trajectories<D>,
    /// What they do to each other and how they notice walls.
    pub interactions: Interactions<D>,
    /// The wall that a load presses on them, if there is one.
    pub load: Option<WallLoad>,
}

impl<const D: usize> GranularSetup<D> {
    /// The bodies at the start.
    pub fn start(&self) -> State<D> {
        State { wall: self.wall(), ..State::start(self.bodies.iter().map(|body| (body.center, body.twist))) }
    }

    /// The loaded wall at the start, at rest at the end of the box.
    pub fn wall(&self) -> Option<WallMotion<D>> {
        let at_rest = |axis: usize| WallMotion { axis, position: self.domain.size[axis], velocity: 0.0, force: SVector::zeros() };
        self.load.as_ref().map(|load| at_rest(load.axis))
    }
}
