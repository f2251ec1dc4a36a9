//! Motions that are given and change with time.

use std::{f64::consts::TAU, rc::Rc};

use nalgebra::{SMatrix, SVector};

use super::Twist;

/// Steps of an oscillation that follow it closely enough, a period.
const STEPS_A_PERIOD: f64 = 64.0;

/// Parts of a piece of a path by whose ends it is known how far it leads, and how often the part that leads too far is halved.
const PARTS: usize = 8;
const HALVINGS: usize = 20;

/// Where a body goes from where it starts, at all times.
#[derive(Debug, Clone, PartialEq)]
pub enum Trajectory<const D: usize> {
    /// `amplitude (sin(2 pi frequency t + phase) - sin(phase))`.
    Oscillation {
        /// Of the displacement.
        displacement: SVector<f64, D>,
        /// Of the angle, in radians, as a skew matrix.
        rotation: SMatrix<f64, D, D>,
        /// Periods over time, positive.
        frequency: f64,
        /// In radians.
        phase: f64,
    },
    /// Through given places.
    Path(Path<D>),
}

/// The cubic spline through displacements at given times, at rest before the first one and after the last.
#[derive(Debug, Clone, PartialEq)]
pub struct Path<const D: usize> {
    knots: Vec<Knot<D>>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Knot<const D: usize> {
    time: f64,
    displacement: SVector<f64, D>,
    velocity: SVector<f64, D>,
}

impl<const D: usize> Trajectory<D> {
    /// Displacement and angle (as a skew matrix) since time 0.
    pub fn displacement(&self, time: f64) -> (SVector<f64, D>, SMatrix<f64, D, D>) {
        match self {
            Trajectory::Oscillation { displacement, rotation, frequency, phase } => {
                let part = (TAU * frequency * time + phase).sin() - phase.sin();
                (displacement * part, rotation * part)
            }
            Trajectory::Path(path) => (path.at(time).0, SMatrix::zeros()),
        }
    }

    /// The motion at a time.
    pub fn twist(&self, time: f64) -> Twist<D> {
        match self {
            Trajectory::Oscillation { displacement, rotation, frequency, phase } => {
                let rate = TAU * frequency * (TAU * frequency * time + phase).cos();
                Twist { velocity: displacement * rate, spin: rotation * rate }
            }
            Trajectory::Path(path) => Twist { velocity: path.at(time).1, spin: SMatrix::zeros() },
        }
    }

    /// The motion that, kept up over a step from a time, leads to where the body is at its end.
    pub fn mean_twist(&self, time: f64, step: f64) -> Twist<D> {
        let (now, then) = (self.displacement(time), self.displacement(time + step));
        Twist { velocity: (then.0 - now.0) / step, spin: (then.1 - now.1) / step }
    }

    /// The largest velocity and the largest spin, each along its own components.
    fn fastest(&self) -> Twist<D> {
        match self {
            Trajectory::Oscillation { displacement, rotation, frequency, .. } => {
                Twist { velocity: displacement * (TAU * frequency), spin: rotation * (TAU * frequency) }
            }
            Trajectory::Path(path) => Twist { velocity: path.fastest(), spin: SMatrix::zeros() },
        }
    }
}

impl<const D: usize> Path<D> {
    /// The path through displacements at times that increase; the first one is at time 0.
    pub fn new(places: &[(f64, SVector<f64, D>)]) -> Path<D> {
        let mut knots: Vec<Knot<D>> =
            places.iter().map(|&(time, displacement)| Knot { time, displacement, velocity: SVector::zeros() }).collect();
        let last = knots.len() - 1;
        // rows of continuous acceleration, eliminated from the first to the last inner knot
        let mut eliminated = vec![(0.0, SVector::zeros()); knots.len()];
        for knot in 1..last {
            let [before, after] = [knot - 1, knot].map(|first| 1.0 / (knots[first + 1].time - knots[first].time));
            let way = |first: usize| knots[first + 1].displacement - knots[first].displacement;
            let wanted = (way(knot - 1) * before.powi(2) + way(knot) * after.powi(2)) * 3.0;
            let (upper, known) = eliminated[knot - 1];
            let pivot = 2.0 * (before + after) - before * upper;
            eliminated[knot] = (after / pivot, (wanted - known * before) / pivot);
        }
        for knot in (1..last).rev() {
            let (upper, known) = eliminated[knot];
            knots[knot].velocity = known - knots[knot + 1].velocity * upper;
        }
        Path { knots }
    }

