//! Rows by which forces and rates of a few bodies are tied to each other: of springs, bonds, joints and clusters, in a flow and without one.

use nalgebra::{SMatrix, SVector};

use super::{Twist, components};

/// A linear function of a rigid motion; read as a wrench, the force and torque that do its work.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidFunctional<const D: usize> {
    /// What a velocity counts.
    pub direction: SVector<f64, D>,
    /// What a spin counts, a skew matrix.
    pub turn: SMatrix<f64, D, D>,
}

impl<const D: usize> RigidFunctional<D> {
    /// What a motion counts.
    pub fn rate(&self, twist: &Twist<D>) -> f64 {
        let turning: f64 = components(&self.turn).iter().zip(components(&twist.spin)).map(|(turn, spin)| turn * spin).sum();
        self.direction.dot(&twist.velocity) + turning
    }
}

/// A row `rate of a coordinate + compliance force = wanted rate`, or no less than that where the force has a least one, as at contacts.
#[derive(Debug, Clone, PartialEq)]
pub struct Row<const D: usize> {
    /// The bodies, with what the motion of each counts for the rate, and so how a unit force pushes and turns it.
    pub ends: Vec<(usize, RigidFunctional<D>)>,
    /// How a unit force pushes and turns each of them where that is something else, as at a contact that slips against friction; else nothing.
    pub pushes: Vec<RigidFunctional<D>>,
    /// The rate wanted.
    pub rate: f64,
    /// Rate over force; zero for what cannot give way.
    pub compliance: f64,
    /// The least force that it bears, not positive; minus infinity where nothing limits it.
    pub least: f64,
}

impl<const D: usize> Row<D> {
    /// A row of which a unit force, of any sign, pushes each body as its motion counts.
    pub fn new(ends: Vec<(usize, RigidFunctional<D>)>, rate: f64, compliance: f64) -> Row<D> {
        Row { ends, pushes: Vec::new(), rate, compliance, least: f64::NEG_INFINITY }
    }

    /// The bodies, each with what its motion counts, and with how a unit force pushes and turns it.
    pub fn sides(&self) -> impl Iterator<Item = (usize, &RigidFunctional<D>, &RigidFunctional<D>)> {
        self.ends.iter().enumerate().map(|(place, (body, side))| (*body, side, self.pushes.get(place).unwrap_or(side)))
    }

    /// The force and torque on each body of a force along the row.
    pub fn wrenches(&self, force: f64) -> impl Iterator<Item = (usize, RigidFunctional<D>)> {
        self.sides().map(move |(body, _, push)| (body, RigidFunctional { direction: push.direction * force, turn: push.turn * force }))
    }

    /// The same row for a coordinate that is a length, whatever it was: its gradient by centres is as large as that of the distance of two bodies. The
    /// residuals of rows of lengths, curvatures and areas then have one unit, and the force is a force.
    pub fn as_length(self) -> Row<D> {
        let square: f64 = self.ends.iter().map(|(_, side)| side.direction.norm_squared()).sum();
        if square == 0.0 {
            return self;
        }
        let scale = (2.0 / square).sqrt();
        let scaled = |(body, side): (usize, RigidFunctional<D>)| {
            (body, RigidFunctional { direction: side.direction * scale, turn: side.turn * scale })
        };
        let ends = self.ends.into_iter().map(scaled).collect();
        Row::new(ends, self.rate * scale, self.compliance * scale * scale)
    }

    /// What a force along the coordinate adds to the stress, times volume: minus the first moment of the forces on bodies, of which torques are the
    /// antisymmetric part.
    pub fn stress(&self, force: f64, centers: &[SVector<f64, D>]) -> SMatrix<f64, D, D> {
        let moment = |(body, push): (usize, RigidFunctional<D>)| push.direction * centers[body].transpose() + push.turn * 0.5;
        -self.wrenches(force).map(moment).sum::<SMatrix<f64, D, D>>()
    }

    /// What rows with these forces add to the stress, times volume; nothing without rows.
    pub fn total_stress(rows: &[Row<D>], forces: &[f64], centers: &[SVector<f64, D>]) -> Option<SMatrix<f64, D, D>> {
        rows.iter().zip(forces).map(|(row, &force)| row.stress(force, centers)).reduce(|sum, stress| sum + stress)
    }
}
