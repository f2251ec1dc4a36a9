//! What bodies in a fluid resist as a network: each alone, films, and the flow between near ones.

use crate::{
    body::{RigidFunctional, Row, components},
    friction::{
        SurfaceFriction,
        medium::{Medium, Resisting},
        row_block::NONE,
    },
    geometry::{Ball, Domain},
};

/// Compliance of welds in the network, over the mobility of their bodies: the network only tells who sticks and who slips.
const RIGID: f64 = 1e-6;

/// Bodies in a fluid, as a network knows them.
#[derive(Clone, Copy)]
pub struct ImmersedBodies<'a, const D: usize> {
    /// The box.
    pub domain: &'a Domain<D>,
    /// The bodies before the step, as they touch.
    pub balls: &'a [Ball<D>],
    /// What resists.
    pub resistance: &'a NetworkResistance<D>,
    /// Coefficients of friction.
    pub surfaces: &'a SurfaceFriction,
    /// Length of the step.
    pub step: f64,
}

/// What bodies in a fluid resist as a network.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct NetworkResistance<const D: usize> {
    /// Force and torque over velocity and spin of each alone in the fluid, infinite where a motion is given.
    pub bodies: Vec<[f64; 2]>,
    /// Films between them and with walls; compliances are speed over force.
    pub films: Vec<Row<D>>,
    /// Bonds and welds; compliances are speed over force.
    pub bonds: Vec<Row<D>>,
    /// What the flow between two near bodies resists beyond that.
    pub pairs: Vec<NearResistance>,
}

/// What two bodies resist by the flow between them.
#[derive(Debug, Clone, PartialEq)]
pub struct NearResistance {
    /// The bodies.
    pub bodies: [usize; 2],
    /// Forces and torques on the first, then on the second, for velocities and spins of both, row by row.
    pub matrix: Vec<f64>,
}

impl<const D: usize> NetworkResistance<D> {
    /// What resists between bodies that give way, in their unknowns: without what neighbours resist if that has no factors.
    pub(super) fn medium<const W: usize>(&self, free: &[usize]) -> Medium<W> {
        let row = |row: &Row<D>, compliance: f64| of_row::<D, W>(row, compliance, free, &self.bodies);
        let films = || self.films.iter().filter_map(|film| row(film, film.compliance));
        // what ties more than two bodies is no part of a network of pairs
        let pairwise = || self.bonds.iter().filter(|bond| bond.ends.len() <= 2);
        let tied = |bond: &Row<D>| Some(Resisting { ties: true, ..row(bond, bond.compliance + RIGID * self.mobility(bond))? });
        let rows = || films().chain(pairwise().filter_map(tied));
        let pairs = self.pairs.iter().filter_map(|pair| of_pair::<D, W>(pair, free, &self.bodies));
        let all = Medium::new(free.len(), rows().chain(pairs).collect());
        all.or_else(|| Medium::new(free.len(), rows().collect())).unwrap_or_else(Medium::none)
    }

    /// Rate that a unit force of a row causes where each body is alone.
    fn mobility(&self, row: &Row<D>) -> f64 {
        let of_end = |(body, side): &(usize, RigidFunctional<D>)| {
            let turning: f64 = components(&side.turn).iter().map(|entry| entry * entry).sum();
            side.direction.norm_squared() / self.bodies[*body][0] + turning / self.bodies[*body][1]
        };
        row.ends.iter().map(of_end).sum()
    }
}

/// What turns velocities and spins of a body into the unknowns of a program.
fn scales<const D: usize, const W: usize>([translation, rotation]: [f64; 2]) -> [f64; W] {
    std::array::from_fn(|place| if place < D { translation.sqrt() } else { rotation.sqrt() })
}

fn of_pair<const D: usize, const W: usize>(pair: &NearResistance, free: &[usize], resistances: &[[f64; 2]]) -> Option<Resisting> {
    let (found, ends): (Vec<usize>, Vec<usize>) = (0..2).filter_map(|end| Some((end, free.binary_search(&pair.bodies[end]).ok()?))).unzip();
    let scales = pair.bodies.map(|body| scales::<D, W>(resistances[body]));
    let mut blocks = Vec::with_capacity(4 * W * W);
    for (&one, &other) in found.iter().flat_map(|one| found.iter().map(move |other| (one, other))) {
        for (row, of_row) in scales[one].iter().enumerate() {
            let entries = &pair.matrix[(one * W + row) * 2 * W + other * W..][..W];
            blocks.extend(entries.iter().zip(&scales[other]).map(|(entry, of_column)| entry / (of_row * of_column)));
        }
    }
    Some(Resisting { ends: [*ends.first()?, ends.get(1).copied().unwrap_or(NONE)], blocks, ties: false })
}