    /// Displacement and velocity at a time.
    fn at(&self, time: f64) -> (SVector<f64, D>, SVector<f64, D>) {
        let next = self.knots.partition_point(|knot| knot.time <= time);
        if next == 0 || next == self.knots.len() {
            return (self.knots[next.saturating_sub(1)].displacement, SVector::zeros());
        }
        let [one, two] = [&self.knots[next - 1], &self.knots[next]];
        let (length, way) = (two.time - one.time, two.displacement - one.displacement);
        let part = (time - one.time) / length;
        let (start, end) = (one.velocity * length, two.velocity * length);
        // in the part of the way to the next knot: start + square + cube
        let (square, cube) = (way * 3.0 - start * 2.0 - end, start + end - way * 2.0);
        let displacement = one.displacement + (start + (square + cube * part) * part) * part;
        (displacement, (start + (square * 2.0 + cube * (3.0 * part)) * part) / length)
    }

    /// The longest time from another on in which the body is never farther than a distance from where it was then; infinite if it never is.
    fn reach(&self, time: f64, distance: f64) -> f64 {
        let start = self.at(time).0;
        let far = |later: f64| (self.at(later).0 - start).norm() > distance;
        let first = self.knots.partition_point(|knot| knot.time <= time).saturating_sub(1);
        let mut near = time;
        for pair in self.knots[first..].windows(2) {
            for part in 1..=PARTS {
                let ahead = pair[0].time + (pair[1].time - pair[0].time) * part as f64 / PARTS as f64;
                if ahead > time && far(ahead) {
                    let halve = |(near, beyond): (f64, f64), _| {
                        let middle = 0.5 * (near + beyond);
                        if far(middle) { (near, middle) } else { (middle, beyond) }
                    };
                    return (0..HALVINGS).fold((near, ahead), halve).1 - time;
                }
                near = near.max(ahead);
            }
        }
        f64::INFINITY
    }

    /// The largest speed along each axis, at and halfway between knots.
    fn fastest(&self) -> SVector<f64, D> {
        let halfway = self.knots.windows(2).map(|pair| self.at(0.5 * (pair[0].time + pair[1].time)).1);
        let all = self.knots.iter().map(|knot| knot.velocity).chain(halfway);
        all.fold(SVector::zeros(), |fastest: SVector<f64, D>, velocity| fastest.sup(&velocity.abs()))
    }
}

/// The trajectories of some of many bodies, each with the number of its body, ascending.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectories<const D: usize>(Vec<(usize, Rc<Trajectory<D>>)>);

impl<const D: usize> Default for Trajectories<D> {
    fn default() -> Self {
        Trajectories(Vec::new())
    }
}

impl<const D: usize> FromIterator<(usize, Rc<Trajectory<D>>)> for Trajectories<D> {
    fn from_iter<I: IntoIterator<Item = (usize, Rc<Trajectory<D>>)>>(all: I) -> Self {
        Trajectories(all.into_iter().collect())
    }
}

impl<const D: usize> Trajectories<D> {
    /// Those of some of the bodies, which are then called by their places among these.
    pub fn of_bodies(&self, bodies: &[usize]) -> Self {
        let of = |(place, number): (usize, &usize)| {
            let own = self.0.iter().find(|(body, _)| body == number);
            own.map(|(_, trajectory)| (place, Rc::clone(trajectory)))
        };
        bodies.iter().enumerate().filter_map(of).collect()
    }

    /// The motions at a time.
    pub fn twists(&self, time: f64) -> impl Iterator<Item = (usize, Twist<D>)> {
        self.0.iter().map(move |(body, trajectory)| (*body, trajectory.twist(time)))
    }

    /// Displacements and angles since time 0.
    pub fn displacements(&self, time: f64) -> impl Iterator<Item = (usize, (SVector<f64, D>, SMatrix<f64, D, D>))> {
        self.0.iter().map(move |(body, trajectory)| (*body, trajectory.displacement(time)))
    }

