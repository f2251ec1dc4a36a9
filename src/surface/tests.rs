//! What any family of modes must satisfy, tried on both.

use std::f64::consts::PI;

use nalgebra::DMatrix;

use super::*;

const RADIUS: f64 = 0.7;

/// Both families at a low and a higher order.
fn families() -> Vec<Box<dyn Modes>> {
    let orders = [(2, 1), (2, 4), (3, 1), (3, 4)];
    orders.map(|(dimension, order)| modes(dimension, RADIUS, order)).into()
}

/// A direction that no symmetry singles out.
fn direction(dimension: usize) -> Vec<f64> {
    match dimension {
        2 => vec![0.6, -0.8],
        _ => vec![0.48, -0.6, 0.64],
    }
}

fn scaled(direction: &[f64], factor: f64) -> Vec<f64> {
    direction.iter().map(|x| x * factor).collect()
}

fn shifted(offset: &[f64], axis: usize, step: f64) -> Vec<f64> {
    let mut offset = offset.to_vec();
    offset[axis] += step;
    offset
}

fn traction(modes: &dyn Modes, direction: &[f64]) -> Vec<f64> {
    let mut out = vec![f64::NAN; modes.count() * modes.dimension()];
    modes.traction(direction, &mut out);
    out
}

/// Velocity component, or pressure when `component` is the dimension.
fn jump(modes: &dyn Modes, offset: &[f64], component: usize) -> Vec<f64> {
    let mut out = vec![f64::NAN; modes.count()];
    if component == modes.dimension() {
        modes.pressure_jumps(offset, &mut out);
    } else {
        modes.velocity_jumps(offset, component, &mut out);
    }
    out
}

/// Fourth-order central difference along `axis`.
fn slope(modes: &dyn Modes, offset: &[f64], component: usize, axis: usize) -> Vec<f64> {
    let step = 1e-3 * RADIUS;
    let difference = |factor: f64| -> Vec<f64> {
        let ahead = jump(modes, &shifted(offset, axis, factor * step), component);
        let behind = jump(modes, &shifted(offset, axis, -factor * step), component);
        ahead.iter().zip(behind).map(|(a, b)| (a - b) / (2.0 * factor * step)).collect()
    };
    difference(1.0).iter().zip(difference(2.0)).map(|(near, far)| (4.0 * near - far) / 3.0).collect()
}

/// Fourth-order second difference along `axis`.
fn curvature(modes: &dyn Modes, offset: &[f64], component: usize, axis: usize) -> Vec<f64> {
    let step = 2e-3 * RADIUS;
    let at = |factor: f64| jump(modes, &shifted(offset, axis, factor * step), component);
    let stencil = [(-2.0, -1.0), (-1.0, 16.0), (0.0, -30.0), (1.0, 16.0), (2.0, -1.0)];
    let mut sum = vec![0.0; modes.count()];
    for (factor, weight) in stencil {
        sum.iter_mut().zip(at(factor)).for_each(|(s, value)| *s += weight * value / (12.0 * step * step));
    }
    sum
}

fn sum(terms: impl Iterator<Item = Vec<f64>>) -> Vec<f64> {
    terms.reduce(|total, term| total.iter().zip(term).map(|(a, b)| a + b).collect()).expect("at least one term")
}

/// `matrix[m][n]`: mean over the surface of `F_m . F_n`.
fn products(modes: &dyn Modes, rule: &Quadrature) -> DMatrix<f64> {
    let dimension = modes.dimension();
    let mut matrix = DMatrix::zeros(modes.count(), modes.count());
    for (direction, weight) in rule.directions.chunks(dimension).zip(&rule.weights) {
        let tractions = DMatrix::from_vec(dimension, modes.count(), traction(modes, direction));
        matrix += *weight * tractions.transpose() * tractions;
    }
    matrix
}

/// Entries `(i, j)` of the first moments `mean F_i n_j` of every mode.
fn first_moments(modes: &dyn Modes) -> Vec<DMatrix<f64>> {
    let dimension = modes.dimension();
    let rule = quadrature(dimension, 1.0, 6);
    let mut moments = vec![DMatrix::zeros(dimension, dimension); modes.count()];
    for (direction, weight) in rule.directions.chunks(dimension).zip(&rule.weights) {
        for (moment, force) in moments.iter_mut().zip(traction(modes, direction).chunks(dimension)) {
            *moment += *weight * DMatrix::from_fn(dimension, dimension, |i, j| force[i] * direction[j]);
        }
    }
    moments
}

