//! Profiles across an axis of the box: solid fraction, velocities of fluid and bodies, and the stress of bodies, in slices.
//!
//! A slice holds of each ball what the planes at its ends cut out of it, so that the fraction is exact. The velocity of bodies is the mean over that solid,
//! spin included; that of the fluid the mean over cells whose centre no body holds. The particle stress is
//!
//! ```text
//! sum_i (part of body i in the slice) S_i / V  -  sum (part of a contact's line of centres in the slice) (F r + r F) / 2 V
//! ```
//!
//! with the stresslets `S_i` of the flow, lubrication included, and the forces `F` of contacts, friction included, between centres `r` apart; `V` is the
//! volume of the slice. Stresslets have no trace. Bonds and forces at a distance are left out.

use std::f64::consts::PI;

use nalgebra::{SMatrix, SVector};

use crate::{
    geometry::{Ball, Domain},
    interaction::stress_of_pair,
};

/// Most slices across an axis.
pub const MOST_SLICES: usize = 200;

/// Width of a slice, in radii.
const WIDTH: f64 = 0.5;

/// Where slices lie, and how velocities differ from one box to the next.
#[derive(Debug, Clone)]
pub struct Slices<const D: usize> {
    domain: Domain<D>,
    /// The axis that they cut.
    pub axis: usize,
    /// Their number.
    pub count: usize,
    /// By how much the velocity grows from a box to the next along y.
    jump: SVector<f64, D>,
}

/// A body as a profile sees it.
#[derive(Debug, Clone, Copy)]
pub struct ProfileBody<const D: usize> {
    /// The body, in the box or followed out of it.
    pub ball: Ball<D>,
    /// Its velocity.
    pub velocity: SVector<f64, D>,
    /// Its spin, a skew matrix.
    pub spin: SMatrix<f64, D, D>,
    /// First moment of the traction of the fluid on it, without trace.
    pub stresslet: SMatrix<f64, D, D>,
}

/// A contact as a profile sees it.
#[derive(Debug, Clone, Copy)]
pub struct ProfileContact<const D: usize> {
    /// Centre of the body.
    pub from: SVector<f64, D>,
    /// Unit vector to the partner.
    pub normal: SVector<f64, D>,
    /// Distance from the body's centre to that of the partner, or to the wall.
    pub separation: f64,
    /// The force on the partner, friction included.
    pub force: SVector<f64, D>,
}

/// Sums over bodies and over cells, slice by slice; those of several ranks add up.
#[derive(Debug, Clone)]
pub struct ProfileSums<const D: usize> {
    slices: Slices<D>,
    /// Volume of solid, momentum of it at unit density, and moments, slice after slice.
    pub solid: Vec<f64>,
    /// Number of fluid cells and the sum of their velocities, slice after slice.
    pub fluid: Vec<f64>,
}

/// Numbers of one slice; what is not there is not a number.
#[derive(Debug, Clone, PartialEq)]
pub struct SliceSample {
    /// Part that bodies fill.
    pub fraction: f64,
    /// Mean velocity of the bodies.
    pub particles: Vec<f64>,
    /// Mean velocity of the fluid.
    pub fluid: Vec<f64>,
    /// Particle stress, row by row.
    pub stress: Vec<f64>,
}

impl<const D: usize> Slices<D> {
    /// Slices across an axis for bodies of a mean radius, no thinner than the cells of a grid.
    pub fn new(domain: &Domain<D>, axis: usize, radius: Option<f64>, cells: Option<usize>, jump: SVector<f64, D>) -> Slices<D> {
        let by_radius = radius.map_or(MOST_SLICES, |radius| (domain.size[axis] / (WIDTH * radius)).round() as usize);
        let count = by_radius.clamp(1, MOST_SLICES).min(cells.unwrap_or(MOST_SLICES));
        Slices { domain: domain.clone(), axis, count, jump }
    }

    fn width(&self) -> f64 {
        self.domain.size[self.axis] / self.count as f64
    }

    /// Volume of a slice.
    fn volume(&self) -> f64 {
        self.domain.volume() / self.count as f64
    }

    /// Middle of a slice.
    pub fn middle(&self, slice: usize) -> f64 {
        (slice as f64 + 0.5) * self.width()
    }

    /// The slice of a place along the axis in the box.
    fn slice(&self, place: f64) -> usize {
        ((place / self.width()).floor().max(0.0) as usize).min(self.count - 1)
    }

