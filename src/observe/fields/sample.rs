//! The velocity of the fluid and its curl, or the scalar in its place, at points of the box.

use std::{collections::BTreeSet, ops::Range};

use nalgebra::SVector;

use crate::{
    error::Result,
    flow::OpenEnds,
    grid::{
        Grid, Node,
        curl::curl_at,
        interpolation,
        stencil::{Site, Term},
    },
    petsc::{Scatter, Vector},
};

/// The velocity in a fluid vector at points of the box, on every rank (cubic interpolation; walls count with their own velocity).
pub fn velocities<const D: usize>(grid: &Grid<D>, fluid: &Vector, points: &[SVector<f64, D>]) -> Result<Vec<SVector<f64, D>>> {
    let ends = OpenEnds::of(grid, fluid)?;
    let values = sums(fluid, points.len() * D, |visit| {
        for (number, point) in mine(grid, fluid, points) {
            for component in 0..D {
                interpolation::velocity(grid, component, point, |term| {
                    visit(number * D + component, of_velocity(grid, ends.as_ref(), term))
                });
            }
        }
    })?;
    Ok(values.chunks(D).map(SVector::from_column_slice).collect())
}

/// The vorticity in the plane of two axes ([`curl`](crate::grid::curl)) in a fluid vector at points of the box, on every rank.
pub fn vorticities<const D: usize>(grid: &Grid<D>, fluid: &Vector, points: &[SVector<f64, D>], plane: (usize, usize)) -> Result<Vec<f64>> {
    let ends = OpenEnds::of(grid, fluid)?;
    sums(fluid, points.len(), |visit| {
        for (number, point) in mine(grid, fluid, points) {
            curl_at(grid, plane, point, |term| visit(number, of_velocity(grid, ends.as_ref(), term)));
        }
    })
}

/// A scalar that is zero on walls at points of the box, on every rank (cubic interpolation).
pub fn scalars<const D: usize>(grid: &Grid<D>, field: &Vector, points: &[SVector<f64, D>]) -> Result<Vec<f64>> {
    sums(field, points.len(), |visit| {
        for (number, point) in mine(grid, field, points) {
            interpolation::scalar(grid, point, |index, weight| visit(number, of_node(grid.node(D, index), weight)));
        }
    })
}

/// The points in this rank's block, with their numbers.
fn mine<'a, const D: usize>(
    grid: &'a Grid<D>,
    vector: &Vector,
    points: &'a [SVector<f64, D>],
) -> impl Iterator<Item = (usize, &'a SVector<f64, D>)> {
    let rank = vector.session().world().rank();
    points.iter().enumerate().filter(move |(_, point)| grid.owner(point) == rank)
}

/// A part of a sum.
#[derive(Clone, Copy)]
enum Part {
    /// What is known.
    Known(f64),
    /// An entry of a vector with its weight.
    Entry(usize, f64),
}

/// A term of velocities; walls count with their own velocity, open ends with that of the flow.
fn of_velocity<const D: usize>(grid: &Grid<D>, ends: Option<&OpenEnds<D>>, term: Term<D>) -> Part {
    match (ends.and_then(|ends| ends.at_site(grid, &term.site)), term.site) {
        (Some(value), _) | (None, Site::Wall { value, .. }) => Part::Known(term.weight * value),
        (None, Site::Lattice { field, index }) => of_node(grid.fluid_node(field, index), term.weight),
    }
}

/// An entry; on walls that carry no unknown the value is zero.
fn of_node(node: Node, weight: f64) -> Part {
    match node {
        Node::Unknown(unknown) => Part::Entry(unknown, weight),
        Node::Wall(_) => Part::Known(0.0),
    }
}

/// Sums, on every rank, of the parts that ranks visit, each for the sum whose number it gives; they visit the same ones twice. Terms are never listed: a
/// picture in 3D has tens of millions.
fn sums(vector: &Vector, count: usize, parts: impl Fn(&mut dyn FnMut(usize, Part))) -> Result<Vec<f64>> {
    let own = vector.range()?;
    let foreign = foreign(&own, &parts, vector.session().world().size());
    let mut scatter = Scatter::new(vector, &foreign)?;
    let (fetched, local) = (scatter.fetch(vector)?, vector.local()?);
    let mut values = vec![0.0; count];
    parts(&mut |place, part| {
        values[place] += match part {
            Part::Known(value) => value,
            Part::Entry(unknown, weight) if own.contains(&unknown) => weight * local[unknown - own.start],
            Part::Entry(unknown, weight) => weight * foreign.binary_search(&unknown).map_or(0.0, |place| fetched[place]),
        };
    });
    vector.session().world().sum(&mut values);
    Ok(values)
}

/// The entries of other ranks among parts, each once, in order.
fn foreign(own: &Range<usize>, parts: &impl Fn(&mut dyn FnMut(usize, Part)), ranks: usize) -> Vec<usize> {
    let mut found = BTreeSet::new();
    if ranks > 1 {
        parts(&mut |_, part| match part {
            Part::Entry(unknown, _) if !own.contains(&unknown) => {
                found.insert(unknown);
            }
            _ => {}
        });
    }
    found.into_iter().collect()
}
