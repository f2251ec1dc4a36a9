//! The viscous flux beside surfaces, of fourth order.
//!
//! Rows of the Stokes operator take differences of two neighbours for slopes. In a layer on a surface, a cell or two thick, these err by third differences: with
//!
//! ```text
//! flux = - mu [(u_i+1 - u_i) - (u_i+2 - 3 u_i+1 + 3 u_i - u_i-1) / 12] / h
//! ```
//!
//! on the faces between `i` and `i + 1` divergences are of fourth order. The second part is known from earlier flows, extended into bodies. Faces within two cells of a
//! surface as it is at the end of the step have it, if one side of them at least lies outside; rows on either side take it with opposite signs, so that none of it is a force.

use nalgebra::SVector;

use crate::{
    error::Result,
    grid::{Block, Grid, Index, Node, operators::signed},
    mechanics::system::{
        bodies::BodyTypes,
        points::{Point, within},
    },
    petsc::{Scatter, Vector},
};

/// Distance from a surface, in cells, up to which fluxes are of fourth order.
const BAND: f64 = 2.0;

/// Weights of the values in a row around a face in its third difference.
const THIRD: [f64; 4] = [-1.0, 3.0, -3.0, 1.0];

/// A face at the edge of what this rank has: rows beside it that are its own, their axis, and the first of the four values around it among those fetched.
struct EdgeFace {
    rows: [Option<usize>; 2],
    axis: usize,
    first: usize,
}

/// What viscous fluxes of second order lack of a velocity beside bodies at these centres, into which it is extended, in momentum rows over viscosity. Collective.
pub fn viscous_defect<const D: usize>(
    grid: &Grid<D>,
    body_types: &BodyTypes<D>,
    centers: &[SVector<f64, D>],
    extended: &Vector,
) -> Result<Vector> {
    let (gaps, near) = gaps(grid, body_types, centers, extended)?;
    let factors = grid.spacing().map(|spacing| 1.0 / (12.0 * spacing * spacing));
    let (mut edges, mut wanted) = (Vec::new(), Vec::new());
    let mut defect = extended.like()?;
    let mut rows = defect.local_mut()?;
    {
        let (own, gaps) = (extended.local()?, gaps.local()?);
        let blocks: [Block<D>; D] = std::array::from_fn(|component| grid.block(component));
        for (place, component) in near {
            let block = &blocks[component];
            let index = block.index(place - grid.local_range(component).start);
            for axis in 0..D {
                let stride: usize = (axis + 1..D).map(|axis| block.end[axis] - block.start[axis]).product();
                if index[axis] > block.start[axis] && index[axis] + 2 < block.end[axis] {
                    if of_fourth_order(gaps[place], gaps[place + stride]) {
                        let around = [place - stride, place, place + stride, place + 2 * stride];
                        let flux = factors[axis] * third_difference(around.map(|place| own[place]));
                        rows[place] -= flux;
                        rows[place + stride] += flux;
                    }
                    continue;
                }
                edge_faces(grid, component, (signed(index), axis), extended, (&mut edges, &mut wanted))?;
            }
        }
    }
    let mut fetched = Scatter::new(extended, &wanted)?;
    let (velocities, gaps) = (fetched.fetch(extended)?.to_vec(), fetched.fetch(&gaps)?);
    for EdgeFace { rows: [lower, upper], axis, first } in edges {
        if of_fourth_order(gaps[first + 1], gaps[first + 2]) {
            let flux = factors[axis] * third_difference(std::array::from_fn(|node| velocities[first + node]));
            lower.into_iter().for_each(|row| rows[row] -= flux);
            upper.into_iter().for_each(|row| rows[row] += flux);
        }
    }
    drop(rows);
    Ok(defect)
}

/// Distances of velocities from the nearest surface, in cells, infinite where it is far; and those of this rank that are near, with their components.
fn gaps<const D: usize>(
    grid: &Grid<D>,
    body_types: &BodyTypes<D>,
    centers: &[SVector<f64, D>],
    shape: &Vector,
) -> Result<(Vector, Vec<(usize, usize)>)> {
    let (mut gaps, own, spacing, mut near) = (shape.like()?, shape.range()?, grid.spacing().max(), Vec::new());
    gaps.fill(f64::INFINITY)?;
    let mut values = gaps.local_mut()?;
    for (body, center) in centers.iter().enumerate() {
        let radius = body_types.surface(body).modes.radius();
        within(grid, center, radius + BAND * spacing, |Point { component, place, offset, .. }| {
            let gap = (offset.norm() - radius) / spacing;
            if own.contains(&place) && gap > -BAND {
                let known = &mut values[place - own.start];
                if known.is_infinite() {
                    near.push((place - own.start, component));
                }
                *known = known.min(gap);
            }
        });
    }
    drop(values);
    Ok((gaps, near))
}

/// Whether the flux between two velocities at these distances from a surface, in cells, is one.
fn of_fourth_order(one: f64, other: f64) -> bool {
    one.abs() < BAND && other.abs() < BAND && one.max(other) > 0.0
}

fn third_difference(around: [f64; 4]) -> f64 {
    around.iter().zip(THIRD).map(|(value, weight)| value * weight).sum()
}

/// The face behind a velocity of this rank along an axis, and the one before it if that lies behind no other velocity of the rank.
fn edge_faces<const D: usize>(
    grid: &Grid<D>,
    component: usize,
    (index, axis): (Index<D>, usize),
    shape: &Vector,
    (edges, wanted): (&mut Vec<EdgeFace>, &mut Vec<usize>),
) -> Result<()> {
    let own = shape.range()?;
    for before in 0..=1 {
        let nodes = [-1, 0, 1, 2].map(|step| {
            let mut index = index;
            index[axis] += step - before;
            unknown(grid, component, index)
        });
        // no such flux beside walls
        let [Some(first), Some(lower), Some(upper), Some(last)] = nodes else { continue };
        if before == 0 || !own.contains(&lower) {
            let row = |place: usize| own.contains(&place).then(|| place - own.start);
            edges.push(EdgeFace { rows: [row(lower), row(upper)], axis, first: wanted.len() });
            wanted.extend([first, lower, upper, last]);
        }
    }
    Ok(())
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
