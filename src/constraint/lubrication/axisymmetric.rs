//! A body seen along the axis of a pair: the modes that its motions along and across the axis excite.

use nalgebra::{DMatrix, DVector, SMatrix, SVector};

use crate::surface::{Modes, axial, modes};

/// Points, or latitudes, for each order of the modes, and besides.
const FINENESS: (usize, usize) = (3, 32);

/// Length that cuts the logarithm of a net force in 2D: any will do, as relative motions have none.
const REACH: f64 = 100.0;

/// One body in its own frame, in which the other lies along the axis: the first in 2D, the third in 3D.
pub struct AxisymmetricBody<const D: usize> {
    /// Modes, for unit viscosity.
    pub modes: Box<dyn Modes>,
    directions: Vec<SVector<f64, D>>,
    weights: Vec<f64>,
    mobility: DMatrix<f64>,
}

/// Modes that relative motions of one kind excite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// Motion along the axis.
    Along,
    /// Motion across the axis, and spin.
    Across,
}

impl<const D: usize> AxisymmetricBody<D> {
    /// Component along the axis.
    pub const AXIS: usize = if D == 2 { 0 } else { 2 };
    /// Component across it.
    pub const ACROSS: usize = if D == 2 { 1 } else { 0 };
    /// The mode of the spin that goes with motion across.
    pub const SPIN: usize = if D == 2 { 2 } else { 4 };

    /// A body of the given radius with modes up to `order`.
    pub fn new(radius: f64, order: usize) -> Self {
        let modes = modes(D, radius, order);
        let points = FINENESS.0 * order + FINENESS.1;
        let rule = axial(D, if D == 2 { 2 * points } else { points });
        let directions = rule.directions.chunks(D).map(SVector::from_column_slice).collect();
        let mobility = modes.isolated_mobility(REACH);
        Self { modes, directions, weights: rule.weights, mobility }
    }

    /// The modes of a channel; rigid ones come first.
    pub fn channel(&self, channel: Channel) -> Vec<usize> {
        let rigid = if channel == Channel::Along { Self::AXIS } else { Self::ACROSS };
        let families = self.modes.degrees();
        let all = || families.iter().flat_map(|family| family.modes.iter().zip(&family.orders));
        let number = all().find(|(mode, _)| **mode == rigid).map(|(_, channel)| channel);
        let mut members: Vec<usize> = all().filter(|(_, channel)| Some(*channel) == number).map(|(mode, _)| *mode).collect();
        members.sort_unstable();
        members
    }

    /// Its own block of these modes.
    pub fn alone(&self, members: &[usize]) -> DMatrix<f64> {
        self.mobility.select_rows(members).select_columns(members)
    }

    /// The surface points, from the centre.
    pub fn points(&self) -> impl Iterator<Item = SVector<f64, D>> + '_ {
        self.directions.iter().map(|direction| direction * self.modes.radius())
    }

    /// Velocities at the points, one column a mode, tested with modes.
    pub fn test(&self, velocities: &DMatrix<f64>, members: &[usize]) -> DMatrix<f64> {
        let mut projector = DMatrix::zeros(members.len(), self.directions.len() * D);
        let mut tractions = vec![0.0; self.modes.count() * D];
        for (point, (direction, weight)) in self.directions.iter().zip(&self.weights).enumerate() {
            self.modes.traction(direction.as_slice(), &mut tractions);
            for (row, mode) in members.iter().enumerate() {
                (0..D).for_each(|i| projector[(row, point * D + i)] = weight * tractions[mode * D + i]);
            }
        }
        projector * velocities
    }

    /// Velocity that these modes cause at an offset from the centre, outside: one column a mode.
    pub fn velocity(&self, offset: &SVector<f64, D>, members: &[usize], values: &mut Vec<f64>) -> DMatrix<f64> {
        values.resize(self.modes.count() * D, 0.0);
        self.modes.exterior_velocity(offset.as_slice(), REACH, values);
        DMatrix::from_fn(D, members.len(), |i, column| values[members[column] * D + i])
    }

    /// Pressure that these modes cause there.
    pub fn pressure(&self, offset: &SVector<f64, D>, members: &[usize], values: &mut Vec<f64>) -> DVector<f64> {
        values.resize(self.modes.count() * D, 0.0);
        self.modes.exterior_pressure(offset.as_slice(), values);
        DVector::from_fn(members.len(), |row, _| values[members[row]])
    }

    /// Multiplier of a unit velocity, or spin, of a rigid mode.
    pub fn unit(&self, mode: usize) -> f64 {
        if mode < D { 1.0 } else { self.modes.torque_factor() / self.modes.force_factor() }
    }

    /// The component that the channel measures of the symmetric traceless first moment of tractions on the body.
    pub fn stress(&self, members: &[usize], multipliers: impl Iterator<Item = f64>, channel: Channel) -> f64 {
        let multipliers: Vec<f64> = multipliers.collect();
        let mut tractions = vec![0.0; self.modes.count() * D];
        let mut moment = SMatrix::<f64, D, D>::zeros();
        for (direction, weight) in self.directions.iter().zip(&self.weights) {
            self.modes.traction(direction.as_slice(), &mut tractions);
            let sum = |i: usize| members.iter().zip(&multipliers).map(|(mode, c)| tractions[mode * D + i] * c).sum::<f64>();
            let traction = SVector::<f64, D>::from_fn(|i, _| sum(i));
            moment -= traction * direction.transpose() * (weight * self.modes.radius() * self.modes.force_factor());
        }
        let (axis, across) = (Self::AXIS, Self::ACROSS);
        match channel {
            // four longitudes integrate what varies twice round the axis: the trace is exact
            Channel::Along => moment[(axis, axis)] - moment.trace() / D as f64,
            Channel::Across => 0.5 * (moment[(axis, across)] + moment[(across, axis)]),
        }
    }
}
