//! The quantity whose error is measured.

use serde::{Deserialize, Serialize};

/// What can be measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum QuantityKind {
    /// Magnitude of the mean force by the fluid on held bodies.
    Drag,
    /// Mean pressure gradient over viscosity and mean velocity: the inverse of the permeability.
    Resistance,
    /// Magnitude of the mean velocity of a flow that a pressure gradient or a body force drives.
    MeanVelocity,
    /// Relative viscosity.
    Viscosity,
    /// Velocities of bodies, with their spins times their radii.
    Velocity,
    /// Largest Reynolds number of a body in a run with inertia.
    Reynolds,
    /// The scalar in inclusions.
    Value,
    /// The least value of the functional of the scalar problem.
    Energy,
    /// Centres of bodies at the end of a run in time.
    Position,
    /// The flow, or the scalar, on a lattice of points.
    Field,
    /// Differences of the field between neighbouring points of that lattice: the energy norm as the lattice sees it.
    Gradient,
}

/// Their words.
pub const WORDS: [(&str, QuantityKind); 11] = [
    ("drag", QuantityKind::Drag),
    ("viscosity", QuantityKind::Viscosity),
    ("resistance", QuantityKind::Resistance),
    ("mean-velocity", QuantityKind::MeanVelocity),
    ("velocity", QuantityKind::Velocity),
    ("reynolds", QuantityKind::Reynolds),
    ("value", QuantityKind::Value),
    ("energy", QuantityKind::Energy),
    ("position", QuantityKind::Position),
    ("field", QuantityKind::Field),
    ("gradient", QuantityKind::Gradient),
];

/// The quantity of a study.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CostQuantity {
    /// Which.
    pub kind: QuantityKind,
    /// Of this body alone, where it is one of bodies.
    pub body: Option<usize>,
    /// Points along each axis of the lattice, where it is one of fields.
    pub probe: Option<usize>,
}

impl QuantityKind {
    /// Its word.
    pub fn word(self) -> &'static str {
        WORDS.iter().find(|(_, kind)| *kind == self).map_or("", |(word, _)| word)
    }

    /// Whether it is one of bodies.
    pub fn of_bodies(self) -> bool {
        matches!(self, QuantityKind::Drag | QuantityKind::Velocity | QuantityKind::Value | QuantityKind::Position)
    }

    /// Whether it takes a flow, which a scalar has not.
    pub fn of_flow(self) -> bool {
        use QuantityKind::{Drag, MeanVelocity, Position, Resistance, Reynolds, Velocity, Viscosity};
        matches!(self, Drag | Resistance | MeanVelocity | Viscosity | Velocity | Reynolds | Position)
    }

    /// Whether it is one of fields.
    pub fn of_field(self) -> bool {
        matches!(self, QuantityKind::Field | QuantityKind::Gradient)
    }

    /// The order in the spacing at which theory sees its error fall with a method.
    ///
    /// Fields are seen through a grid, whose interpolation reaches across the kinks at surfaces: an error of order h in a layer as thick as the
    /// spacing. Differences between points of the lattice follow them once the grid is finer than the lattice.
    pub fn predicted_order(self, method: &str) -> f64 {
        match (method, self) {
            ("sharp" | "fitted", QuantityKind::Field | QuantityKind::Gradient) => 1.5,
            ("sharp", _) => 2.0,
            ("fitted", _) => 4.0,
            _ => 1.0,
        }
    }
}