#[test]
fn counts_are_those_of_the_families() {
    let counts = families().iter().map(|modes| (modes.count(), modes.rigid_count())).collect::<Vec<_>>();
    assert_eq!(counts, [(5, 3), (17, 3), (9, 6), (72, 6)]);
    assert_eq!([mode_count(2, 4), mode_count(3, 4)], [17, 72]);
}

#[test]
fn modes_are_orthonormal_in_the_mean() {
    for modes in families() {
        let products = products(modes.as_ref(), &quadrature(modes.dimension(), 0.5, 4));
        assert!((products - DMatrix::identity(modes.count(), modes.count())).abs().max() < 1e-13);
    }
}

#[test]
fn rigid_modes_are_unit_translations_and_rotations_and_come_first() {
    let [x, y] = [0.6, -0.8];
    assert!(close(&traction(&Fourier::new(RADIUS, 3), &[x, y])[..6], &[1.0, 0.0, 0.0, 1.0, -y, x]));
    let [x, y, z] = [0.48, -0.6, 0.64];
    let root = 1.5_f64.sqrt();
    let expected = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let turns = [0.0, -z, y, z, 0.0, -x, -y, x, 0.0].map(|value| root * value);
    let tractions = traction(&Spherical::new(RADIUS, 3), &[x, y, z]);
    assert!(close(&tractions[..9], &expected) && close(&tractions[9..18], &turns));
}

fn close(values: &[f64], expected: &[f64]) -> bool {
    values.iter().zip(expected).all(|(value, expected)| (value - expected).abs() < 1e-14)
}

#[test]
fn force_and_torque_factors_are_those_of_the_rigid_modes() {
    for modes in families() {
        let dimension = modes.dimension();
        let moment = &first_moments(modes.as_ref())[modes.rigid_count() - 1];
        let area = modes.force_factor();
        let torque = area * RADIUS * (moment[(1, 0)] - moment[(0, 1)]);
        assert!((area - [2.0 * PI * RADIUS, 4.0 * PI * RADIUS * RADIUS][dimension - 2]).abs() < 1e-14);
        assert!((torque - modes.torque_factor()).abs() < 1e-13);
    }
}

#[test]
fn the_velocity_jump_vanishes_on_the_surface() {
    for modes in families() {
        let offset = scaled(&direction(modes.dimension()), RADIUS);
        for component in 0..modes.dimension() {
            assert!(jump(modes.as_ref(), &offset, component).iter().all(|value| value.abs() < 1e-14));
        }
    }
}

#[test]
fn the_jump_functions_satisfy_stokes() {
    for modes in families() {
        let dimension = modes.dimension();
        for factor in [0.75, 1.3] {
            let offset = scaled(&direction(dimension), factor * RADIUS);
            let divergence = sum((0..dimension).map(|axis| slope(modes.as_ref(), &offset, axis, axis)));
            assert!(divergence.iter().all(|value| value.abs() < 1e-7), "{divergence:?}");
            for component in 0..dimension {
                let laplacian = sum((0..dimension).map(|axis| curvature(modes.as_ref(), &offset, component, axis)));
                let push = slope(modes.as_ref(), &offset, dimension, component);
                let residual = laplacian.iter().zip(push).map(|(l, p)| l - p);
                assert!(residual.clone().all(|value| value.abs() < 1e-6), "{:?}", residual.collect::<Vec<_>>());
            }
        }
    }
}

#[test]
fn the_jump_of_stress_on_the_surface_is_minus_the_traction() {
    for modes in families() {
        let (dimension, normal) = (modes.dimension(), direction(modes.dimension()));
        let offset = scaled(&normal, RADIUS);
        let tractions = traction(modes.as_ref(), &normal);
        let pressure = jump(modes.as_ref(), &offset, dimension);
        for i in 0..dimension {
            let strain = sum((0..dimension).map(|j| {
                let pair = slope(modes.as_ref(), &offset, i, j).into_iter().zip(slope(modes.as_ref(), &offset, j, i));
                pair.map(|(a, b)| normal[j] * (a + b)).collect()
            }));
            for mode in 0..modes.count() {
                let stress = strain[mode] - pressure[mode] * normal[i];
                assert!((stress + tractions[mode * dimension + i]).abs() < 1e-8);
            }
        }
    }
}

