//! The vorticity of known flows, at the centres of cells and at points, beside walls and across ranks.

use std::f64::consts::TAU;

use nalgebra::SVector;
use turbid::{
    body::{components, planes, skew},
    flow::{Drive, Stokes},
    geometry::{Axis, Domain, LeesEdwards},
    grid::{Grid, operators::signed},
    observe::{CellVorticity, vorticity_at},
    petsc::{Session, Vector},
};

use crate::{
    Test,
    fields::{Smooth, boxes_2d, boxes_3d, couette, domain, grid, order, scattered_points},
};

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(shear_between_walls_has_its_vorticity_exactly),
        Test::of(vorticity_goes_on_where_images_lie_aside),
        Test::of(a_rigid_rotation_has_twice_its_spin_exactly),
        Test::of(vorticity_is_of_second_order_up_to_the_walls),
    ]
}

/// A fluid vector with the values of a function of the component and the position.
pub fn filled<const D: usize>(session: &Session, grid: &Grid<D>, value: impl Fn(usize, &SVector<f64, D>) -> f64) -> Vector {
    let mut fluid = Stokes::new(session, grid).vector().unwrap();
    let mut values = fluid.local_mut().unwrap();
    for component in 0..D {
        for (entry, index) in values[grid.local_range(component)].iter_mut().zip(grid.block(component).indices()) {
            *entry = value(component, &grid.position(component, signed(index)));
        }
    }
    drop(values);
    fluid
}

/// The vorticity at the centres of this rank's cells with their positions, all components one after the other.
fn at_centers<const D: usize>(grid: &Grid<D>, fluid: &Vector, drive: &Drive<D>) -> Vec<(SVector<f64, D>, Vec<f64>)> {
    let found = CellVorticity::new(grid, fluid).unwrap().evaluate(grid, fluid, drive).unwrap();
    let centers = grid.block(D).indices().map(|index| grid.position(D, signed(index)));
    centers.zip(found.chunks(planes::<D>().len()).map(<[f64]>::to_vec)).collect()
}

fn shear_between_walls_has_its_vorticity_exactly(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>) {
        let grid = grid(session, domain, 9);
        let fluid = filled(session, &grid, |component, x| couette(domain, component, x));
        let Axis::Walls { lower, upper } = domain.axes[1] else { unreachable!() };
        let rate = (upper - lower) / domain.size[1];
        let slope = |component: usize, axis: usize| if axis == 1 { rate[component] } else { 0.0 };
        let exact: Vec<f64> = planes::<D>().iter().map(|&(row, column)| slope(row, column) - slope(column, row)).collect();
        for (x, found) in at_centers(&grid, &fluid, &Drive::Rest) {
            assert!(found.iter().zip(&exact).all(|(found, exact)| (found - exact).abs() < 1e-11), "{found:?} at {x:?}, not {exact:?}");
        }
        let points: Vec<SVector<f64, D>> = scattered_points(40).map(|point: SVector<f64, D>| point.component_mul(&domain.size)).collect();
        for (&plane, exact) in planes::<D>().iter().zip(&exact) {
            let found = vorticity_at(&grid, &fluid, &Drive::Rest, &points, plane).unwrap();
            assert!(found.iter().all(|found| (found - exact).abs() < 1e-11), "{found:?} in {plane:?}, not {exact}");
        }
    }
    proof(session, &domain([false, true]));
    proof(session, &domain([false, true, false]));
}

/// Waves that go on in images displaced by a third of the box, beside a background that they disturb.
fn vorticity_goes_on_where_images_lie_aside(session: &Session) {
    let sheared = Axis::Sheared(LeesEdwards::steady(0.0, 2.0, 1.0 / 6.0));
    let domain = Domain { size: SVector::from([1.0, 1.0]), axes: [Axis::Periodic, sheared] };
    let grid = grid(session, &domain, 48);
    let phase = |x: &SVector<f64, 2>| TAU * (x[0] - x[1] / 3.0);
    let waves = filled(session, &grid, |component, x| if component == 1 { phase(x).sin() } else { 0.0 });
    for (x, found) in at_centers(&grid, &waves, &Drive::Shear(2.0)) {
        let exact = TAU * phase(&x).cos() - 2.0;
        assert!((found[0] - exact).abs() < 0.01 * TAU, "{found:?} at {x:?}, not {exact}");
    }
}

/// Away from where the box repeats, across which no rotation goes on.
fn a_rigid_rotation_has_twice_its_spin_exactly(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, spins: &[f64]) {
        let (grid, spin) = (grid(session, domain, 10), skew::<D>(spins));
        let fluid = filled(session, &grid, |component, x| (spin * x)[component]);
        let inner = |x: &SVector<f64, D>| (0..D).all(|axis| x[axis] > 0.2 && x[axis] < domain.size[axis] - 0.2);
        let mut count = [0.0];
        for (x, found) in at_centers(&grid, &fluid, &Drive::Rest).into_iter().filter(|(x, _)| inner(x)) {
            let exact = components(&spin).into_iter().map(|spin| 2.0 * spin);
            assert!(found.iter().zip(exact).all(|(found, exact)| (found - exact).abs() < 1e-11), "{found:?} at {x:?}");
            count[0] += 1.0;
        }
        session.world().sum(&mut count);
        assert!(count[0] > 30.0);
    }
    boxes_2d().for_each(|domain| proof(session, &domain, &[0.7]));
    boxes_3d().for_each(|domain| proof(session, &domain, &[0.3, -0.5, 0.7]));
}

/// Waves along periodic axes; between walls velocities with any slope and curvature at them, and those of the walls.
fn vorticity_is_of_second_order_up_to_the_walls(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, coarse: usize) {
        let smooth = Smooth(domain);
        let slope = |component: usize, axis: usize, x: &SVector<f64, D>| {
            let of_walls = match domain.axes[axis] {
                Axis::Walls { lower, upper } => (upper - lower)[component] / domain.size[axis],
                _ => 0.0,
            };
            smooth.slope(component, axis, x) + of_walls
        };
        let exact = |x: &SVector<f64, D>, (row, column): (usize, usize)| slope(row, column, x) - slope(column, row, x);
        let points: Vec<SVector<f64, D>> = scattered_points(400).map(|point: SVector<f64, D>| point.component_mul(&domain.size)).collect();
        // the largest error at centres, and the root of the mean square of those at points
        let errors = |cells: usize| {
            let grid = grid(session, domain, cells);
            let fluid = filled(session, &grid, |component, x| smooth.value(component, x) + couette(domain, component, x));
            let (mut worst, mut square) = (0.0_f64, 0.0);
            for (x, found) in at_centers(&grid, &fluid, &Drive::Rest) {
                worst = found.iter().zip(planes::<D>()).map(|(found, &plane)| (found - exact(&x, plane)).abs()).fold(worst, f64::max);
            }
            for &plane in planes::<D>() {
                let found = vorticity_at(&grid, &fluid, &Drive::Rest, &points, plane).unwrap();
                square += points.iter().zip(found).map(|(x, found)| (found - exact(x, plane)).powi(2)).sum::<f64>();
            }
            (grid.spacing()[0], [session.world().max(worst), square.sqrt()])
        };
        for (place, name) in ["centres", "points"].into_iter().enumerate() {
            let order = order(coarse, |cells| {
                let (h, errors) = errors(cells);
                (h, errors[place])
            });
            assert!(order > 1.75, "order {order} at {name} in {domain:?}");
        }
    }
    boxes_2d().for_each(|domain| proof(session, &domain, 32));
    boxes_3d().for_each(|domain| proof(session, &domain, 16));
}
