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
//! Nor is it a torque: of the symmetric stress `mu (du_c/dx_a + du_a/dx_c)` the parts on a corner push rows of both components. The second one has no divergence
//! where the flow has none, but without it what begins and ends with the band turned bodies.
//!
//! Where one side of a face lies inside and the other outside, either row misses what the jump between them has beyond that of steady flow; of the mean of both, which is
//! small, rows take a flux.

use super::near_surfaces::{BAND, NearSurfaces};
use crate::{
    error::Result,
    grid::{Block, Grid, Index, Node, operators::signed},
    petsc::{Scatter, Vector},
};

/// One over the weight of a third difference in a flux.
const OVER_FACTOR: f64 = 12.0;

/// Weights of the values in a row around a face in its third difference.
const THIRD: [f64; 4] = [-1.0, 3.0, -3.0, 1.0];

/// Places of the four values along the axis of a face of a component around it, and of the four along the component that have the other part of its stress.
type Around = [[usize; 4]; 2];

/// A face at the edge of what this rank has: rows beside it that are its own, its factor, and the first of the eight values around it among those fetched.
struct EdgeFace {
    rows: [Option<usize>; 2],
    factors: [f64; 2],
    first: usize,
}

/// What viscous fluxes of second order lack beside surfaces, in momentum rows over viscosity: of a velocity that is extended into bodies, as large a part as layers are `resolved`,
/// and of jumps that change. Collective.
pub fn viscous_defect<const D: usize>(grid: &Grid<D>, surfaces: &NearSurfaces, extended: &Vector, resolved: f64) -> Result<Vector> {
    let NearSurfaces { gaps, unsteady, near } = surfaces;
    let (mut edges, mut wanted) = (Vec::new(), Vec::new());
    let mut defect = extended.like()?;
    let mut rows = defect.local_mut()?;
    {
        let (own, gaps, unsteady) = (extended.local()?, gaps.local()?, unsteady.local()?);
        let blocks: [Block<D>; D] = std::array::from_fn(|component| grid.block(component));
        for &(place, component) in near {
            let index = blocks[component].index(place - grid.local_range(component).start);
            for axis in 0..D {
                let factors = factors(grid, component, axis);
                let Some(around) = local_around(grid, &blocks, component, index, axis) else {
                    edge_faces(grid, component, signed(index), axis, extended, &mut edges, &mut wanted)?;
                    continue;
                };
                let [gaps, velocities, jumps] =
                    [&gaps, &own, &unsteady].map(|values| around.map(|around| around.map(|place| values[place])));
                let flux = flux(factors, resolved, gaps, velocities) + crossing(factors[0], gaps[0], jumps[0]);
                rows[around[0][1]] -= flux;
                rows[around[0][2]] += flux;
            }
        }
    }
    let mut fetched = Scatter::new(extended, &wanted)?;
    let (velocities, unsteady, gaps) = (fetched.fetch(extended)?.to_vec(), fetched.fetch(unsteady)?.to_vec(), fetched.fetch(gaps)?);
    for EdgeFace { rows: [lower, upper], factors, first } in edges {
        let around = |values: &[f64]| [0, 4].map(|part| std::array::from_fn(|node| values[first + part + node]));
        let (gaps, jumps) = (around(gaps), around(&unsteady));
        let flux = flux(factors, resolved, gaps, around(&velocities)) + crossing(factors[0], gaps[0], jumps[0]);
        lower.into_iter().for_each(|row| rows[row] -= flux);
        upper.into_iter().for_each(|row| rows[row] += flux);
    }
    drop(rows);
    Ok(defect)
}

/// Of the third differences around a face, in rows.
fn factors<const D: usize>(grid: &Grid<D>, component: usize, axis: usize) -> [f64; 2] {
    let spacing = grid.spacing();
    [axis, component].map(|across| 1.0 / (OVER_FACTOR * spacing[axis] * spacing[across]))
}

fn flux(factors: [f64; 2], resolved: f64, gaps: [[f64; 4]; 2], around: [[f64; 4]; 2]) -> f64 {
    if !of_fourth_order(gaps) {
        return 0.0;
    }
    resolved * (factors[0] * third_difference(around[0]) + factors[1] * third_difference(around[1]))
}