#[test]
fn the_pressure_jump_on_the_surface_is_the_normal_traction() {
    for modes in families() {
        let (dimension, normal) = (modes.dimension(), direction(modes.dimension()));
        let pressure = jump(modes.as_ref(), &scaled(&normal, RADIUS), dimension);
        for (value, force) in pressure.iter().zip(traction(modes.as_ref(), &normal).chunks(dimension)) {
            let expected: f64 = force.iter().zip(&normal).map(|(f, n)| f * n).sum();
            assert!((value - expected).abs() < 1e-13);
        }
    }
}

#[test]
fn the_isolated_mobility_is_symmetric_positive_definite() {
    for modes in families() {
        let mobility = modes.isolated_mobility(10.0 * RADIUS);
        assert!((mobility.clone() - mobility.transpose()).abs().max() < 1e-14);
        assert!(mobility.cholesky().is_some());
    }
}

/// Exact first moments of the traction per unit area: `-2 mu E` (disk) and `-(20/3) pi mu a^3 E / (4 pi a^2 a)` (sphere),
/// the Einstein coefficients 2 and 5/2.
#[test]
fn a_ball_in_strain_has_einsteins_stresslet() {
    for (dimension, expected) in [(2, -2.0), (3, -5.0 / 3.0)] {
        let modes = modes(dimension, RADIUS, 3);
        let moments = first_moments(modes.as_ref());
        let strain = DMatrix::from_fn(dimension, dimension, |i, j| match (i, j) {
            (0, 0) => 1.0,
            (1, 1) => -1.0,
            (0, 1) | (1, 0) => 0.4,
            _ => 0.0,
        });
        let background = DMatrix::from_fn(modes.count(), 1, |mode, _| -RADIUS * moments[mode].dot(&strain));
        let coefficients = modes.isolated_mobility(10.0).cholesky().expect("positive definite").solve(&background);
        let moment = moments.iter().zip(&coefficients).fold(0.0 * &strain, |sum, (moment, c)| sum + moment * *c);
        assert!((moment - expected * strain).abs().max() < 1e-13);
    }
}

#[test]
fn a_point_has_the_same_jumps_alone_and_among_others() {
    for modes in families() {
        let (dimension, count) = (modes.dimension(), modes.count());
        let offsets: Vec<f64> = (0..11).flat_map(|point| scaled(&direction(dimension), 0.5 + 0.1 * f64::from(point))).collect();
        for component in 0..=dimension {
            let mut together = vec![f64::NAN; 11 * count];
            match component {
                pressure if pressure == dimension => modes.pressure_jumps(&offsets, &mut together),
                _ => modes.velocity_jumps(&offsets, component, &mut together),
            }
            let alone: Vec<f64> = offsets.chunks(dimension).flat_map(|offset| jump(modes.as_ref(), offset, component)).collect();
            assert_eq!(together, alone);
        }
    }
}

#[test]
fn the_largest_orders_are_finite_near_the_centre_and_vanish_on_the_surface() {
    for (dimension, order) in [(2, fourier::MAXIMUM_ORDER), (3, spherical::MAXIMUM_ORDER)] {
        let modes = modes(dimension, RADIUS, order);
        let offset = scaled(&direction(dimension), 0.01 * RADIUS);
        for component in 0..=dimension {
            assert!(jump(modes.as_ref(), &offset, component).iter().all(|value| value.is_finite()));
        }
    }
}

/// Prints nanoseconds per point: `cargo test --release surface -- --ignored --nocapture`.
#[test]
#[ignore]
#[allow(clippy::print_stdout)]
fn timing_of_one_evaluation() {
    const POINTS: usize = 200;
    for (dimension, order) in [(2, 4), (2, 6), (2, 12), (3, 3), (3, 5), (3, 8)] {
        let modes = modes(dimension, RADIUS, order);
        let offsets = scaled(&direction(dimension), 1.1 * RADIUS).repeat(POINTS);
        let mut out = vec![0.0; modes.count() * POINTS];
        let mut time = |component: usize| {
            let start = std::time::Instant::now();
            for _ in 0..1000 {
                let offsets = std::hint::black_box(&offsets);
                if component == dimension {
                    modes.pressure_jumps(offsets, &mut out);
                } else {
                    modes.velocity_jumps(offsets, component, &mut out);
                }
                std::hint::black_box(&out);
            }
            start.elapsed().as_secs_f64() / (1000 * POINTS) as f64 * 1e9
        };
        let (velocity, pressure) = (time(0), time(dimension));
        println!("{dimension}D order {order}: velocity {velocity:.0} ns, pressure {pressure:.0} ns");
    }
}

