//! A body in a frame.

use nalgebra::{SMatrix, SVector};

/// A body at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameBody<const D: usize> {
    /// Its number among all bodies, from 0.
    pub number: usize,
    /// Centre; a periodic image of it in the box is stored.
    pub center: SVector<f64, D>,
    /// Radius.
    pub radius: f64,
    /// Velocity of the centre; that of the same image is stored.
    pub velocity: SVector<f64, D>,
    /// Skew matrix of the rotation rate.
    pub spin: SMatrix<f64, D, D>,
    /// Rotation since the start.
    pub rotation: SMatrix<f64, D, D>,
    /// Force of the fluid.
    pub force: SVector<f64, D>,
    /// Torque of the fluid, a skew matrix.
    pub torque: SMatrix<f64, D, D>,
    /// Number of bodies and walls that it touches.
    pub contacts: usize,
}
