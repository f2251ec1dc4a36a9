//! A body seen along the axis of a pair: the modes that its motions along and across the axis excite.

use nalgebra::{DMatrix, SMatrix};

use crate::surface::{Modes, SurfaceTable, modes};

/// Length that cuts the logarithm of a net force in 2D: any will do, as relative motions have none.
pub const REACH: f64 = 100.0;

/// Modes up to this order have all first moments that are symmetric and traceless.
const ORDER_OF_MOMENTS: usize = 2;

/// One body in its own frame, in which the other lies along the axis: the first in 2D, the third in 3D.
pub struct AxisymmetricBody<const D: usize> {
    /// Modes, for unit viscosity.
    pub modes: Box<dyn Modes>,
    channels: [ChannelModes; 2],
}

/// Modes that relative motions of one kind excite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// Motion along the axis.
    Along,
    /// Motion across the axis, and spin.
    Across,
}

/// The modes of a channel.
pub struct ChannelModes {
    /// Their numbers; rigid ones come first.
    pub members: Vec<usize>,
    /// Their block for the body alone.
    pub alone: DMatrix<f64>,
    /// The inverse of that.
    pub inverse: DMatrix<f64>,
    /// For each, the component that the channel measures of the symmetric traceless first moment of its traction on the body.
    moments: Vec<f64>,
}

impl ChannelModes {
    /// The component that the channel measures of the symmetric traceless first moment.
    pub fn stress(&self, multipliers: impl Iterator<Item = f64>) -> f64 {
        self.moments.iter().zip(multipliers).map(|(moment, multiplier)| moment * multiplier).sum()
    }
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
        let mobility = modes.isolated_mobility(REACH);
        let surface = SurfaceTable::<D>::new(radius, order.min(ORDER_OF_MOMENTS), radius);
        let channels = [Channel::Along, Channel::Across].map(|channel| {
            let members = Self::members(modes.as_ref(), channel);
            let alone = DMatrix::from_fn(members.len(), members.len(), |row, column| mobility[(members[row], members[column])]);
            let moments =
                members.iter().map(|mode| surface.first_moments().get(*mode).map_or(0.0, |moment| -Self::component(moment, channel)));
            let inverse = alone.clone().try_inverse().expect("the mobility of a body is positive definite");
            ChannelModes { moments: moments.collect(), alone, inverse, members }
        });
        Self { modes, channels }
    }

    /// The modes of a channel.
    pub fn channel(&self, channel: Channel) -> &ChannelModes {
        &self.channels[channel as usize]
    }

    /// Multiplier of a unit velocity, or spin, of a rigid mode.
    pub fn unit(&self, mode: usize) -> f64 {
        if mode < D { 1.0 } else { self.modes.torque_factor() / self.modes.force_factor() }
    }

    /// Multipliers of the modes of a channel, a column for each motion given by rigid modes and how fast they move.
    pub fn motions(&self, channel: Channel, motions: &[&[(usize, f64)]]) -> DMatrix<f64> {
        let members = &self.channel(channel).members;
        let mut wanted = DMatrix::zeros(members.len(), motions.len());
        for (column, motion) in motions.iter().enumerate() {
            for (mode, speed) in *motion {
                let place = members.iter().position(|member| member == mode).expect("the channel has its rigid modes");
                wanted[(place, column)] = speed * self.unit(*mode);
            }
        }
        wanted
    }

    /// The pressure at a distance ahead that multipliers of a channel cause.
    pub fn pressure_ahead(&self, channel: Channel, distance: f64, multipliers: impl Iterator<Item = f64>) -> f64 {
        let (mut offset, mut pressures) = ([0.0; D], vec![0.0; self.modes.count()]);
        offset[Self::AXIS] = distance;
        self.modes.exterior_pressure(&offset, &mut pressures);
        self.channel(channel).members.iter().zip(multipliers).map(|(mode, multiplier)| pressures[*mode] * multiplier).sum()
    }

    /// Less the trace of the first moment of the traction on a body that has a pressure inside.
    pub fn pressure_moment(&self, inside: f64) -> f64 {
        self.modes.force_factor() * self.modes.radius() * inside
    }

    fn members(modes: &dyn Modes, channel: Channel) -> Vec<usize> {
        let rigid = if channel == Channel::Along { Self::AXIS } else { Self::ACROSS };
        let families = modes.degrees();
        let all = || families.iter().flat_map(|family| family.modes.iter().zip(&family.orders));
        let number = all().find(|(mode, _)| **mode == rigid).map(|(_, channel)| channel);
        let mut members: Vec<usize> = all().filter(|(_, channel)| Some(*channel) == number).map(|(mode, _)| *mode).collect();
        members.sort_unstable();
        members
    }

    fn component(moment: &SMatrix<f64, D, D>, channel: Channel) -> f64 {
        let (axis, across) = (Self::AXIS, Self::ACROSS);
        match channel {
            Channel::Along => moment[(axis, axis)] - moment.trace() / D as f64,
            Channel::Across => 0.5 * (moment[(axis, across)] + moment[(across, axis)]),
        }
    }
}