fn exterior(modes: &dyn Modes, offset: &[f64]) -> Vec<f64> {
    let mut out = vec![f64::NAN; modes.count() * modes.dimension()];
    modes.exterior_velocity(offset, 10.0 * RADIUS, &mut out);
    out
}

#[test]
fn the_exterior_velocity_on_the_surface_is_the_isolated_mobility() {
    for modes in families() {
        let (dimension, count) = (modes.dimension(), modes.count());
        let rule = quadrature(dimension, 0.5, 5);
        let mut mobility = DMatrix::zeros(count, count);
        for (direction, weight) in rule.directions.chunks(dimension).zip(&rule.weights) {
            let tractions = DMatrix::from_vec(dimension, count, traction(modes.as_ref(), direction));
            let velocities = DMatrix::from_vec(dimension, count, exterior(modes.as_ref(), &scaled(direction, RADIUS)));
            mobility += *weight * tractions.transpose() * velocities;
        }
        assert!((mobility - modes.isolated_mobility(10.0 * RADIUS)).abs().max() < 1e-13);
    }
}

/// In 2D a net force moves the far fluid too, by a logarithm.
#[test]
fn the_exterior_velocity_is_free_of_sources_and_decays() {
    for modes in families() {
        let (dimension, step) = (modes.dimension(), 1e-4 * RADIUS);
        let offset = scaled(&direction(dimension), 1.4 * RADIUS);
        let slope = |axis: usize| -> Vec<f64> {
            let ahead = exterior(modes.as_ref(), &shifted(&offset, axis, step));
            let behind = exterior(modes.as_ref(), &shifted(&offset, axis, -step));
            ahead.iter().zip(behind).skip(axis).step_by(dimension).map(|(a, b)| (a - b) / (2.0 * step)).collect()
        };
        assert!(sum((0..dimension).map(slope)).iter().all(|value| value.abs() < 1e-6));
        let far = [1e3, 2e3].map(|factor| exterior(modes.as_ref(), &scaled(&direction(dimension), factor * RADIUS)));
        let forces = if dimension == 2 { 2 * dimension } else { 0 };
        assert!(far[0][forces..].iter().zip(&far[1][forces..]).all(|(near, far)| far.abs() < 0.51 * near.abs() + 1e-15));
    }
}

/// What a force makes of pressure, `F . r / (S r^D)`, summed over the surface.
#[test]
fn the_exterior_pressure_is_that_of_the_tractions() {
    for modes in families() {
        let dimension = modes.dimension();
        let offset = scaled(&direction(dimension), 2.5 * RADIUS);
        let rule = quadrature(dimension, 40.0, 5);
        let mut expected = vec![0.0; modes.count()];
        for (direction, weight) in rule.directions.chunks(dimension).zip(&rule.weights) {
            let apart: Vec<f64> = offset.iter().zip(direction).map(|(point, normal)| point - RADIUS * normal).collect();
            let distance = apart.iter().map(|x| x * x).sum::<f64>().sqrt();
            let scale = weight * area(dimension, RADIUS) / (area(dimension, distance) * distance);
            for (sum, force) in expected.iter_mut().zip(traction(modes.as_ref(), direction).chunks(dimension)) {
                *sum += scale * force.iter().zip(&apart).map(|(force, apart)| force * apart).sum::<f64>();
            }
        }
        let mut found = vec![f64::NAN; modes.count()];
        modes.exterior_pressure(&offset, &mut found);
        assert!(found.iter().zip(&expected).all(|(found, expected)| (found - expected).abs() < 1e-12), "{found:?} {expected:?}");
    }
}