    /// The slice in the box of one by its number, and how many boxes away it is; nothing beyond a wall.
    fn within(&self, number: i64) -> Option<(usize, f64)> {
        let count = self.count as i64;
        let inside = (0..count).contains(&number);
        (inside || self.domain.periodic(self.axis)).then(|| (number.rem_euclid(count) as usize, number.div_euclid(count) as f64))
    }

    /// Calls `found` with each slice that an interval of the axis meets, the part of the interval in it, and how many boxes away it is.
    fn cut(&self, from: f64, to: f64, mut found: impl FnMut(usize, [f64; 2], f64)) {
        let width = self.width();
        for number in (from / width).floor() as i64..=(to / width).floor() as i64 {
            let ends = [from.max(number as f64 * width), to.min((number + 1) as f64 * width)];
            if let Some((slice, boxes)) = self.within(number).filter(|_| ends[1] > ends[0]) {
                found(slice, ends, boxes);
            }
        }
    }
}

impl<const D: usize> ProfileSums<D> {
    /// Volume, momentum and moment of a slice.
    const SOLID: usize = 1 + D + D * D;
    const FLUID: usize = 1 + D;

    /// None yet.
    pub fn new(slices: Slices<D>) -> ProfileSums<D> {
        let count = slices.count;
        ProfileSums { slices, solid: vec![0.0; count * Self::SOLID], fluid: vec![0.0; count * Self::FLUID] }
    }

    /// Adds a body.
    pub fn add_body(&mut self, body: &ProfileBody<D>) {
        let ProfileBody { ball, velocity, spin, stresslet } = *body;
        let (axis, jump, solid) = (self.slices.axis, self.slices.jump, &mut self.solid);
        // the image in the box of a body that is followed
        let rows = (ball.center[1] / self.slices.domain.size[1]).floor();
        let velocity = velocity - if self.slices.domain.periodic(1) { jump * rows } else { SVector::zeros() };
        let center = self.slices.domain.wrap(ball.center)[axis];
        self.slices.cut(center - ball.radius, center + ball.radius, |slice, ends, boxes| {
            let [low, high] = ends.map(|end| primitives::<D>(ball.radius, end - center));
            let (volume, moment) = (high[0] - low[0], high[1] - low[1]);
            let row = &mut solid[slice * Self::SOLID..][..Self::SOLID];
            let momentum = (velocity - if axis == 1 { jump * boxes } else { SVector::zeros() }) * volume + spin.column(axis) * moment;
            row[0] += volume;
            (0..D).for_each(|component| row[1 + component] += momentum[component]);
            add(&mut row[1 + D..], &(stresslet * (volume / ball.volume())));
        });
    }

    /// Adds a contact.
    pub fn add_contact(&mut self, contact: &ProfileContact<D>) {
        let ProfileContact { from, normal, separation, force } = *contact;
        let (axis, solid) = (self.slices.axis, &mut self.solid);
        let moment = stress_of_pair(&force, &(normal * separation));
        let start = self.slices.domain.wrap(from)[axis];
        let end = start + normal[axis] * separation;
        let (low, high) = (start.min(end), start.max(end));
        if high - low < 1e-9 * self.slices.width() {
            let slice = self.slices.slice(start);
            return add(&mut solid[slice * Self::SOLID + 1 + D..][..D * D], &moment);
        }
        self.slices.cut(low, high, |slice, ends, _| {
            let part = (ends[1] - ends[0]) / (high - low);
            add(&mut solid[slice * Self::SOLID + 1 + D..][..D * D], &(moment * part));
        });
    }

    /// Adds the velocity of a cell of fluid with its centre at a point of the box.
    pub fn add_fluid(&mut self, point: &SVector<f64, D>, velocity: &SVector<f64, D>) {
        let row = &mut self.fluid[self.slices.slice(point[self.slices.axis]) * Self::FLUID..][..Self::FLUID];
        row[0] += 1.0;
        (0..D).for_each(|component| row[1 + component] += velocity[component]);
    }

    /// What the sums come to; a stress only if there is one to tell.
    pub fn samples(&self, stress: bool) -> Vec<SliceSample> {
        let over = |row: &[f64]| row[1..=D].iter().map(|sum| if row[0] > 0.0 { sum / row[0] } else { f64::NAN }).collect();
        let volume = self.slices.volume();
        let sample = |(solid, fluid): (&[f64], &[f64])| SliceSample {
            fraction: solid[0] / volume,
            particles: over(solid),
            fluid: over(fluid),
            stress: if stress { solid[1 + D..].iter().map(|moment| moment / volume).collect() } else { Vec::new() },
        };
        self.solid.chunks(Self::SOLID).zip(self.fluid.chunks(Self::FLUID)).map(sample).collect()
    }
}

