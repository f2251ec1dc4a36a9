//! Relaxation of overlaps: balls repel where they are closer than required, until none are.
//!
//! The energy `sum (target - distance)^2 / 2` over pairs closer than their target falls by FIRE
//! (Bitzek et al. 2006, doi:10.1103/PhysRevLett.97.170201). The target is a little larger than the
//! distance required, so that the required distance is reached in finitely many steps. Walls are hard.
//! The unit of mass of a ball is its number of neighbours, which makes all radii equally stiff.

use nalgebra::SVector;

use super::{
    fire::Fire,
    share::{BLOCK, BodyShare, NeededCenters},
};
use crate::{
    geometry::{Ball, Domain, Pair, near_pairs},
    linalg::ROUNDING,
};

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
    /// Which of the balls this rank moves.
    pub share: BodyShare<'a>,
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
    /// Moves the balls until no two overlap; collective.
    ///
    /// Returns whether that succeeded before it stalled or the effort was spent.
    pub fn relax(&mut self) -> bool {
        let relaxed = self.descend();
        self.share.gather(&mut self.centers);
        relaxed
    }

    fn descend(&mut self) -> bool {
        let mut fire = Fire::new(self.share.own.len());
        self.confine(&mut fire.velocities, 0.0);
        self.share.gather(&mut self.centers);
        let mut contacts = Contacts::new(self);
        let mut earlier_energy = f64::INFINITY;
        let mut step = 0;
        while self.spend(contacts.work) {
            let state = contacts.repel(&self.centers, &mut fire.forces, &self.share);
            if state.satisfied {
                return true;
            }
            if step % PATIENCE == 0 {
                if state.energy > STALLED * earlier_energy {
                    return false;
                }
                earlier_energy = state.energy;
            }
            fire.advance(&mut self.centers[self.share.own.clone()], &contacts.masses, &self.share);
            self.confine(&mut fire.velocities, 0.0);
            self.refresh(&mut contacts);
            step += 1;
        }
        false
    }

    /// Lets the balls fly and collide for some steps, without loss of energy, from velocities of this rank's balls; collective.
    pub fn stir(&mut self, mut velocities: Vec<SVector<f64, D>>, steps: usize) {
        let mut forces = vec![SVector::zeros(); self.share.own.len()];
        let mut contacts = Contacts::new(self);
        for _ in 0..steps {
            if !self.spend(contacts.work) {
                break;
            }
            contacts.repel(&self.centers, &mut forces, &self.share);
            let own = self.centers[self.share.own.clone()].iter_mut().zip(&mut velocities);
            for ((center, velocity), (force, &mass)) in own.zip(forces.iter().zip(&contacts.masses)) {
                *velocity += force * (STIRRING_STEP / mass);
                *center += *velocity * STIRRING_STEP;
            }
            self.confine(&mut velocities, 1.0);
            self.refresh(&mut contacts);
        }
        self.share.gather(&mut self.centers);
    }

    /// Takes work from the effort left; returns whether any is left.
    fn spend(&mut self, work: u64) -> bool {
        self.effort = self.effort.saturating_sub(work);
        self.effort > 0
    }

    /// Moves balls of this rank that reach into a wall out of it; they leave it with `bounce` times their speed.
    fn confine(&mut self, velocities: &mut [SVector<f64, D>], bounce: f64) {
        for axis in (0..D).filter(|&axis| !self.domain.periodic(axis)) {
            let size = self.domain.size[axis];
            for (body, velocity) in self.share.own.clone().zip(velocities.iter_mut()) {
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

    /// Makes the centres of other ranks' balls known, and finds the pairs anew if balls have moved too far for the old ones.
    fn refresh(&mut self, contacts: &mut Contacts<D>) {
        if contacts.outdated(&self.centers, &self.share) {
            self.spend(SEARCH_WORK * contacts.work);
            self.share.gather(&mut self.centers);
            *contacts = Contacts::new(self);
        } else {
            contacts.needed.update(&self.share, &mut self.centers);
        }
    }

    /// A ball with the radius that it must keep clear now.
    fn ball(&self, body: usize) -> Ball<D> {
        Ball { center: self.centers[body], radius: self.radii[body] * if body < self.movable { self.scale } else { 1.0 } }
    }

    /// The balls of this rank and all that may be within reach of one of them, by their numbers, in order.
    fn near_own(&self, reach: f64) -> Vec<usize> {
        let axis = D - 1;
        let (mut lower, mut upper) = (f64::INFINITY, f64::NEG_INFINITY);
        for ball in self.share.own.clone().map(|body| self.ball(body)) {
            lower = lower.min(ball.center[axis] - ball.radius);
            upper = upper.max(ball.center[axis] + ball.radius);
        }
        let near = |&body: &usize| {
            let ball = self.ball(body);
            let range = (1.0 + ROUNDING) * (ball.radius + reach);
            let above = ball.center[axis] - (lower - range);
            let above = if self.domain.periodic(axis) { above.rem_euclid(self.domain.size[axis]) } else { above };
            self.share.own.contains(&body) || (0.0..=upper - lower + 2.0 * range).contains(&above)
        };
        (0..self.centers.len()).filter(near).collect()
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

impl<const D: usize> PackingContact<D> {
    /// A pair of some balls whose numbers are `bodies`.
    fn new(bodies: &[usize], balls: &[Ball<D>], pair: &Pair<D>, margin: f64) -> Self {
        let (first, second) = (&balls[pair.first], &balls[pair.second]);
        let required = first.radius + second.radius;
        Self {
            first: bodies[pair.first],
            second: bodies[pair.second],
            offset: pair.separation - (second.center - first.center),
            required,
            target: required * (1.0 + margin),
        }
    }
}

/// What the overlaps amount to.
struct PackingState {
    energy: f64,
    satisfied: bool,
}

/// Pairs with a ball of this rank near enough to overlap before the balls have moved by half the skin.
struct Contacts<const D: usize> {
    list: Vec<PackingContact<D>>,
    /// Masses of this rank's balls.
    masses: Vec<f64>,
    /// Centres of this rank's balls when the pairs were found.
    origins: Vec<SVector<f64, D>>,
    skin: f64,
    /// Work of one step of all ranks, in pair evaluations.
    work: u64,
    needed: NeededCenters,
}

impl<const D: usize> Contacts<D> {
    /// Collective; the centres of all balls must be known.
    fn new(packing: &Packing<D>) -> Self {
        let share = &packing.share;
        let radius = |body: usize| packing.ball(body).radius;
        let mean = (0..packing.movable).map(radius).sum::<f64>() / packing.movable as f64;
        let skin = SKIN * mean;
        let largest = (0..packing.centers.len()).map(radius).fold(0.0, f64::max);
        let reach = skin + 2.0 * packing.margin * largest;
        let bodies = packing.near_own(reach);
        let balls: Vec<Ball<D>> = bodies.iter().map(|&body| packing.ball(body)).collect();
        let own = |body: usize| share.own.contains(&bodies[body]);
        let mut pairs = near_pairs(packing.domain, &balls, reach);
        pairs.retain(|pair| pair.first != pair.second && (own(pair.first) || own(pair.second)));
        let mut list = Vec::with_capacity(pairs.len());
        list.extend(pairs.iter().map(|pair| PackingContact::new(&bodies, &balls, pair, packing.margin)));
        let mut masses = vec![1.0; share.own.len()];
        let ends = || list.iter().flat_map(|contact: &PackingContact<D>| [contact.first, contact.second]);
        ends().filter_map(|body| share.place(body)).for_each(|place| masses[place] += 1.0);
        let mut needed: Vec<usize> = ends().filter(|&body| body < packing.movable && share.place(body).is_none()).collect();
        needed.sort_unstable();
        needed.dedup();
        let count = share.count(list.iter().filter(|contact| share.own.contains(&contact.first)).count());
        Self {
            masses,
            origins: packing.centers[share.own.clone()].to_vec(),
            skin,
            work: (count + packing.movable) as u64 + STEP_WORK,
            needed: NeededCenters::new(share, needed),
            list,
        }
    }

    /// Fills the forces on this rank's balls; returns the energy and whether all pairs are as far apart as required. Collective.
    fn repel(&self, centers: &[SVector<f64, D>], forces: &mut [SVector<f64, D>], share: &BodyShare) -> PackingState {
        forces.fill(SVector::zeros());
        // energy and overlaps of each block
        let mut sums = vec![[0.0; 2]; share.blocks()];
        for contact in &self.list {
            let separation = centers[contact.second] - centers[contact.first] + contact.offset;
            let square = separation.norm_squared();
            if square >= contact.target * contact.target {
                continue;
            }
            let distance = square.sqrt();
            let overlap = contact.target - distance;
            let push = if distance > 0.0 {
                separation * (overlap / distance)
            } else {
                SVector::from_fn(|axis, _| if axis == 0 { overlap } else { 0.0 })
            };
            if let Some(first) = share.place(contact.first) {
                let [energy, overlaps] = &mut sums[first / BLOCK];
                *energy += 0.5 * overlap * overlap;
                *overlaps += f64::from(distance < contact.required);
                forces[first] -= push;
            }
            if let Some(second) = share.place(contact.second) {
                forces[second] += push;
            }
        }
        let [energy, overlaps] = share.sum_of_blocks(&sums);
        PackingState { energy, satisfied: overlaps == 0.0 }
    }

    /// Whether a ball of any rank has moved too far; collective.
    fn outdated(&self, centers: &[SVector<f64, D>], share: &BodyShare) -> bool {
        let farthest = 0.25 * self.skin * self.skin;
        let mut moves = self.origins.iter().zip(&centers[share.own.clone()]).map(|(origin, center)| center - origin);
        share.count(usize::from(moves.any(|moved| moved.norm_squared() > farthest))) > 0
    }
}
