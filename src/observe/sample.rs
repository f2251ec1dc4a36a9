//! The velocity of the fluid, or a scalar, at points of the box.

use nalgebra::SVector;

use crate::{
    error::Result,
    grid::{
        Grid, Node, dirichlet,
        interpolation::{self, NODES},
        stencil::Site,
    },
    petsc::{Scatter, Vector},
};

/// The velocity in a fluid vector at points of the box, on every rank (cubic interpolation; walls count with their own velocity).
pub fn velocities<const D: usize>(grid: &Grid<D>, fluid: &Vector, points: &[SVector<f64, D>]) -> Result<Vec<SVector<f64, D>>> {
    let world = fluid.session().world();
    let mut values = vec![0.0; points.len() * D];
    let (mut wanted, mut terms) = (Vec::new(), Vec::new());
    for (number, point) in points.iter().enumerate().filter(|(_, point)| grid.owner(point) == world.rank()) {
        for component in 0..D {
            let place = number * D + component;
            interpolation::velocity(grid, component, point, |term| match term.site {
                Site::Wall { value, .. } => values[place] += term.weight * value,
                Site::Lattice { index, .. } => {
                    if let Node::Unknown(unknown) = grid.fluid_node(component, index) {
                        wanted.push(unknown as i32);
                        terms.push((place, term.weight));
                    }
                }
            });
        }
    }
    let mut scatter = Scatter::new(fluid, &wanted)?;
    for ((place, weight), value) in terms.into_iter().zip(scatter.fetch(fluid)?.iter()) {
        values[place] += weight * value;
    }
    world.sum(&mut values);
    Ok(values.chunks(D).map(SVector::from_column_slice).collect())
}

/// The scalar at cell centres, zero on walls, at points of the box, on every rank (cubic interpolation).
pub fn scalars<const D: usize>(grid: &Grid<D>, field: &Vector, points: &[SVector<f64, D>]) -> Result<Vec<f64>> {
    let world = field.session().world();
    let (mut wanted, mut terms) = (Vec::new(), Vec::new());
    for (number, point) in points.iter().enumerate().filter(|(_, point)| grid.owner(point) == world.rank()) {
        let lines: [_; D] = std::array::from_fn(|axis| interpolation::line(grid, D, axis, point[axis]));
        for combination in 0..NODES.pow(D as u32) {
            let choice: [usize; D] = std::array::from_fn(|axis| (combination >> (2 * axis)) % NODES);
            let index = std::array::from_fn(|axis| lines[axis].index[choice[axis]]);
            if let Some(Node::Unknown(unknown)) = dirichlet::within(grid, index).then(|| grid.node(D, index)) {
                wanted.push(unknown as i32);
                terms.push((number, (0..D).map(|axis| lines[axis].weight[choice[axis]]).product::<f64>()));
            }
        }
    }
    let mut values = vec![0.0; points.len()];
    let mut scatter = Scatter::new(field, &wanted)?;
    for ((place, weight), value) in terms.into_iter().zip(scatter.fetch(field)?.iter()) {
        values[place] += weight * value;
    }
    world.sum(&mut values);
    Ok(values)
}
