//! Velocities inside bodies.

use nalgebra::{SMatrix, SVector};

use crate::{
    body::planes,
    grid::Grid,
    system::{
        bodies::BodyTypes,
        points::{Point, each_inside},
    },
};

/// An unknown inside a body of this rank.
pub struct Inside<const D: usize> {
    /// The unknown.
    pub point: Point<D>,
    /// The body.
    pub body: usize,
    /// Centre of the body, not wrapped into the box.
    pub center: SVector<f64, D>,
    /// The time.
    pub time: f64,
}

impl<const D: usize> Inside<D> {
    /// Whether two lie in the same body and have the same component.
    pub fn alike(&self, other: &Inside<D>) -> bool {
        (self.body, self.point.component) == (other.body, other.point.component)
    }
}

/// Those of bodies at these centres and a time, body by body and component by component.
pub fn inside<const D: usize>(grid: &Grid<D>, body_types: &BodyTypes<D>, centers: &[SVector<f64, D>], time: f64) -> Vec<Inside<D>> {
    let mut points = Vec::new();
    for (body, &center) in centers.iter().enumerate() {
        let radius = body_types.surface(body).modes.radius();
        each_inside(grid, &center, radius, |point| points.push(Inside { point, body, center, time }));
    }
    points
}

/// The rigid motion nearest to a field at the points inside a body: the means of its components, which have all of its momentum, and so large a part of its spins in the planes of
/// axes, which have its angular momentum but for what the lattice is askew.
pub fn nearest_rigid<const D: usize>(points: &[Inside<D>], field: &[f64], part: f64) -> Vec<f64> {
    let (mut counts, mut means, mut middles) = ([0.0; D], [0.0; D], [SVector::<f64, D>::zeros(); D]);
    for (inside, value) in points.iter().zip(field) {
        let component = inside.point.component;
        counts[component] += 1.0;
        means[component] += value;
        middles[component] += inside.point.offset;
    }
    for component in 0..D {
        means[component] /= f64::max(counts[component], 1.0);
        middles[component] /= f64::max(counts[component], 1.0);
    }
    let offset = |inside: &Inside<D>| inside.point.offset - middles[inside.point.component];
    let mut spin = SMatrix::<f64, D, D>::zeros();
    for &(first, second) in planes::<D>() {
        let (mut moment, mut inertia) = (0.0, 0.0);
        for (inside, value) in points.iter().zip(field) {
            let arm = match inside.point.component {
                component if component == first => -offset(inside)[second],
                component if component == second => offset(inside)[first],
                _ => 0.0,
            };
            moment += arm * value;
            inertia += arm * arm;
        }
        let rate = if inertia > 0.0 { part * moment / inertia } else { 0.0 };
        (spin[(second, first)], spin[(first, second)]) = (rate, -rate);
    }
    points.iter().map(|inside| means[inside.point.component] + (spin * offset(inside))[inside.point.component]).collect()
}
