//! Relaxation of overlaps: balls repel where they are closer than required, until none are.
//!
//! The energy `sum (target - distance)^2 / 2` over pairs closer than their target falls by FIRE
//! (Bitzek et al. 2006, doi:10.1103/PhysRevLett.97.170201). The target is a little larger than the
//! distance required, so that the required distance is reached in finitely many steps. Walls are hard.
//! The unit of mass of a ball is its number of neighbours, which makes all radii equally stiff.

use nalgebra::SVector;

use super::fire::Fire;
use crate::geometry::{Ball, Domain, Pair, near_pairs};

/// Time step of the collisions while stirring.
const STIRRING_STEP: f64 = 0.4;
/// Steps between two looks at the progress.
const PATIENCE: usize = 200;
/// Energy left after that many steps, as a fraction, above which relaxation has stalled.
const STALLED: f64 = 0.7;
/// Distance over which pairs are found before they touch, in mean radii.
const SKIN: f64 = 0.4;
/// Work of a step besides its pairs, and work to find a pair, in evaluations of one pair.
const STEP_WORK: u64 = 20;
const SEARCH_WORK: u64 = 20;

/// Balls on their way to a packing: `movable` ones, then obstacles.
pub(super) struct Packing<'a, const D: usize> {
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
    /// Factor on the radii of the movable balls.
    pub scale: f64,
    /// How much larger than the required distance the target is, as a fraction.
    pub margin: f64,
    /// Pair evaluations that may still be spent.
    pub effort: u64,
}

impl<const D: usize> Packing<'_, D> {
    /// Moves the balls until no two overlap.
    ///
    /// Returns whether that succeeded before it stalled or the effort was spent.
    pub fn relax(&mut self) -> bool {
        let mut fire = Fire::new(self.movable);
        self.confine(&mut fire.velocities, 0.0);
        let mut contacts = Contacts::new(self);
        let mut earlier_energy = f64::INFINITY;
        let mut step = 0;
        while self.spend(contacts.work()) {
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
            fire.advance(&mut self.centers, &contacts.masses);
            self.confine(&mut fire.velocities, 0.0);
            self.refresh(&mut contacts);
            step += 1;
        }
        false
    }

    /// Lets the balls fly and collide for some steps, without loss of energy.
    pub fn stir(&mut self, mut velocities: Vec<SVector<f64, D>>, steps: usize) {
        let mut forces = vec![SVector::zeros(); self.movable];
        let mut contacts = Contacts::new(self);
        for _ in 0..steps {
            if !self.spend(contacts.work()) {
                return;
            }
            contacts.repel(&self.centers, &mut forces);
            for (body, &mass) in contacts.masses.iter().enumerate() {
                velocities[body] += forces[body] * (STIRRING_STEP / mass);
                self.centers[body] += velocities[body] * STIRRING_STEP;
            }
            self.confine(&mut velocities, 1.0);
            self.refresh(&mut contacts);
        }
    }

    /// Takes work from the effort left; returns whether any is left.
    fn spend(&mut self, work: u64) -> bool {
        self.effort = self.effort.saturating_sub(work);
        self.effort > 0
    }

    /// Moves balls that reach into a wall out of it; they leave it with `bounce` times their speed.
    fn confine(&mut self, velocities: &mut [SVector<f64, D>], bounce: f64) {
        for axis in (0..D).filter(|&axis| !self.domain.periodic(axis)) {
            let size = self.domain.size[axis];
            for (body, velocity) in velocities.iter_mut().enumerate() {
                let nearest = (self.scale * self.wall_radii[body]).min(size / 2.0);
                let position = self.centers[body][axis];
                let allowed = position.clamp(nearest, size - nearest);
                if allowed != position {
                    self.centers[body][axis] = allowed;
                    velocity[axis] *= -bounce;
                }
            }
        }
    }

    /// Finds the pairs anew if balls have moved too far for the old ones.
    fn refresh(&mut self, contacts: &mut Contacts<D>) {
        if contacts.outdated(&self.centers) {
            self.spend(SEARCH_WORK * contacts.work());
            *contacts = Contacts::new(self);
        }
    }

    /// The balls with the radii they must keep clear now.
    fn balls(&self) -> Vec<Ball<D>> {
        let ball =
            |body| Ball { center: self.centers[body], radius: self.radii[body] * if body < self.movable { self.scale } else { 1.0 } };
        (0..self.centers.len()).map(ball).collect()
    }
}

/// Two balls that may come to overlap.
struct PackingContact<const D: usize> {
    first: usize,
    second: usize,
    /// What the periodic image adds to the difference of the centres.
    offset: SVector<f64, D>,
    /// Least distance between the centres.
    required: f64,
    /// Distance at which they stop to repel, a little larger.
    target: f64,
}

/// What the overlaps amount to.
struct PackingState {
    energy: f64,
    satisfied: bool,
}

/// Pairs near enough to overlap before the balls have moved by half the skin.
struct Contacts<const D: usize> {
    list: Vec<PackingContact<D>>,
    masses: Vec<f64>,
    /// Centres when the pairs were found.
    origins: Vec<SVector<f64, D>>,
    skin: f64,
}

impl<const D: usize> Contacts<D> {
    fn new(crowd: &Packing<D>) -> Self {
        let balls = crowd.balls();
        let mean = balls[..crowd.movable].iter().map(|ball| ball.radius).sum::<f64>() / crowd.movable as f64;
        let skin = SKIN * mean;
        let mut contacts =
            Self { list: Vec::new(), masses: vec![1.0; crowd.movable], origins: crowd.centers[..crowd.movable].to_vec(), skin };
        let largest = balls.iter().map(|ball| ball.radius).fold(0.0, f64::max);
        for pair in near_pairs(crowd.domain, &balls, skin + 2.0 * crowd.margin * largest) {
            if pair.first != pair.second && pair.first < crowd.movable {
                contacts.push(&balls, &pair, crowd.margin);
            }
        }
        contacts
    }

    fn push(&mut self, balls: &[Ball<D>], pair: &Pair<D>, margin: f64) {
        let (first, second) = (&balls[pair.first], &balls[pair.second]);
        let required = first.radius + second.radius;
        self.list.push(PackingContact {
            first: pair.first,
            second: pair.second,
            offset: pair.separation - (second.center - first.center),
            required,
            target: required * (1.0 + margin),
        });
        self.masses[pair.first] += 1.0;
        if let Some(mass) = self.masses.get_mut(pair.second) {
            *mass += 1.0;
        }
    }

    /// Work of one step, in pair evaluations.
    fn work(&self) -> u64 {
        (self.list.len() + self.masses.len()) as u64 + STEP_WORK
    }

    /// Fills the forces; returns the energy and whether all pairs are as far apart as required.
    fn repel(&self, centers: &[SVector<f64, D>], forces: &mut [SVector<f64, D>]) -> PackingState {
        forces.fill(SVector::zeros());
        let mut state = PackingState { energy: 0.0, satisfied: true };
        for contact in &self.list {
            let separation = centers[contact.second] - centers[contact.first] + contact.offset;
            let square = separation.norm_squared();
            if square >= contact.target * contact.target {
                continue;
            }
            let distance = square.sqrt();
            let overlap = contact.target - distance;
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