    /// The motions that lead to where bodies are after a step from a time.
    pub fn mean_twists(&self, time: f64, step: f64) -> impl Iterator<Item = (usize, Twist<D>)> {
        self.0.iter().map(move |(body, trajectory)| (*body, trajectory.mean_twist(time, step)))
    }

    /// The fastest motions.
    pub fn fastest(&self) -> impl Iterator<Item = (usize, Twist<D>)> {
        self.0.iter().map(|(body, trajectory)| (*body, trajectory.fastest()))
    }

    /// The longest automatic step from a time that follows oscillations, and in which paths lead each body no farther than it may go; infinite without any.
    pub fn longest_step(&self, time: f64, farthest: impl Fn(usize) -> f64) -> f64 {
        let step = |(body, trajectory): &(usize, Rc<Trajectory<D>>)| match &**trajectory {
            Trajectory::Oscillation { frequency, .. } => 1.0 / (STEPS_A_PERIOD * frequency),
            Trajectory::Path(path) => path.reach(time, farthest(*body)),
        };
        self.0.iter().map(step).fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Vector2, Vector3};

    use super::{super::skew, *};

    fn path() -> Trajectory<2> {
        let places = [(0.0, 0.0, 0.0), (0.5, 0.3, 1.0), (1.5, -0.2, 0.4), (1.75, 0.1, 0.1)];
        Trajectory::Path(Path::new(&places.map(|(time, x, y)| (time, Vector2::new(x, y)))))
    }

    #[test]
    fn a_step_along_a_path_goes_as_far_as_it_may_and_no_farther() {
        let rests_and_goes = Path::new(&[(0.0, 0.0), (1.0, 0.0), (1.2, 3.0), (2.0, 3.5)].map(|(time, x)| (time, Vector2::new(x, 0.0))));
        for (time, distance) in [(0.0, 0.1), (0.0, 2.0), (0.9, 0.5), (1.1, 0.2)] {
            let step = rests_and_goes.reach(time, distance);
            let gone = |later: f64| (rests_and_goes.at(later).0 - rests_and_goes.at(time).0).norm();
            assert!((gone(time + step) - distance).abs() < 1e-4, "{time} {distance}: {step}");
            assert!((0..200).all(|part| gone(time + step * f64::from(part) / 200.0) <= distance));
        }
        assert_eq!(rests_and_goes.reach(1.9, 1.0), f64::INFINITY);
        assert_eq!(rests_and_goes.reach(3.0, 0.1), f64::INFINITY);
    }

    #[test]
    fn a_path_goes_through_its_places_and_rests_before_and_after() {
        let path = path();
        for (time, place) in [(0.5, Vector2::new(0.3, 1.0)), (1.5, Vector2::new(-0.2, 0.4)), (1.75, Vector2::new(0.1, 0.1))] {
            assert!((path.displacement(time).0 - place).norm() < 1e-14);
        }
        for time in [0.0, 1.75, 2.5] {
            assert_eq!(path.twist(time).velocity.norm(), 0.0);
        }
        assert_eq!(path.displacement(9.0).0, path.displacement(1.75).0);
    }

    #[test]
    fn velocities_are_rates_of_displacement_and_accelerations_do_not_jump() {
        let spin = skew::<3>(&[0.1, 0.2, -0.3]);
        let swing = Trajectory::Oscillation { displacement: Vector3::new(0.2, 0.0, 1.0), rotation: spin, frequency: 0.7, phase: 0.4 };
        let (small, path) = (1e-6, path());
        for time in [0.1, 0.7, 1.2] {
            let (rate, twist) = (swing.mean_twist(time - small, 2.0 * small), swing.twist(time));
            assert!((rate.velocity - twist.velocity).norm() < 1e-8 && (rate.spin - twist.spin).norm() < 1e-8);
            assert!((path.mean_twist(time - small, 2.0 * small).velocity - path.twist(time).velocity).norm() < 1e-8);
        }
        for knot in [0.5, 1.5] {
            let acceleration = |time: f64| (path.twist(time + small).velocity - path.twist(time).velocity) / small;
            assert!((acceleration(knot) - acceleration(knot - small)).norm() < 1e-3);
        }
        assert_eq!(swing.displacement(0.0).0.norm(), 0.0);
    }
}
