//! Relaxation of overlaps: balls repel where they are closer than required, until none are.
//!
//! The energy `sum (target - distance)^2 / 2` over pairs closer than their target falls by FIRE
//! (Bitzek et al. 2006, doi:10.1103/PhysRevLett.97.170201). The target is a little larger than the
//! distance required, so that the required distance is reached in finitely many steps. Walls are hard.
//! The unit of mass of a ball is its number of neighbours, which makes all radii equally stiff.

use nalgebra::SVector;

use crate::geometry::{Ball, Domain, near_pairs};

/// How much larger than the required distance the target is.
const MARGIN: f64 = 0.01;
/// Longest time step; the stiffest mode is stable up to 1.4.
const LONGEST_STEP: f64 = 0.9;
/// Steps between two looks at the progress.
const PATIENCE: usize = 200;
/// Energy left after that many steps, as a fraction, above which relaxation has stalled.
const STALLED: f64 = 0.7;
/// Work to find all pairs, in evaluations of one pair per pair found.
const SEARCH_WORK: u64 = 20;

/// Balls on their way to a packing: `movable` ones, then obstacles.
pub(super) struct Crowd<'a, const D: usize> {
    /// The box.
    pub domain: &'a Domain<D>,
    /// Centres, not moved into the box.
    pub centers: Vec<SVector<f64, D>>,
    /// Radii with half the gap required between balls.
    pub radii: Vec<f64>,
    /// Radii with the gap required to walls.
    pub wall_radii: Vec<f64>,
    /// How many of the balls move.
    pub movable: usize,
    /// Pair evaluations that may still be spent.
    pub effort: u64,
}

impl<const D: usize> Crowd<'_, D> {
    /// Moves the balls until no two overlap, with the radii of movable ones times `scale`.
    ///
    /// Returns whether that succeeded before it stalled or the effort was spent.
    pub fn relax(&mut self, scale: f64) -> bool {
        self.confine(scale, None);
        let mut contacts = Contacts::new(self, scale);
        let mut fire = Fire::new(self.movable);
        let mut earlier_energy = f64::INFINITY;
        for step in 0.. {
            let state = contacts.repel(&self.centers, &mut fire.forces);
            if state.satisfied {
                return true;
            }
            if step % PATIENCE == 0 {
                if state.energy > STALLED * earlier_energy {
                    return false;
                }
                earlier_energy = state.energy;
            }
            let work = (contacts.list.len() + self.movable) as u64;
            if !self.spend(work) {
                return false;
            }
            fire.advance(&mut self.centers, &contacts.masses);
            self.confine(scale, Some(&mut fire.velocities));
            if contacts.outdated(&self.centers) {
                self.spend(SEARCH_WORK * work);
                contacts = Contacts::new(self, scale);
            }
        }
        false
    }

    /// Takes work from the effort left; returns whether any is left.
    fn spend(&mut self, work: u64) -> bool {
        self.effort = self.effort.saturating_sub(work);
        self.effort > 0
    }

    /// Moves balls that reach into a wall out of it, and stops them there.
    pub fn confine(&mut self, scale: f64, mut velocities: Option<&mut Vec<SVector<f64, D>>>) {
        for axis in (0..D).filter(|&axis| !self.domain.periodic(axis)) {
            for body in 0..self.movable {
                let size = self.domain.size[axis];
                let margin = (scale * self.wall_radii[body]).min(size / 2.0);
                let position = self.centers[body][axis];
                self.centers[body][axis] = position.clamp(margin, size - margin);
                if let Some(velocities) = velocities.as_mut()
                    && self.centers[body][axis] != position
                {
                    velocities[body][axis] = 0.0;
                }
            }
        }
    }
}

/// Two balls that may come to overlap.
struct Contact<const D: usize> {
    first: usize,
    second: usize,
    /// What the periodic image adds to the difference of the centres.
    offset: SVector<f64, D>,
    /// Least distance between the centres.
    required: f64,
}

/// What the overlaps amount to.
struct State {
    energy: f64,
    satisfied: bool,
}

/// Pairs near enough to overlap before the balls have moved by half the skin.
struct Contacts<const D: usize> {
    list: Vec<Contact<D>>,
    masses: Vec<f64>,
    /// Centres when the pairs were found.
    origins: Vec<SVector<f64, D>>,
    skin: f64,
}

