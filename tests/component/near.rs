//! Near pairs of bodies against the dense blocks of two bodies, alike on any number of ranks.

use nalgebra::{DMatrix, DVector, SVector};
use turbid::{
    body::skew,
    constraint::{Given, MultiplierLayout, Neighbourhood, PairPreconditioner, PairTables},
    geometry::{Axis, Ball, Domain},
    grid::Grid,
    petsc::{Session, Vector},
    surface::{SurfaceTable, mode_count},
};

use crate::Test;

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_pair_of_disks_is_corrected_as_its_dense_block_says),
        Test::of(a_pair_of_spheres_is_corrected_as_its_dense_block_says),
        Test::of(the_correction_of_a_crowd_is_symmetric_on_any_number_of_ranks),
        Test::of(motions_are_answered_as_the_dense_block_says),
    ]
}

fn a_pair_of_disks_is_corrected_as_its_dense_block_says(session: &Session) {
    let larger = 0.1 * 2.0_f64.powf(5.0 / 16.0);
    for (radius, order) in [(0.1, 5), (0.1, 4), (larger, 5)] {
        agrees_with_dense_blocks(session, [0.6, -0.8].into(), [(0.1, 5), (radius, order)], 0.013);
    }
}

fn a_pair_of_spheres_is_corrected_as_its_dense_block_says(session: &Session) {
    let larger = 0.1 * 2.0_f64.powf(5.0 / 16.0);
    for (radius, order) in [(0.1, 3), (0.1, 2), (larger, 3)] {
        agrees_with_dense_blocks(session, [0.48, -0.6, 0.64].into(), [(0.1, 3), (radius, order)], 0.013);
    }
}

/// Some number for each multiplier.
fn numbers(count: usize) -> Vec<f64> {
    (0..count).map(|index| (1.0 + 3.0 * index as f64).sin()).collect()
}

fn agrees_with_dense_blocks<const D: usize>(session: &Session, direction: SVector<f64, D>, bodies: [(f64, usize); 2], gap: f64) {
    let separation = direction * (bodies[0].0 + bodies[1].0 + gap);
    let first = SVector::repeat(0.45);
    let balls = [Ball { center: first, radius: bodies[0].0 }, Ball { center: first + separation, radius: bodies[1].0 }];
    let wanted = numbers(bodies.iter().map(|&(_, order)| mode_count(D, order)).sum());
    let found = correction(session, &balls, &bodies.map(|(_, order)| order), &wanted);
    let surfaces = bodies.map(|(radius, order)| SurfaceTable::<D>::new(radius, order, 0.05 * radius));
    let expected = dense_correction(&surfaces, separation) * DVector::from_vec(wanted);
    let error = (DVector::from_vec(found) - &expected).norm() / expected.norm();
    assert!(error < 2e-4, "{error:.1e}");
}

/// The correction of all bodies, in body order, on every rank.
fn correction<const D: usize>(session: &Session, balls: &[Ball<D>], orders: &[usize], wanted: &[f64]) -> Vec<f64> {
    answer(session, balls, (orders, Given::Forces), wanted)
}

/// The same for what is given of rigid modes.
fn answer<const D: usize>(session: &Session, balls: &[Ball<D>], (orders, given): (&[usize], Given), wanted: &[f64]) -> Vec<f64> {
    let domain = Domain { size: SVector::repeat(1.0), axes: [Axis::Periodic; D] };
    let world = session.world();
    let grid = Grid::new(&domain, 0.05, world.size(), world.rank()).unwrap();
    let counts: Vec<usize> = orders.iter().map(|&order| mode_count(D, order)).collect();
    let centers: Vec<SVector<f64, D>> = balls.iter().map(|ball| ball.center).collect();
    let layout = MultiplierLayout::new(&grid, &centers, &counts, world.rank());
    let ranges = |body: usize| {
        let first: usize = counts[..body].iter().sum();
        (layout.local(body)..layout.local(body) + counts[body], first..first + counts[body])
    };
    let mut multipliers = Vector::new(session, layout.local_unknowns()).unwrap();
    for &body in &layout.local_bodies {
        let (local, all) = ranges(body);
        multipliers.local_mut().unwrap()[local].copy_from_slice(&wanted[all]);
    }
    let neighbourhood = Neighbourhood::alone(&domain, balls.to_vec(), orders.to_vec(), Neighbourhood::reach(balls));
    let mut pairs = PairPreconditioner::new(&neighbourhood, &layout, &PairTables::new(given), &multipliers).unwrap();
    let own = pairs.correction(&multipliers).unwrap();
    let mut found = vec![0.0; wanted.len()];
    for &body in &layout.local_bodies {
        let (local, all) = ranges(body);
        found[all].copy_from_slice(&own[local]);
    }
    world.sum(&mut found);
    found
}

