//! The velocity of the fluid and its curl, or the scalar in its place, at points of the box.

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
    let mut samples = Samples::new(points.len() * D);
    let ends = OpenEnds::of(grid, fluid)?;
    for (number, point) in mine(grid, fluid, points) {
        for component in 0..D {
            interpolation::velocity(grid, component, point, |term| {
                samples.add_velocity(number * D + component, (grid, ends.as_ref()), term)
            });
        }
    }
    Ok(samples.fetch(fluid)?.chunks(D).map(SVector::from_column_slice).collect())
}

/// The vorticity in the plane of two axes ([`curl`](crate::grid::curl)) in a fluid vector at points of the box, on every rank.
pub fn vorticities<const D: usize>(grid: &Grid<D>, fluid: &Vector, points: &[SVector<f64, D>], plane: (usize, usize)) -> Result<Vec<f64>> {
    let ends = OpenEnds::of(grid, fluid)?;
    let mut samples = Samples::new(points.len());
    for (number, point) in mine(grid, fluid, points) {
        curl_at(grid, plane, point, |term| samples.add_velocity(number, (grid, ends.as_ref()), term));
    }
    samples.fetch(fluid)
}

/// A scalar that is zero on walls at points of the box, on every rank (cubic interpolation).
pub fn scalars<const D: usize>(grid: &Grid<D>, field: &Vector, points: &[SVector<f64, D>]) -> Result<Vec<f64>> {
    let mut samples = Samples::new(points.len());
    for (number, point) in mine(grid, field, points) {
        interpolation::scalar(grid, point, |index, weight| samples.add(number, grid.node(D, index), weight));
    }
    samples.fetch(field)
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

/// Sums of weighted entries of a vector, each made by one rank.
struct Samples {
    /// What is known of each.
    values: Vec<f64>,
    wanted: Vec<usize>,
    /// Place and weight of each wanted entry.
    terms: Vec<(usize, f64)>,
}

impl Samples {
    fn new(count: usize) -> Samples {
        Samples { values: vec![0.0; count], wanted: Vec::new(), terms: Vec::new() }
    }

    /// Adds a term of velocities to a sample; walls count with their own velocity, open ends with that of the flow.
    fn add_velocity<const D: usize>(&mut self, place: usize, (grid, ends): (&Grid<D>, Option<&OpenEnds<D>>), term: Term<D>) {
        match (ends.and_then(|ends| ends.at_site(grid, &term.site)), term.site) {
            (Some(value), _) | (None, Site::Wall { value, .. }) => self.values[place] += term.weight * value,
            (None, Site::Lattice { field, index }) => self.add(place, grid.fluid_node(field, index), term.weight),
        }
    }

    /// Adds an entry to a sample; on walls that carry no unknown the value is zero.
    fn add(&mut self, place: usize, node: Node, weight: f64) {
        if let Node::Unknown(unknown) = node {
            self.wanted.push(unknown);
            self.terms.push((place, weight));
        }
    }

    /// The samples, on every rank.
    fn fetch(self, vector: &Vector) -> Result<Vec<f64>> {
        let Samples { mut values, wanted, terms } = self;
        let mut scatter = Scatter::new(vector, &wanted)?;
        for ((place, weight), value) in terms.into_iter().zip(scatter.fetch(vector)?.iter()) {
            values[place] += weight * value;
        }
        vector.session().world().sum(&mut values);
        Ok(values)
    }
}