/// A row between bodies that give way, with this compliance.
fn of_row<const D: usize, const W: usize>(row: &Row<D>, compliance: f64, free: &[usize], resistances: &[[f64; 2]]) -> Option<Resisting> {
    let scaled = |body: usize, side: &RigidFunctional<D>| -> [f64; W] {
        let (turning, scales) = (components(&side.turn), scales::<D, W>(resistances[body]));
        std::array::from_fn(|place| (if place < D { side.direction[place] } else { turning[place - D] }) / scales[place])
    };
    let sides: Vec<(usize, [f64; W])> =
        row.ends.iter().filter_map(|(body, side)| Some((free.binary_search(body).ok()?, scaled(*body, side)))).collect();
    let end = |number: usize| sides.get(number).map_or((NONE, [0.0; W]), |side| *side);
    let [(one, first), (two, second)] = [end(0), end(1)];
    (one != NONE).then(|| Resisting::of_row([one, two], &[first, second], 1.0 / compliance))
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, SMatrix, Vector2, Vector3};

    use super::*;
    use crate::body::skew;

    #[test]
    fn a_film_and_near_bodies_resist_as_their_matrices_say() {
        let side = |direction: [f64; 2], turn: f64| RigidFunctional { direction: Vector2::from(direction), turn: skew::<2>(&[turn]) };
        let rows = [side([0.6, 0.8], -0.3), side([-0.6, -0.8], -0.2)];
        let film = Row::new(vec![(0, rows[0]), (2, rows[1])], 0.0, 0.25);
        // a body of given motion is no part of the network: what it resists is a resistance of the other alone
        let near = SMatrix::<f64, 6, 6>::from_fn(|row, column| if row == column { 2.0 } else { 0.1 * (row + column) as f64 });
        let pair = NearResistance { bodies: [1, 2], matrix: near.transpose().as_slice().to_vec() };
        let bodies = vec![[2.0, 3.0], [f64::INFINITY; 2], [1.0, 0.5]];
        let network = NetworkResistance { bodies: bodies.clone(), films: vec![film], bonds: Vec::new(), pairs: vec![pair] };
        let medium = network.medium::<3>(&[0, 2]);
        let drags = [bodies[0], bodies[2]].map(|[translation, rotation]| Vector3::new(translation, translation, rotation));
        let vector = |side: &RigidFunctional<2>| Vector3::new(side.direction[0], side.direction[1], components(&side.turn)[0]);
        let forces = [Vector3::new(0.3, -0.4, 0.7), Vector3::new(-0.2, 0.5, 0.1)];
        let scaled =
            |vectors: [Vector3<f64>; 2]| [0, 1].map(|body| std::array::from_fn(|axis| vectors[body][axis] / drags[body][axis].sqrt()));
        let found: Vec<[f64; 3]> = medium.motion(scaled(forces).to_vec());
        let motion = [0, 1].map(|body| Vector3::from_fn(|axis, _| found[body][axis] / drags[body][axis].sqrt()));
        let rate: f64 = rows.iter().zip(&motion).map(|(side, motion)| vector(side).dot(motion)).sum();
        let near_block: Matrix3<f64> = near.fixed_view::<3, 3>(3, 3).into();
        let resisted = [
            drags[0].component_mul(&motion[0]) + vector(&rows[0]) * (rate / 0.25),
            drags[1].component_mul(&motion[1]) + vector(&rows[1]) * (rate / 0.25) + near_block * motion[1],
        ];
        for (force, resisted) in forces.iter().zip(&resisted) {
            assert!((force - resisted).norm() < 1e-14, "{force} {resisted}");
        }
        let again = medium.forces(&found);
        assert!(again.as_flattened().iter().zip(scaled(forces).as_flattened()).all(|(one, other)| (one - other).abs() < 1e-14));
    }
}