/// Inverse of the block of two bodies less the inverses of their own blocks, all by quadrature in the frame of the box.
fn dense_correction<const D: usize>(surfaces: &[SurfaceTable<D>; 2], separation: SVector<f64, D>) -> DMatrix<f64> {
    let [first, second] = surfaces.each_ref().map(|surface| surface.modes.count());
    let mut alone = DMatrix::zeros(first + second, first + second);
    alone.view_mut((0, 0), (first, first)).copy_from(&isolated(&surfaces[0]));
    alone.view_mut((first, first), (second, second)).copy_from(&isolated(&surfaces[1]));
    let mut together = alone.clone();
    together.view_mut((0, first), (first, second)).copy_from(&caused(&surfaces[0], &surfaces[1], separation));
    together.view_mut((first, 0), (second, first)).copy_from(&caused(&surfaces[1], &surfaces[0], -separation));
    together.try_inverse().unwrap() - alone.try_inverse().unwrap()
}

fn isolated<const D: usize>(surface: &SurfaceTable<D>) -> DMatrix<f64> {
    let mut block = surface.modes.isolated_mobility(1.0);
    (0..surface.modes.rigid_count()).for_each(|mode| block[(mode, mode)] = surface.modes.radius());
    block
}

fn caused<const D: usize>(on: &SurfaceTable<D>, by: &SurfaceTable<D>, separation: SVector<f64, D>) -> DMatrix<f64> {
    let mut block = on_all_modes(on, by, (separation, 1.0));
    block.rows_mut(0, on.modes.rigid_count()).fill(0.0);
    block
}

/// Disks in a row across the boundary and a large one that sees its own image. Free modes alone, weighted by length: reciprocity.
fn the_correction_of_a_crowd_is_symmetric_on_any_number_of_ranks(session: &Session) {
    let disk = |x, y, steps: f64| Ball { center: SVector::from([x, y]), radius: 0.09 * (steps / 16.0).exp2() };
    let balls = [disk(0.05, 0.2, 0.0), disk(0.3, 0.22, 0.0), disk(0.52, 0.2, 0.0), disk(0.9, 0.15, -13.0), disk(0.5, 0.65, 28.0)];
    let orders = [4, 4, 4, 3, 6];
    let some = |seed: f64| -> [Vec<f64>; 2] {
        let modes = orders.iter().zip(&balls).flat_map(|(&order, ball)| (0..mode_count(2, order)).map(|mode| (mode, ball.radius)));
        let numbers = modes.enumerate().map(|(index, (mode, radius))| {
            let number = if mode < 3 { 0.0 } else { (seed * (1 + index) as f64).sin() };
            [number, number / radius]
        });
        let pairs: Vec<[f64; 2]> = numbers.collect();
        [0, 1].map(|which| pairs.iter().map(|pair| pair[which]).collect())
    };
    let ([one, weighted_one], [two, weighted_two]) = (some(1.3), some(2.9));
    let product = |left: &[f64], right: &[f64]| -> f64 { left.iter().zip(right).map(|(left, right)| left * right).sum() };
    let there = product(&two, &correction(session, &balls, &orders, &weighted_one));
    let back = product(&one, &correction(session, &balls, &orders, &weighted_two));
    assert!(there.abs() > 1e-3 && (there - back).abs() < 1e-3 * there.abs(), "{there} {back}");
}

/// Where motions are given: for each of them the multipliers that the dense block of the two calls for, and a motion of both as one calls for none.
fn motions_are_answered_as_the_dense_block_says(session: &Session) {
    for (direction, bodies) in [([0.6, -0.8], [(0.1, 5), (0.1, 5)]), ([0.28, 0.96], [(0.1, 4), (0.1 * 2.0_f64.powf(5.0 / 16.0), 5)])] {
        motions_agree::<2>(session, direction.into(), bodies);
    }
    for bodies in [[(0.1, 3), (0.1, 3)], [(0.1, 2), (0.1 * 2.0_f64.powf(5.0 / 16.0), 3)]] {
        motions_agree::<3>(session, [0.48, -0.6, 0.64].into(), bodies);
    }
}

