//! Both solvers give the same velocities, whatever the contacts: random, jammed, crystalline, heavy on light.

use proptest::prelude::*;

use super::{
    crowds::{crystal, dense_packing},
    *,
};
use crate::contact::{ContactForce, Memory, Partner, Solver, island::solve_by};

impl<const D: usize> Scene<D> {
    /// The projection by one method alone.
    fn solve_with(&self, solver: Solver, memory: &Memory<D>) -> Result<Projection<D>> {
        alone(&self.problem(), memory, &|problem, contacts, guess| solve_by(problem, contacts, guess, &[solver]))
    }
}

/// Largest difference of velocities by the two methods, over the largest change of a velocity.
fn difference<const D: usize>(scene: &Scene<D>) -> f64 {
    let [one, two] = [Solver::General, Solver::Sparse].map(|solver| scene.solve_with(solver, &Memory::default()).unwrap());
    for found in [&one, &two] {
        assert!(scene.overlap(found) < 1e-7, "{:?}", found.kkt_report);
        assert!(found.kkt_report.kkt_residual < 1e-7, "{:?}", found.kkt_report);
        assert!(scene.energy(&found.velocities) <= scene.energy(&scene.velocities) * (1.0 + EXACT));
    }
    let largest =
        |one: &[SVector<f64, D>], two: &[SVector<f64, D>]| one.iter().zip(two).map(|(one, two)| (one - two).norm()).fold(0.0, f64::max);
    largest(&one.velocities, &two.velocities) / largest(&one.velocities, &scene.velocities).max(f64::MIN_POSITIVE)
}

#[test]
fn random_crowds_move_alike_by_both_solvers() {
    for seed in 0..8 {
        let found = difference(&dense_packing(domain([20.0, 14.0], [true, false]), 200, 6.0, seed));
        assert!(found < 1e-8, "disks: {found:e}");
        let found = difference(&dense_packing(domain([8.0, 9.0, 7.0], [false; 3]), 300, 5.0, seed));
        assert!(found < 1e-8, "spheres: {found:e}");
    }
}

#[test]
fn heavy_and_light_bodies_move_alike_by_both_solvers() {
    for seed in 0..8 {
        let mut scene = dense_packing(domain([20.0, 14.0], [true, false]), 200, 6.0, seed);
        scene.weights.iter_mut().step_by(2).for_each(|weight| *weight *= 1e3);
        let found = difference(&scene);
        assert!(found < 1e-8, "{found:e}");
    }
}

#[test]
fn crystals_with_more_contacts_than_they_need_move_alike_by_both_solvers() {
    let found = difference(&crystal(12, 12));
    assert!(found < 1e-8, "{found:e}");
}

#[test]
fn a_jammed_box_moves_alike_by_both_solvers() {
    let mut scene = crystal(10, 10);
    scene.balls.iter_mut().enumerate().for_each(|(body, ball)| ball.radius *= 1.0 - 1e-3 * ((body * 7919 % 101) as f64 / 101.0));
    for _ in 0..3 {
        scene.velocities.iter_mut().for_each(|velocity| velocity[1] -= 0.01);
        let found = difference(&scene);
        assert!(found < 1e-7, "{found:e}");
        let projection = scene.solve().unwrap();
        scene.balls = scene.moved(&projection);
        scene.velocities = projection.velocities;
    }
}

#[test]
fn a_pile_at_rest_needs_no_iteration_from_its_own_forces() {
    let scene = crystal(12, 12);
    let first = scene.solve_with(Solver::Sparse, &Memory::default()).unwrap();
    let memory = first.forces.iter().map(|force| (force.contact.identity(), force.force)).collect();
    let again = scene.solve_with(Solver::Sparse, &memory).unwrap();
    assert!(first.kkt_report.iterations > 0 && again.kkt_report.iterations == 0, "{:?}", again.kkt_report);
    assert_eq!(again.kkt_report.solver, Solver::Sparse);
}

#[test]
fn wrong_forces_to_start_from_lead_to_the_same_velocities() {
    for seed in 0..6 {
        let scene = dense_packing(domain([20.0, 14.0], [true, false]), 200, 6.0, seed);
        let first = scene.solve_with(Solver::Sparse, &Memory::default()).unwrap();
        for size in [1e-3, 1.0, 1e3] {
            let wrong = |(place, force): (usize, &ContactForce<2>)| (force.contact.identity(), size * (place * 7919 % 13) as f64);
            let memory = first.forces.iter().enumerate().map(wrong).collect();
            let again = scene.solve_with(Solver::Sparse, &memory).unwrap();
            let apart = first.velocities.iter().zip(&again.velocities).map(|(one, two)| (one - two).norm()).fold(0.0, f64::max);
            assert!(apart < 1e-8, "{apart:e} with forces up to {size}");
            assert!(again.kkt_report.kkt_residual < 1e-9, "{:?}", again.kkt_report);
        }
    }
}

#[test]
fn exact_impacts_come_out_of_both_solvers() {
    for solver in [Solver::General, Solver::Sparse] {
        for count in [2, 3, 10] {
            let scene = row(count, |body| Vector2::new(if body == 0 { 1.0 } else { 0.0 }, 0.0));
            for velocity in scene.solve_with(solver, &Memory::default()).unwrap().velocities {
                assert!((velocity - Vector2::new(1.0 / count as f64, 0.0)).norm() < 1e-10, "{solver:?} {velocity}");
            }
        }
        let bodies: Vec<_> = (0..8).map(|body| ([5.0, 1.0 + 2.0 * body as f64], [0.0, -0.1])).collect();
        let projection = Scene::new(domain([20.0, 40.0], [true, false]), &bodies).solve_with(solver, &Memory::default()).unwrap();
        for force in projection.forces {
            let carried = match force.contact.partner {
                Partner::Wall { .. } => 8,
                Partner::Body(other) => 8 - other,
            };
            assert!((force.force - 0.1 * carried as f64).abs() < 1e-9, "{solver:?} {}", force.force);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    /// Impacts without walls keep momentum and create no energy.
    #[test]
    fn random_impacts_keep_momentum_and_create_no_energy(seed in 0u64..1000, speed in 0.1f64..10.0) {
        let scene = dense_packing(domain([16.0, 12.0], [true, true]), 120, speed, seed);
        let momentum = |velocities: &[Vector2<f64>]| -> Vector2<f64> { scene.weights.iter().zip(velocities).map(|(weight, velocity)| velocity * *weight).sum() };
        for solver in [Solver::General, Solver::Sparse] {
            let velocities = scene.solve_with(solver, &Memory::default()).unwrap().velocities;
            prop_assert!((momentum(&velocities) - momentum(&scene.velocities)).norm() < 1e-11 * speed.max(1.0));
            prop_assert!(scene.energy(&velocities) <= scene.energy(&scene.velocities) * (1.0 + EXACT));
        }
    }
}