impl<const D: usize> Contacts<D> {
    fn new(crowd: &Crowd<D>, scale: f64) -> Self {
        let factor = |body| if body < crowd.movable { scale } else { 1.0 };
        let required: Vec<_> = (0..crowd.centers.len()).map(|body| crowd.radii[body] * factor(body)).collect();
        let balls: Vec<_> =
            crowd.centers.iter().zip(&required).map(|(&center, radius)| Ball { center, radius: radius * (1.0 + MARGIN) }).collect();
        let mean = required[..crowd.movable].iter().sum::<f64>() / crowd.movable as f64;
        let skin = 0.4 * mean;
        let mut masses = vec![1.0; crowd.movable];
        let mut list = Vec::new();
        for pair in near_pairs(crowd.domain, &balls, skin) {
            let (first, second) = (pair.first, pair.second);
            if first == second || first >= crowd.movable {
                continue;
            }
            list.push(Contact {
                first,
                second,
                offset: pair.separation - (balls[second].center - balls[first].center),
                required: required[first] + required[second],
            });
            masses[first] += 1.0;
            if second < crowd.movable {
                masses[second] += 1.0;
            }
        }
        Self { list, masses, origins: crowd.centers[..crowd.movable].to_vec(), skin }
    }

    /// Fills the forces; returns the energy and whether all pairs are as far apart as required.
    fn repel(&self, centers: &[SVector<f64, D>], forces: &mut [SVector<f64, D>]) -> State {
        forces.fill(SVector::zeros());
        let mut state = State { energy: 0.0, satisfied: true };
        for contact in &self.list {
            let separation = centers[contact.second] - centers[contact.first] + contact.offset;
            let target = contact.required * (1.0 + MARGIN);
            let square = separation.norm_squared();
            if square >= target * target {
                continue;
            }
            let distance = square.sqrt();
            let overlap = target - distance;
            state.energy += 0.5 * overlap * overlap;
            state.satisfied &= distance >= contact.required;
            let push = if distance > 0.0 {
                separation * (overlap / distance)
            } else {
                SVector::from_fn(|axis, _| if axis == 0 { overlap } else { 0.0 })
            };
            forces[contact.first] -= push;
            if let Some(force) = forces.get_mut(contact.second) {
                *force += push;
            }
        }
        state
    }

    fn outdated(&self, centers: &[SVector<f64, D>]) -> bool {
        let farthest = 0.25 * self.skin * self.skin;
        let mut moves = self.origins.iter().zip(centers).map(|(origin, center)| center - origin);
        moves.any(|moved| moved.norm_squared() > farthest)
    }
}

/// State of the fast inertial relaxation engine.
struct Fire<const D: usize> {
    forces: Vec<SVector<f64, D>>,
    velocities: Vec<SVector<f64, D>>,
    dt: f64,
    /// How much of the velocity is turned towards the force.
    steering: f64,
    /// Steps since the energy last rose.
    downhill: usize,
}

impl<const D: usize> Fire<D> {
    fn new(count: usize) -> Self {
        Self {
            forces: vec![SVector::zeros(); count],
            velocities: vec![SVector::zeros(); count],
            dt: 0.5 * LONGEST_STEP,
            steering: 0.1,
            downhill: 0,
        }
    }

    /// Moves the centres by one step.
    fn advance(&mut self, centers: &mut [SVector<f64, D>], masses: &[f64]) {
        let power: f64 = self.forces.iter().zip(&self.velocities).map(|(f, v)| f.dot(v)).sum();
        if power >= 0.0 {
            self.hasten();
        } else {
            self.turn_back(centers);
        }
        let mut speed_square = 0.0;
        let mut force_square = 0.0;
        for (body, &mass) in masses.iter().enumerate() {
            self.velocities[body] += self.forces[body] * (self.dt / mass);
            speed_square += mass * self.velocities[body].norm_squared();
            force_square += self.forces[body].norm_squared() / mass;
        }
        let ratio = if force_square > 0.0 { (speed_square / force_square).sqrt() } else { 0.0 };
        for (body, &mass) in masses.iter().enumerate() {
            let along = self.forces[body] * (ratio / mass);
            let turn = (along - self.velocities[body]) * self.steering;
            self.velocities[body] += turn;
            centers[body] += self.velocities[body] * self.dt;
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
