//! Interpolation of velocities at points.

use nalgebra::SVector;
use turbid::{
    geometry::{Axis, Domain},
    grid::{Grid, Node, interpolation, stencil::Site},
    petsc::{Scatter, Session},
};

use crate::{
    Test,
    fields::{BOXES_2D, BOXES_3D, Smooth, boxes_2d, boxes_3d, couette, domain, grid, order, sampled, scattered_points},
};

/// Weights of order one times values of order one, 64 of them in 3D.
const ROUNDING: f64 = 1e-13;

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(interpolation_is_of_fourth_order_inside),
        Test::of(interpolation_is_of_fourth_order_next_to_walls_too),
        Test::of(interpolation_is_exact_for_cubics),
        Test::of(interpolation_is_exact_for_couette_flow_between_moving_walls),
        Test::of(on_a_wall_the_velocity_is_that_of_the_wall_whatever_flows_inside),
        Test::of(interpolation_takes_values_of_any_rank),
    ]
}

fn interpolation_is_of_fourth_order_inside(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, cells: usize) {
        for component in 0..D {
            let error = |cells| interpolation_error(&grid(session, domain, cells), component, |_, inside| inside);
            let order = order(cells, error);
            assert!(order >= 3.8, "component {component} of {domain:?}: order {order}");
        }
    }
    proof(session, &domain(BOXES_2D[0]), 16);
    proof(session, &domain(BOXES_3D[0]), 16);
}

fn interpolation_is_of_fourth_order_next_to_walls_too(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, cells: usize) {
        for component in 0..D {
            for upper in [false, true] {
                let error = |cells| {
                    let grid = grid(session, domain, cells);
                    // points within two cells of the lower or upper wall
                    let near = |axis: usize, inside: f64| {
                        let depth = 2.0 * grid.spacing()[axis] / domain.size[axis] * inside;
                        if upper { 1.0 - depth } else { depth }
                    };
                    interpolation_error(&grid, component, |axis, inside| if domain.periodic(axis) { inside } else { near(axis, inside) })
                };
                let order = order(cells, error);
                assert!(order >= 3.8, "component {component} of {domain:?}: order {order}");
            }
        }
    }
    boxes_2d().skip(1).for_each(|domain| proof(session, &domain, 16));
    boxes_3d().skip(1).for_each(|domain| proof(session, &domain, 16));
}

fn interpolation_is_exact_for_cubics(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, cells: usize) {
        let domain = &still(domain);
        let grid = grid(session, domain, cells);
        // between walls the cubic vanishes at both; positions are not wrapped, so a seam does not matter
        let factor = |axis: usize, s: f64| {
            if domain.periodic(axis) { 1.0 + s - 3.0 * s * s + 2.0 * s * s * s } else { s * (1.0 - s) * (1.0 + 2.0 * s) }
        };
        let cubic = |x: &SVector<f64, D>| (0..D).map(|axis| factor(axis, x[axis] / domain.size[axis])).product::<f64>();
        for component in 0..D {
            for point in scattered_points::<D>(200).map(|point| point.component_mul(&domain.size)) {
                assert!((interpolated(&grid, component, &point, cubic) - cubic(&point)).abs() < ROUNDING);
            }
        }
    }
    boxes_2d().for_each(|domain| proof(session, &domain, 6));
    boxes_3d().for_each(|domain| proof(session, &domain, 6));
}

fn interpolation_is_exact_for_couette_flow_between_moving_walls(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, cells: usize) {
        let grid = grid(session, domain, cells);
        let steepest =
            (0..D).map(|component| (couette(domain, component, &domain.size) - couette(domain, component, &SVector::zeros())).abs());
        assert!(steepest.sum::<f64>() > 0.2, "the walls must move");
        for component in 0..D {
            for point in scattered_points::<D>(200).map(|point| point.component_mul(&domain.size)) {
                let value = interpolated(&grid, component, &point, |x| couette(domain, component, x));
                assert!((value - couette(domain, component, &point)).abs() < ROUNDING);
            }
        }
    }
    proof(session, &domain(BOXES_2D[1]), 6);
    proof(session, &domain([true, false]), 6);
    proof(session, &domain(BOXES_3D[1]), 6);
    proof(session, &domain([false, false, true]), 6);
}

