//! What bodies resist as a network: each alone in the fluid, films between them, and the resolved flow between near ones.

use nalgebra::SMatrix;

use super::{assembly::Assembly, fixed_operators::FixedOperators};
use crate::{
    body::{RigidFunctional, Row, components, skew},
    constraint::{
        Given, PairPreconditioner, RigidBlock,
        lubrication::{LubricationPair, Opposite, RelativeMode},
    },
    friction::{NearResistance, NetworkResistance},
};

/// The resistance of bodies in their places, or of bodies alone before they are assembled, the same on all ranks; a unit of a mean force over a step is this
/// much in its equations. Collective.
pub fn network_resistance<const D: usize>(
    fixed: &FixedOperators<D>,
    assembly: Option<&Assembly<D>>,
    of_impulse: f64,
) -> NetworkResistance<D> {
    let viscosity = fixed.setup.viscosity / of_impulse;
    let of_body = |body: usize| {
        if !fixed.setup.bodies[body].body.free() {
            return [f64::INFINITY; 2];
        }
        let rigid = fixed.body_types.rigid(body);
        [rigid.force / rigid.mobilities[0], rigid.force * rigid.lever.powi(2) / rigid.mobilities[D]]
            .map(|resistance| viscosity * resistance)
    };
    let bodies = (0..fixed.setup.bodies.len()).map(of_body).collect();
    let Some(assembly) = assembly else { return NetworkResistance { bodies, ..NetworkResistance::default() } };
    let world = fixed.session.world();
    let owned = assembly.films.films.iter().filter(|film| assembly.layout.holds(film.body));
    let rows = owned.flat_map(|film| film.relative_modes.iter().map(move |mode| row(film, mode, viscosity)));
    let numbers: Vec<f64> = rows.flat_map(|row| pack(&row)).collect();
    let films = world.gather(&numbers).chunks(length::<D>()).map(unpack).collect();
    let near = assembly.pairs.iter().filter(|pairs| pairs.given() == Given::Motions).flat_map(PairPreconditioner::resistances::<D>);
    let own = near.filter(|(bodies, _)| assembly.layout.holds(bodies[0]));
    let numbers: Vec<f64> = own.flat_map(|(bodies, blocks)| pack_pair::<D>(fixed, bodies, &blocks, viscosity)).collect();
    let count = 2 + (2 * rigid_count::<D>()).pow(2);
    let pair = |numbers: &[f64]| NearResistance { bodies: [numbers[0] as usize, numbers[1] as usize], matrix: numbers[2..].to_vec() };
    NetworkResistance { bodies, films, bonds: Vec::new(), pairs: world.gather(&numbers).chunks(count).map(pair).collect() }
}

const fn rigid_count<const D: usize>() -> usize {
    D * (D + 1) / 2
}

/// The numbers of two bodies and what they resist: rotations of modes are velocities on the surface.
fn pack_pair<const D: usize>(fixed: &FixedOperators<D>, bodies: [usize; 2], blocks: &[[RigidBlock; 2]; 2], viscosity: f64) -> Vec<f64> {
    let (rigid, levers) = (rigid_count::<D>(), bodies.map(|body| fixed.body_types.rigid(body).lever));
    let lever = |end: usize, mode: usize| if mode < D { 1.0 } else { levers[end] };
    let mut numbers = bodies.map(|body| body as f64).to_vec();
    for (one, row) in (0..2).flat_map(|one| (0..rigid).map(move |row| (one, row))) {
        for (other, column) in (0..2).flat_map(|other| (0..rigid).map(move |column| (other, column))) {
            numbers.push(viscosity * blocks[one][other][(row, column)] * lever(one, row) * lever(other, column));
        }
    }
    numbers
}

fn row<const D: usize>(film: &LubricationPair<D>, mode: &RelativeMode<D>, viscosity: f64) -> Row<D> {
    let other = match film.other {
        Opposite::Body(other, _) => Some((other, mode.sides[1])),
        Opposite::Wall(_) => None,
    };
    Row::new([(film.body, mode.sides[0])].into_iter().chain(other).collect(), 0.0, 1.0 / (mode.resistance * viscosity))
}

/// How many numbers an end takes, and a row.
const fn end_length<const D: usize>() -> usize {
    1 + D + D * (D - 1) / 2
}

const fn length<const D: usize>() -> usize {
    1 + 2 * end_length::<D>()
}

/// A row of two ends at most as numbers; a body below zero is none.
fn pack<const D: usize>(row: &Row<D>) -> Vec<f64> {
    let mut numbers = vec![row.compliance];
    for (body, side) in &row.ends {
        numbers.push(*body as f64);
        numbers.extend(side.direction.iter());
        numbers.extend(components(&side.turn));
    }
    numbers.resize(length::<D>(), -1.0);
    numbers
}

fn unpack<const D: usize>(numbers: &[f64]) -> Row<D> {
    let end = |numbers: &[f64]| {
        let direction = nalgebra::SVector::from_column_slice(&numbers[1..=D]);
        let turn: SMatrix<f64, D, D> = skew(&numbers[1 + D..]);
        (numbers[0] as usize, RigidFunctional { direction, turn })
    };
    let ends = numbers[1..].chunks(end_length::<D>()).filter(|end| end[0] >= 0.0).map(end).collect();
    Row::new(ends, 0.0, numbers[0])
}
