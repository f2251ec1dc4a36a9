//! Bonds of chains: springs between the centres of neighbours, and stiffness against bending.
//!
//! ```text
//! V = k/2 sum (|q_j - q_i| - l)^2  +  b/2 sum e_i . e_k        e_i, e_k: from a body to its two neighbours
//! ```
//!
//! With unit vectors `e_i . e_k = |e_i + e_k|^2 / 2 - 1`, so that both parts are squares of coordinates, zero at rest: lengths, and the curvature
//! `|e_i + e_k|`. A natural angle `t` turns `e_k` back by it first in 2D; in 3D it is the curvature `2 sin(t/2)` at rest. Both coordinates stay
//! as they are when bodies move as one, so that neither part exerts a net force or torque.

use std::{ops::Range, rc::Rc};

use nalgebra::{SMatrix, SVector};

use super::{Conserved, Groups, Hinge, Interaction, Spring, Ties, spring::beyond_rounding};

/// Curvature that has no direction: any across the chain will do.
const STRAIGHT: f64 = 1e-12;

/// A spring between the centres of two bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// The bodies.
    pub bodies: [usize; 2],
    /// Distance of their centres at rest.
    pub length: f64,
    /// Force over change of that distance; infinite for a rod.
    pub stiffness: f64,
}

/// Stiffness of a body's two bonds against bending.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bend {
    /// A neighbour, the body, and the other neighbour.
    pub bodies: [usize; 3],
    /// Energy: torque over angle for small angles is half of it.
    pub stiffness: f64,
    /// Angle in radians by which the second bond turns from the first at rest, counterclockwise; in 3D to any side. 0 for a straight chain.
    pub angle: f64,
}

/// The bonds of all chains.
#[derive(Debug, Clone, PartialEq)]
pub struct Bonds {
    /// Along bonds.
    pub stretches: Rc<Vec<Stretch>>,
    /// Between them.
    pub bends: Rc<Vec<Bend>>,
    /// Between triangles of membranes.
    pub hinges: Rc<Vec<Hinge>>,
    /// What membranes keep.
    pub conserved: Rc<Vec<Conserved>>,
    /// The bodies of each chain.
    pub chains: Rc<Vec<Range<usize>>>,
}

impl<const D: usize> Interaction<D> for Bonds {
    fn name(&self) -> &'static str {
        "bonds"
    }

    fn describe(&self) -> String {
        let (stretches, bends) = (self.stretches.len(), self.bends.iter().filter(|bend| bend.stiffness > 0.0).count());
        let (bends, kept) = (bends + self.hinges.len(), self.conserved.len());
        let kept = if kept == 0 { String::new() } else { format!(", {kept} areas and volumes of cells") };
        format!("{stretches} springs and {bends} angles of chains and cells{kept}, implicit: a row of the coupled system each")
    }

    fn ties(&self) -> Option<&dyn Ties<D>> {
        Some(self)
    }
}

impl<const D: usize> Ties<D> for Bonds {
    fn groups(&self) -> Groups<'_, D> {
        Groups { chains: &self.chains, conserved: &self.conserved, ..Groups::default() }
    }

    fn springs(&self, chain: &Range<usize>, center: &dyn Fn(usize) -> SVector<f64, D>) -> Vec<Spring<D>> {
        let center = |body: usize| center(body);
        let stretches = of_chain(&self.stretches, chain, |stretch| stretch.bodies[0]).iter().map(|stretch| stretch.spring(&center));
        let bends = of_chain(&self.bends, chain, |bend| bend.bodies[1]).iter();
        let bends = bends.filter(|bend| bend.stiffness > 0.0).flat_map(|bend| bend.springs(&center));
        let hinges = of_chain(&self.hinges, chain, |hinge| hinge.ends[0]).iter().map(|hinge| hinge.spring(&center));
        let conserved = of_chain(&self.conserved, chain, |conserved| conserved.bodies.start).iter();
        stretches.chain(bends).chain(hinges).chain(conserved.map(|conserved| conserved.spring(&center))).collect()
    }

    fn bonds(&self) -> Vec<[usize; 2]> {
        self.stretches.iter().map(|stretch| stretch.bodies).collect()
    }
}