/// Of what jumps have beyond those of steady flow, at a face that a surface crosses.
fn crossing(factor: f64, gaps: [f64; 4], jumps: [f64; 4]) -> f64 {
    let [before, behind] = [gaps[1], gaps[2]];
    // where a distance is not known no surface is near
    if before.abs().max(behind.abs()) >= BAND || (before > 0.0) == (behind > 0.0) {
        return 0.0;
    }
    let flux = OVER_FACTOR * factor * 0.5 * (jumps[1] + jumps[2]);
    if before > 0.0 { -flux } else { flux }
}

/// The component and the index of the values around the face of a component behind an index along an axis.
fn nodes<const D: usize>(component: usize, index: Index<D>, axis: usize) -> [[(usize, Index<D>); 4]; 2] {
    let moved = |mut index: Index<D>, axis: usize, by: isize| {
        index[axis] += by;
        index
    };
    let along = [-1, 0, 1, 2].map(|step| (component, moved(index, axis, step)));
    if axis == component {
        return [along, along];
    }
    let corner = moved(index, axis, 1);
    [along, [-2, -1, 0, 1].map(|step| (axis, moved(corner, component, step)))]
}

/// Places on this rank of the values around the face of a component behind an index along an axis, where it has them all.
fn local_around<const D: usize>(
    grid: &Grid<D>,
    blocks: &[Block<D>; D],
    component: usize,
    index: [usize; D],
    axis: usize,
) -> Option<Around> {
    let (block, other) = (&blocks[component], &blocks[axis]);
    let stride = |block: &Block<D>, axis: usize| (axis + 1..D).map(|axis| block.end[axis] - block.start[axis]).product::<usize>();
    let inside = index[axis] > block.start[axis] && index[axis] + 2 < block.end[axis];
    let (place, step) = (grid.local_range(component).start + block.offset(index), stride(block, axis));
    let along = inside.then(|| [place - step, place, place + step, place + 2 * step])?;
    if axis == component {
        return Some([along, along]);
    }
    let mut corner = index;
    corner[axis] += 1;
    let inside = (0..D).all(|axis| (other.start[axis]..other.end[axis]).contains(&corner[axis]))
        && corner[component] >= other.start[component] + 2
        && corner[component] + 1 < other.end[component];
    let (place, step) = inside.then(|| (grid.local_range(axis).start + other.offset(corner), stride(other, component)))?;
    Some([along, [place - 2 * step, place - step, place, place + step]])
}

/// Whether the flux amid velocities at these distances from a surface, in cells, is one.
fn of_fourth_order(around: [[f64; 4]; 2]) -> bool {
    let beside = around.iter().flat_map(|gaps| &gaps[1..3]);
    beside.clone().all(|gap| gap.abs() < BAND) && beside.copied().fold(f64::NEG_INFINITY, f64::max) > 0.0
}

fn third_difference(around: [f64; 4]) -> f64 {
    around.iter().zip(THIRD).map(|(value, weight)| value * weight).sum()
}

/// The face behind a velocity of this rank along an axis, and the one before it if that lies behind no other velocity of the rank.
fn edge_faces<const D: usize>(
    grid: &Grid<D>,
    component: usize,
    index: Index<D>,
    axis: usize,
    shape: &Vector,
    edges: &mut Vec<EdgeFace>,
    wanted: &mut Vec<usize>,
) -> Result<()> {
    let own = shape.range()?;
    for before in 0..=1 {
        let mut index = index;
        index[axis] -= before;
        let places = nodes(component, index, axis).map(|nodes| nodes.map(|(component, index)| unknown(grid, component, index)));
        // no such flux beside walls
        let Some(places) = places.iter().flatten().copied().collect::<Option<Vec<usize>>>() else { continue };
        if before == 0 || !own.contains(&places[1]) {
            let row = |place: usize| own.contains(&place).then(|| place - own.start);
            edges.push(EdgeFace { rows: [row(places[1]), row(places[2])], factors: factors(grid, component, axis), first: wanted.len() });
            wanted.extend(places);
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