fn motions_agree<const D: usize>(session: &Session, direction: SVector<f64, D>, bodies: [(f64, usize); 2]) {
    let separation = direction * (bodies[0].0 + bodies[1].0 + 0.013);
    let balls = [SVector::zeros(), separation].map(|from_first| SVector::repeat(0.45) + from_first);
    let balls = [0, 1].map(|body| Ball { center: balls[body], radius: bodies[body].0 });
    let orders = bodies.map(|(_, order)| order);
    let surfaces = bodies.map(|(radius, order)| SurfaceTable::<D>::new(radius, order, 0.05 * radius));
    let [first, second] = surfaces.each_ref().map(|surface| surface.modes.count());
    let rigid = surfaces[0].modes.rigid_count();
    let mut wanted = vec![0.0; first + second];
    // motions alone: what free modes call for differs by what each body calls for alone
    for (number, place) in (0..rigid).chain(first..first + rigid).enumerate() {
        wanted[place] = (1.0 + 3.0 * number as f64).sin();
    }
    let found = DVector::from_vec(answer(session, &balls, (&orders, Given::Motions), &wanted));
    let expected = dense_answer(&surfaces, separation) * DVector::from_vec(wanted);
    let error = (found - &expected).norm() / expected.norm();
    // entries of single precision, cubics between 24 distances
    assert!(error < 5e-4, "{error:.1e}");
    let mut as_one = vec![0.0; first + second];
    as_one[..D].copy_from_slice(direction.as_slice());
    as_one[first..first + D].copy_from_slice(direction.as_slice());
    let none = DVector::from_vec(answer(session, &balls, (&orders, Given::Motions), &as_one));
    assert!(none.norm() < 1e-4 * expected.norm(), "{:.1e}", none.norm());
}

/// Inverse of the block of two bodies where their net force and torque are zero, all by quadrature in the frame of the box.
fn dense_answer<const D: usize>(surfaces: &[SurfaceTable<D>; 2], separation: SVector<f64, D>) -> DMatrix<f64> {
    let [first, second] = surfaces.each_ref().map(|surface| surface.modes.count());
    let (size, rigid) = (first + second, surfaces[0].modes.rigid_count());
    let mut whole = DMatrix::zeros(size + rigid, size + rigid);
    whole.view_mut((0, 0), (first, first)).copy_from(&surfaces[0].modes.isolated_mobility(2.0));
    whole.view_mut((first, first), (second, second)).copy_from(&surfaces[1].modes.isolated_mobility(2.0));
    for (on, by, rows, columns, from) in [(0, 1, (0, first), (first, second), separation), (1, 0, (first, second), (0, first), -separation)]
    {
        let block = on_all_modes(&surfaces[on], &surfaces[by], (from, 2.0));
        whole.view_mut((rows.0, columns.0), (rows.1, columns.1)).copy_from(&block);
    }
    let motion = |mode: usize, at: SVector<f64, D>| match mode {
        axis if axis < D => SVector::from_fn(|row, _| f64::from(row == axis)),
        plane => {
            let unit: Vec<f64> = (D..rigid).map(|other| f64::from(other == plane)).collect();
            skew::<D>(&unit) * at
        }
    };
    for mode in 0..rigid {
        let ends = [(0, 0, SVector::zeros()), (1, first, separation)];
        for (body, start, center) in ends {
            let column = surfaces[body].coefficients(|offset| motion(mode, center + offset));
            for (row, value) in column.into_iter().enumerate() {
                whole[(start + row, size + mode)] = value;
                whole[(size + mode, start + row)] = value * surfaces[body].area();
            }
        }
    }
    whole.try_inverse().unwrap().view((0, 0), (size, size)).into_owned()
}

/// The velocity that unit multipliers of one body cause on another, tested with all its modes; in 2D that of a net force is zero `reach` away.
fn on_all_modes<const D: usize>(on: &SurfaceTable<D>, by: &SurfaceTable<D>, (separation, reach): (SVector<f64, D>, f64)) -> DMatrix<f64> {
    let count = by.modes.count();
    let mut velocity = DMatrix::zeros(on.points() * D, count);
    let mut values = vec![0.0; count * D];
    for (point, offset) in on.offsets().enumerate() {
        by.modes.exterior_velocity((offset - separation).as_slice(), reach, &mut values);
        let columns = DMatrix::from_column_slice(D, count, &values);
        velocity.view_mut((point * D, 0), (D, count)).copy_from(&columns);
    }
    on.projector() * velocity
}