/// The part of a list, chain after chain, that belongs to these bodies.
fn of_chain<'a, T>(list: &'a [T], chain: &Range<usize>, body: impl Fn(&T) -> usize) -> &'a [T] {
    let start = list.partition_point(|item| body(item) < chain.start);
    let count = list[start..].partition_point(|item| body(item) < chain.end);
    &list[start..start + count]
}

impl Stretch {
    fn spring<const D: usize>(&self, center: &impl Fn(usize) -> SVector<f64, D>) -> Spring<D> {
        let [one, two] = self.bodies;
        let separation = center(two) - center(one);
        let direction = separation.normalize();
        Spring {
            ends: vec![(one, -direction), (two, direction)],
            value: beyond_rounding(separation.norm() - self.length, self.length),
            stiffness: self.stiffness,
            smooth: true,
        }
    }
}

impl Bend {
    /// The curvature; in space, where it is zero at rest, also that to the other side, so that a straight chain does not give way to any.
    fn springs<const D: usize>(&self, center: &impl Fn(usize) -> SVector<f64, D>) -> Vec<Spring<D>> {
        let [one, middle, other] = self.bodies;
        let (first, second) = (center(one) - center(middle), center(other) - center(middle));
        // in space a turn has no side: only how much is turned counts
        let (back, rest) = if D == 2 { (turn::<D>(-self.angle), 0.0) } else { (SMatrix::identity(), 2.0 * (0.5 * self.angle).sin().abs()) };
        let (toward, onward) = (first.normalize(), second.normalize());
        let curvature = toward + back * onward;
        let value = curvature.norm();
        let direction = if value > STRAIGHT { curvature / value } else { across(&toward) };
        let of_unit = |separation: &SVector<f64, D>, unit: &SVector<f64, D>, direction: SVector<f64, D>| {
            (direction - unit * unit.dot(&direction)) / separation.norm()
        };
        let spring = |direction: SVector<f64, D>, value: f64| {
            let gradients = [of_unit(&first, &toward, direction), of_unit(&second, &onward, back.transpose() * direction)];
            let ends = vec![(one, gradients[0]), (middle, -gradients[0] - gradients[1]), (other, gradients[1])];
            Spring { ends, value: beyond_rounding(value, 1.0), stiffness: 0.5 * self.stiffness, smooth: false }
        };
        let mut springs = vec![spring(direction, value - rest)];
        if D == 3 && rest == 0.0 {
            let side = (onward - toward).cross(&direction);
            springs.push(spring(side.normalize(), 0.0));
        }
        springs
    }
}

/// A rotation by an angle in the plane of the first two axes.
fn turn<const D: usize>(angle: f64) -> SMatrix<f64, D, D> {
    let mut turn = SMatrix::identity();
    (turn[(0, 0)], turn[(1, 1)]) = (angle.cos(), angle.cos());
    (turn[(0, 1)], turn[(1, 0)]) = (-angle.sin(), angle.sin());
    turn
}

/// A direction across another.
fn across<const D: usize>(direction: &SVector<f64, D>) -> SVector<f64, D> {
    let mut other = SVector::zeros();
    other[direction.iamin()] = 1.0;
    (other - direction * direction.dot(&other)).normalize()
}

#[cfg(test)]
mod tests {
    use nalgebra::{Vector2, Vector3};

    use super::*;

    fn springs<const D: usize>(centers: &[SVector<f64, D>], bonds: &Bonds) -> Vec<Spring<D>> {
        bonds.springs(&(0..usize::MAX), &|body: usize| centers[body])
    }