/// Adds a matrix to numbers row by row.
fn add<const D: usize>(row: &mut [f64], matrix: &SMatrix<f64, D, D>) {
    for (place, number) in row.iter_mut().enumerate() {
        *number += matrix[(place / D, place % D)];
    }
}

/// Volume of the ball below a height above its centre, and the first moment of it, each up to a constant.
fn primitives<const D: usize>(radius: f64, height: f64) -> [f64; 2] {
    let (r, h) = (radius, height.clamp(-radius, radius));
    let left = (r * r - h * h).max(0.0);
    if D == 2 {
        [h * left.sqrt() + r * r * (h / r).asin(), -2.0 / 3.0 * left.powf(1.5)]
    } else {
        [PI * (r * r * h - h.powi(3) / 3.0), -0.25 * PI * left * left]
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix2, Vector2, Vector3};

    use super::*;
    use crate::{body::skew, geometry::Axis};

    fn body<const D: usize>(center: SVector<f64, D>, radius: f64) -> ProfileBody<D> {
        ProfileBody { ball: Ball { center, radius }, velocity: SVector::zeros(), spin: SMatrix::zeros(), stresslet: SMatrix::zeros() }
    }

    #[test]
    fn slices_hold_all_of_a_ball_and_no_more() {
        let domain = Domain::<3> { size: Vector3::repeat(4.0), axes: [Axis::Periodic; 3] };
        let mut sums = ProfileSums::new(Slices::new(&domain, 1, Some(1.0), None, SVector::zeros()));
        let ball = body(Vector3::new(1.0, 3.8, 1.0), 1.0);
        sums.add_body(&ball);
        let samples = sums.samples(false);
        let filled: f64 = samples.iter().map(|sample| sample.fraction).sum::<f64>() * 64.0 / 8.0;
        assert!((filled - ball.ball.volume()).abs() < 1e-12 && samples[0].fraction > 0.1 && samples[3].fraction == 0.0);
        assert!(samples[7].stress.is_empty() && samples[7].fluid.iter().all(|velocity| velocity.is_nan()));
    }

    #[test]
    fn a_disk_that_turns_with_a_shear_has_its_profile_across_the_side_of_the_box() {
        let domain = Domain::<2> { size: Vector2::new(4.0, 4.0), axes: [Axis::Periodic; 2] };
        let jump = Vector2::new(4.0, 0.0);
        let center = Vector2::new(1.0, 11.9);
        // rotation that alone moves the surface by y in x
        let turning = ProfileBody { velocity: Vector2::new(center[1], 0.0), spin: skew(&[-1.0]), ..body(center, 0.5) };
        let mut sums = ProfileSums::new(Slices::new(&domain, 1, Some(0.5), None, jump));
        sums.add_body(&turning);
        for (slice, sample) in sums.samples(false).iter().enumerate().filter(|(_, sample)| sample.fraction > 0.0) {
            let off = sample.particles[0] - sums.slices.middle(slice);
            assert!(off.abs() < 0.13 && sample.particles[1].abs() < 1e-12, "slice {slice}: {sample:?}");
        }
    }

    #[test]
    fn the_stress_of_slices_is_that_of_the_box_in_the_mean() {
        let domain = Domain::<2> { size: Vector2::new(4.0, 4.0), axes: [Axis::Periodic; 2] };
        let mut sums = ProfileSums::new(Slices::new(&domain, 0, Some(0.5), None, SVector::zeros()));
        let stresslet = Matrix2::new(1.0, 2.0, 2.0, -1.0);
        sums.add_body(&ProfileBody { stresslet, ..body(Vector2::new(0.1, 1.0), 0.5) });
        let normal = Vector2::new(0.6, 0.8);
        sums.add_contact(&ProfileContact { from: Vector2::new(3.9, 1.0), normal, separation: 1.0, force: normal * 5.0 });
        // with friction
        let (from, normal_up) = (Vector2::new(1.0, 1.0), Vector2::y());
        sums.add_contact(&ProfileContact { from, normal: normal_up, separation: 1.0, force: Vector2::new(0.5, 2.0) });
        let samples = sums.samples(true);
        let mean = |place: usize| samples.iter().map(|sample| sample.stress[place]).sum::<f64>() / samples.len() as f64;
        let expected = (stresslet - normal * normal.transpose() * 5.0 - Matrix2::new(0.0, 0.25, 0.25, 2.0)) / 16.0;
        assert!((0..4).all(|place| (mean(place) - expected[(place / 2, place % 2)]).abs() < 1e-12));
    }
}