fn on_a_wall_the_velocity_is_that_of_the_wall_whatever_flows_inside(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, cells: usize) {
        let grid = grid(session, domain, cells);
        let wild = |x: &SVector<f64, D>| (1e3 * x.sum()).sin();
        for inside in scattered_points::<D>(50).map(|point| point.component_mul(&domain.size)) {
            for (axis, place) in (0..D).flat_map(|axis| [(axis, 0.0), (axis, domain.size[axis])]) {
                let Axis::Walls { lower, upper } = domain.axes[axis] else { continue };
                let point = SVector::from_fn(|other, _| if other == axis { place } else { inside[other] });
                let wall = if place == 0.0 { lower } else { upper };
                for component in 0..D {
                    assert!((interpolated(&grid, component, &point, wild) - wall[component]).abs() < ROUNDING);
                }
            }
        }
    }
    boxes_2d().for_each(|domain| proof(session, &domain, 6));
    boxes_3d().for_each(|domain| proof(session, &domain, 6));
}

fn interpolation_takes_values_of_any_rank(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, cells: usize) {
        let (grid, smooth) = (grid(session, domain, cells), Smooth(domain));
        let value = |component: usize, x: &SVector<f64, D>| smooth.value(component, x) + couette(domain, component, x);
        for component in 0..D {
            let vector = sampled(session, &grid, component, |x| value(component, x));
            let (mut wanted, mut weights, mut known) = (Vec::new(), Vec::new(), Vec::new());
            let points: Vec<SVector<f64, D>> = scattered_points::<D>(40).map(|point| point.component_mul(&domain.size)).collect();
            for point in &points {
                let mut sum = 0.0;
                interpolation::velocity(&grid, component, point, |term| match value_or_number(&grid, term.site) {
                    Ok(value) => sum += term.weight * value,
                    Err(number) => {
                        wanted.push(number);
                        weights.push((known.len(), term.weight));
                    }
                });
                known.push(sum);
            }
            let mut scatter = Scatter::new(&vector, &wanted).unwrap();
            scatter.fetch(&vector).unwrap().iter().zip(&weights).for_each(|(value, (point, weight))| known[*point] += weight * value);
            for (point, found) in points.iter().zip(known) {
                assert!((found - interpolated(&grid, component, point, |x| value(component, x))).abs() < ROUNDING);
            }
        }
    }
    boxes_2d().for_each(|domain| proof(session, &domain, 8));
    boxes_3d().for_each(|domain| proof(session, &domain, 8));
}

/// Spacing and largest interpolation error of a smooth field on Couette flow, at points placed by axis and evenly spread parameter.
fn interpolation_error<const D: usize>(grid: &Grid<D>, component: usize, place: impl Fn(usize, f64) -> f64) -> (f64, f64) {
    let domain = grid.domain();
    let value = |x: &SVector<f64, D>| Smooth(domain).value(component, x) + couette(domain, component, x);
    let errors = scattered_points::<D>(2000).map(|point| {
        let point = SVector::from_fn(|axis, _| domain.size[axis] * place(axis, point[axis]));
        (interpolated(grid, component, &point, value) - value(&point)).abs()
    });
    (grid.mean_spacing(), errors.fold(0.0, f64::max))
}

fn interpolated<const D: usize>(grid: &Grid<D>, component: usize, point: &SVector<f64, D>, value: impl Fn(&SVector<f64, D>) -> f64) -> f64 {
    let mut sum = 0.0;
    interpolation::velocity(grid, component, point, |term| {
        let site = match term.site {
            Site::Lattice { field, index } if value_or_number(grid, term.site).is_err() => value(&grid.position(field, index)),
            site => value_or_number(grid, site).expect("a wall has a value"),
        };
        sum += term.weight * site;
    });
    sum
}

/// The value of a site on a wall, or else the number of its unknown.
fn value_or_number<const D: usize>(grid: &Grid<D>, site: Site<D>) -> Result<f64, usize> {
    match site {
        Site::Wall { value, .. } => Ok(value),
        Site::Lattice { field, index } => match grid.node(field, index) {
            Node::Wall(value) => Ok(value),
            Node::Unknown(number) => Err(number),
        },
    }
}

/// The box with its walls at rest.
fn still<const D: usize>(domain: &Domain<D>) -> Domain<D> {
    let rest = |axis: Axis<D>| if axis == Axis::Periodic { axis } else { Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() } };
    Domain { axes: domain.axes.map(rest), ..domain.clone() }
}