    fn bonds(angle: f64) -> Bonds {
        let stretch = |one: usize| Stretch { bodies: [one, one + 1], length: 1.1, stiffness: 7.0 };
        let bend = |one: usize| Bend { bodies: [one, one + 1, one + 2], stiffness: 3.0, angle };
        Bonds {
            stretches: Rc::new((0..3).map(stretch).collect()),
            bends: Rc::new((0..2).map(bend).collect()),
            hinges: Rc::default(),
            conserved: Rc::default(),
            chains: Rc::default(),
        }
    }

    /// `k/2 (|q_j - q_i| - l)^2` and `b/2 (e . e' + 1)`, the second bond turned back by the natural angle; in 3D `b/4 (|e + e'| - 2 sin(t/2))^2`.
    fn energy<const D: usize>(centers: &[SVector<f64, D>], angle: f64) -> f64 {
        let stretch = |pair: &[SVector<f64, D>]| 3.5 * ((pair[1] - pair[0]).norm() - 1.1).powi(2);
        let bend = |three: &[SVector<f64, D>]| {
            let unit = |to: usize| (three[to] - three[1]).normalize();
            match D {
                2 => 1.5 * (unit(0).dot(&(turn::<D>(-angle) * unit(2))) + 1.0),
                _ => 0.75 * ((unit(0) + unit(2)).norm() - 2.0 * (0.5 * angle).sin()).powi(2),
            }
        };
        centers.windows(2).map(stretch).sum::<f64>() + centers.windows(3).map(bend).sum::<f64>()
    }

    fn proof<const D: usize>(centers: Vec<SVector<f64, D>>, angle: f64) {
        let springs = springs(&centers, &bonds(angle));
        let (stored, exact) = (springs.iter().map(Spring::energy).sum::<f64>(), energy(&centers, angle));
        assert!((stored - exact).abs() < 1e-13, "{stored} {exact}");
        let mut forces = vec![SVector::<f64, D>::zeros(); centers.len()];
        for spring in &springs {
            spring.ends.iter().for_each(|(body, gradient)| forces[*body] -= gradient * (spring.stiffness * spring.value));
        }
        for (body, axis) in (0..centers.len()).flat_map(|body| (0..D).map(move |axis| (body, axis))) {
            let moved = |by: f64| {
                let mut centers = centers.clone();
                centers[body][axis] += by;
                energy(&centers, angle)
            };
            let slope = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            assert!((forces[body][axis] + slope).abs() < 1e-7, "{} {slope}", forces[body][axis]);
        }
        let moment: SMatrix<f64, D, D> = forces.iter().zip(&centers).map(|(force, center)| force * center.transpose()).sum();
        assert!(forces.iter().sum::<SVector<f64, D>>().norm() < 1e-13 && (moment - moment.transpose()).norm() < 1e-13);
    }

    #[test]
    fn forces_are_slopes_of_the_potential_without_a_net_force_or_torque() {
        let plane = [[0.1, 0.0], [1.0, 0.4], [2.1, 0.2], [2.5, 1.4]].map(Vector2::from);
        [0.0, 0.7, -1.9].into_iter().for_each(|angle| proof(plane.to_vec(), angle));
        let space = [[0.1, 0.0, 0.2], [1.0, 0.4, -0.3], [2.1, 0.2, 0.1], [2.5, 1.4, 0.7]].map(Vector3::from);
        [0.0, 0.7].into_iter().for_each(|angle| proof(space.to_vec(), angle));
    }

    #[test]
    fn a_straight_chain_is_at_rest() {
        let centers: Vec<Vector3<f64>> = (0..4).map(|bead| Vector3::new(1.1, 0.0, 0.0) * f64::from(bead)).collect();
        assert!(
            springs(&centers, &bonds(0.0))
                .iter()
                .all(|spring| spring.value.abs() < 1e-14 && spring.ends.iter().all(|end| end.1.norm() < 3.0))
        );
    }
}