/// Stokes: the Laplacian of the velocity is the gradient of a pressure, so its curl vanishes.
#[test]
fn the_laplacian_of_the_exterior_velocity_is_a_gradient() {
    for modes in families() {
        let (dimension, step) = (modes.dimension(), 0.02 * RADIUS);
        let offset = scaled(&direction(dimension), 1.5 * RADIUS);
        let laplacian = |offset: &[f64]| -> Vec<f64> {
            let mut total: Vec<f64> = exterior(modes.as_ref(), offset).iter().map(|value| -2.0 * dimension as f64 * value).collect();
            for (axis, side) in (0..dimension).flat_map(|axis| [(axis, step), (axis, -step)]) {
                total.iter_mut().zip(exterior(modes.as_ref(), &shifted(offset, axis, side))).for_each(|(total, value)| *total += value);
            }
            total.iter().map(|value| value / (step * step)).collect()
        };
        let slope = |axis: usize| -> Vec<f64> {
            let pair = laplacian(&shifted(&offset, axis, step)).into_iter().zip(laplacian(&shifted(&offset, axis, -step)));
            pair.map(|(ahead, behind)| (ahead - behind) / (2.0 * step)).collect()
        };
        let slopes: Vec<Vec<f64>> = (0..dimension).map(slope).collect();
        for (i, j) in (0..dimension).flat_map(|i| (0..i).map(move |j| (i, j))) {
            for mode in 0..modes.count() {
                let (one, two) = (slopes[i][mode * dimension + j], slopes[j][mode * dimension + i]);
                assert!((one - two).abs() < 0.02 * (1.0 + one.abs()), "{one} {two}");
            }
        }
    }
}

#[test]
fn far_away_a_translating_sphere_is_a_stokeslet() {
    let modes = Spherical::new(RADIUS, 2);
    let (normal, distance) = (direction(3), 1e4 * RADIUS);
    let velocity = exterior(&modes, &scaled(&normal, distance));
    for (force, i) in (0..3).flat_map(|force| (0..3).map(move |i| (force, i))) {
        let unit = if force == i { 1.0 } else { 0.0 };
        let expected = modes.force_factor() / (8.0 * PI * distance) * (unit + normal[force] * normal[i]);
        assert!((velocity[force * 3 + i] - expected).abs() < 1e-7 * expected.abs().max(1e-5));
    }
}

/// Velocities of modes of another ball tested with those of one of the given radius, by a fine rule: the frames of both turned half round.
fn pair_by_quadrature(dimension: usize, [on, by]: [&dyn Modes; 2], distance: f64, reach: f64) -> DMatrix<f64> {
    let rule = quadrature(dimension, 30.0, 20);
    let (axis, signs) = [(0, [-1.0, -1.0, 1.0]), (2, [-1.0, 1.0, -1.0])][dimension - 2];
    let mut out = DMatrix::zeros(on.count(), by.count());
    let mut velocities = vec![0.0; by.count() * dimension];
    for (direction, weight) in rule.directions.chunks(dimension).zip(&rule.weights) {
        let at = |i: usize| signs[i] * (on.radius() * direction[i] - if i == axis { distance } else { 0.0 });
        by.exterior_velocity(&(0..dimension).map(at).collect::<Vec<f64>>(), reach, &mut velocities);
        let tractions = traction(on, direction);
        for (row, force) in tractions.chunks(dimension).enumerate() {
            for (column, velocity) in velocities.chunks(dimension).enumerate() {
                out[(row, column)] += weight * (0..dimension).map(|i| force[i] * signs[i] * velocity[i]).sum::<f64>();
            }
        }
    }
    out
}

#[test]
fn what_modes_cause_on_another_ball_is_the_mean_of_their_velocity_there() {
    for (dimension, radii, distance) in [(2, [0.7, 1.1], 2.7), (2, [1.3, 0.4], 2.5), (3, [0.7, 1.1], 2.7), (3, [1.3, 0.4], 2.5)] {
        let [on, by] = [modes(dimension, radii[0], 4), modes(dimension, radii[1], 3)];
        let exact = pair_by_quadrature(dimension, [on.as_ref(), by.as_ref()], distance, 9.0);
        let members = |modes: &dyn Modes, number: usize| -> Vec<usize> {
            let degrees = modes.degrees();
            let all = degrees.iter().flat_map(|degree| degree.modes.iter().zip(&degree.orders));
            all.filter(|(_, order)| **order == number).map(|(mode, _)| *mode).collect()
        };
        let mut found = DMatrix::zeros(on.count(), by.count());
        for number in 0..=2 * 4 + 1 {
            let (rows, columns) = (members(on.as_ref(), number), members(by.as_ref(), number));
            let block = pair_mobility(dimension, radii, distance, 9.0, [&rows, &columns]);
            for (i, row) in rows.iter().enumerate() {
                columns.iter().enumerate().for_each(|(j, column)| found[(*row, *column)] = block[(i, j)]);
            }
        }
        for row in 0..on.count() {
            for column in 0..by.count() {
                let (one, other) = (found[(row, column)], exact[(row, column)]);
                assert!((one - other).abs() < 1e-11, "{dimension}D mode {column} on {row}: {one} {other}");
            }
        }
    }
}
