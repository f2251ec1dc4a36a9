//! FIRE: balls slide downhill with inertia, and stop whenever they go uphill.
//!
//! The fast inertial relaxation engine of Bitzek et al. 2006 (doi:10.1103/PhysRevLett.97.170201).
//! It knows forces and masses, not where they come from.

use nalgebra::SVector;

use super::share::BodyShare;

/// Longest time step; the stiffest mode is stable up to 1.4.
const LONGEST_STEP: f64 = 0.9;

/// State of the fast inertial relaxation engine.
pub(super) struct Fire<const D: usize> {
    /// Force on each ball of this rank.
    pub forces: Vec<SVector<f64, D>>,
    /// Velocity of each of them.
    pub velocities: Vec<SVector<f64, D>>,
    /// Time step, adapted.
    dt: f64,
    /// How much of the velocity is turned towards the force.
    steering: f64,
    /// Steps since the energy last rose.
    downhill: usize,
}

impl<const D: usize> Fire<D> {
    /// Starts from rest.
    pub fn new(count: usize) -> Self {
        Self {
            forces: vec![SVector::zeros(); count],
            velocities: vec![SVector::zeros(); count],
            dt: 0.5 * LONGEST_STEP,
            steering: 0.1,
            downhill: 0,
        }
    }

    /// Moves the centres of this rank's balls by one step; collective.
    pub fn advance(&mut self, centers: &mut [SVector<f64, D>], masses: &[f64], share: &BodyShare) {
        let [power] = share.sum(|ball| [self.forces[ball].dot(&self.velocities[ball])]);
        if power >= 0.0 {
            self.hasten();
        } else {
            self.turn_back(centers);
        }
        for (ball, &mass) in masses.iter().enumerate() {
            self.velocities[ball] += self.forces[ball] * (self.dt / mass);
        }
        let [speed_square, force_square] =
            share.sum(|ball| [masses[ball] * self.velocities[ball].norm_squared(), self.forces[ball].norm_squared() / masses[ball]]);
        let ratio = if force_square > 0.0 { (speed_square / force_square).sqrt() } else { 0.0 };
        for (ball, &mass) in masses.iter().enumerate() {
            let along = self.forces[ball] * (ratio / mass);
            let turn = (along - self.velocities[ball]) * self.steering;
            self.velocities[ball] += turn;
            centers[ball] += self.velocities[ball] * self.dt;
        }
    }

    fn hasten(&mut self) {
        self.downhill += 1;
        if self.downhill > 5 {
            self.dt = (1.1 * self.dt).min(LONGEST_STEP);
            self.steering *= 0.99;
        }
    }

    fn turn_back(&mut self, centers: &mut [SVector<f64, D>]) {
        for (center, velocity) in centers.iter_mut().zip(&mut self.velocities) {
            *center -= *velocity * (0.5 * self.dt);
            *velocity = SVector::zeros();
        }
        self.downhill = 0;
        self.dt = (0.5 * self.dt).max(0.02 * LONGEST_STEP);
        self.steering = 0.1;
    }
}
