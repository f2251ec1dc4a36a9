//! The viscous flux beside surfaces, of fourth order.
//!
//! Rows of the Stokes operator take differences of two neighbours for slopes. In a layer on a surface, a cell or two thick, these err by third differences: with
//!
//! ```text
//! flux = - mu [(u_i+1 - u_i) - (u_i+2 - 3 u_i+1 + 3 u_i - u_i-1) / 12] / h
//! ```
//!
//! on the faces between `i` and `i + 1` divergences are of fourth order. The second part is known from earlier flows, extended into bodies. Faces within two cells of a
//! surface have it, if one side of them at least lies outside; rows on either side take it with opposite signs, so that none of it is a force.

use crate::{
    error::Result,
    grid::{Grid, Index, Node, operators::signed},
    mechanics::system::level::Near,
    petsc::{Scatter, Vector},
};

/// Distance from a surface, in cells, up to which fluxes are of fourth order.
const BAND: f64 = 2.0;

/// Weights of the values in a row around a face in its third difference.
const THIRD: [f64; 4] = [-1.0, 3.0, -3.0, 1.0];

/// A velocity, and how far from a surface it is, in cells.
type Value = (f64, f64);

/// A face at the edge of what this rank has: rows beside it that are its own, their axis, and the four values around it among those fetched.
struct EdgeFace {
    rows: [Option<usize>; 2],
    axis: usize,
    values: std::ops::Range<usize>,
}

/// What viscous fluxes of second order lack beside surfaces, in momentum rows over viscosity. Collective.
pub fn viscous_defect<const D: usize>(grid: &Grid<D>, extended: &Vector, near: &[Near]) -> Result<Vector> {
    let gaps = gaps(grid, extended, near)?;
    let factors = grid.spacing().map(|spacing| 1.0 / (12.0 * spacing * spacing));
    let (mut edges, mut wanted) = (Vec::new(), Vec::new());
    let mut defect = extended.like()?;
    let mut rows = defect.local_mut()?;
    {
        let (own, gaps) = (extended.local()?, gaps.local()?);
        for near in near.iter().filter(|near| gaps[near.place].abs() < BAND) {
            let (block, place) = (grid.block(near.component), near.place);
            let index = block.index(place - grid.local_range(near.component).start);
            for axis in 0..D {
                let stride: usize = (axis + 1..D).map(|axis| block.end[axis] - block.start[axis]).product();
                if index[axis] > block.start[axis] && index[axis] + 2 < block.end[axis] {
                    let of = |place: usize| (own[place], gaps[place]);
                    let flux = factors[axis] * third_difference([place - stride, place, place + stride, place + 2 * stride].map(of));
                    rows[place] -= flux;
                    rows[place + stride] += flux;
                    continue;
                }
                edges.extend(edge_face(grid, near.component, (signed(index), axis), extended, &mut wanted)?);
                if index[axis] == block.start[axis] {
                    let mut lower = signed(index);
                    lower[axis] -= 1;
                    let face = edge_face(grid, near.component, (lower, axis), extended, &mut wanted)?;
                    edges.extend(face.filter(|face| face.rows[0].is_none()));
                }
            }
        }
    }
    let mut fetched = Scatter::new(extended, &wanted)?;
    let (velocities, gaps) = (fetched.fetch(extended)?.to_vec(), fetched.fetch(&gaps)?);
    for EdgeFace { rows: [lower, upper], axis, values } in edges {
        let flux =
            factors[axis] * third_difference(std::array::from_fn(|node| (velocities[values.start + node], gaps[values.start + node])));
        lower.into_iter().for_each(|row| rows[row] -= flux);
        upper.into_iter().for_each(|row| rows[row] += flux);
    }
    drop(rows);
    Ok(defect)
}

/// Distances of velocities from the nearest surface, in cells; infinite where it is far.
fn gaps<const D: usize>(grid: &Grid<D>, shape: &Vector, near: &[Near]) -> Result<Vector> {
    let (mut gaps, spacing) = (shape.like()?, grid.spacing().max());
    gaps.fill(f64::INFINITY)?;
    let mut values = gaps.local_mut()?;
    near.iter().for_each(|near| values[near.place] = near.gap / spacing);
    drop(values);
    Ok(gaps)
}

/// The third difference on a face between the two values in the middle; none where the face has no flux of fourth order.
fn third_difference(around: [Value; 4]) -> f64 {
    let [(_, one), (_, other)] = [around[1], around[2]];
    if one.abs() >= BAND || other.abs() >= BAND || one.max(other) <= 0.0 {
        return 0.0;
    }
    around.iter().zip(THIRD).map(|((value, _), weight)| value * weight).sum()
}

/// The face behind a velocity along an axis, whose values are not all this rank's; none at walls.
fn edge_face<const D: usize>(
    grid: &Grid<D>,
    component: usize,
    (index, axis): (Index<D>, usize),
    shape: &Vector,
    wanted: &mut Vec<usize>,
) -> Result<Option<EdgeFace>> {
    let nodes = [-1, 0, 1, 2].map(|step| {
        let mut index = index;
        index[axis] += step;
        unknown(grid, component, index)
    });
    let [Some(first), Some(lower), Some(upper), Some(last)] = nodes else { return Ok(None) };
    let own = shape.range()?;
    let row = |place: usize| own.contains(&place).then(|| place - own.start);
    let start = wanted.len();
    wanted.extend([first, lower, upper, last]);
    Ok(Some(EdgeFace { rows: [row(lower), row(upper)], axis, values: start..start + 4 }))
}

/// Where the velocity at an index is in fluid vectors; nothing on walls and beyond them.
fn unknown<const D: usize>(grid: &Grid<D>, component: usize, index: Index<D>) -> Option<usize> {
    if !(0..D).all(|axis| grid.between_walls(component, axis, index[axis])) {
        return None;
    }
    match grid.fluid_node(component, index) {
        Node::Unknown(place) => Some(place),
        Node::Wall(_) => None,
    }
}
