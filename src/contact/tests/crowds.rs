//! Crowds: random ones that step far, and crystals with more contacts than they need.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;

/// Balls of several sizes at random, that do not overlap; many of the tries fail.
pub(super) fn dense_packing<const D: usize>(domain: Domain<D>, tries: usize, speed: f64, seed: u64) -> Scene<D> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut balls: Vec<Ball<D>> = Vec::new();
    for _ in 0..tries {
        let radius = 0.3 + random.random::<f64>();
        let inside = |axis: usize, part: f64| match domain.periodic(axis) {
            true => part * domain.size[axis],
            false => radius + part * (domain.size[axis] - 2.0 * radius),
        };
        let center = SVector::from_fn(|axis, _| inside(axis, random.random::<f64>()));
        if balls.iter().all(|ball| domain.nearest_image(ball.center - center).norm() >= ball.radius + radius) {
            balls.push(Ball { center, radius });
        }
    }
    let mut number = |_: usize, _: usize| speed * (random.random::<f64>() - 0.5);
    let velocities = balls.iter().map(|_| SVector::from_fn(&mut number)).collect();
    let weights = balls.iter().map(|ball| ball.volume()).collect();
    Scene { domain, balls, weights, velocities, step: 1.0 }
}

fn assert_sound<const D: usize>(scene: &Scene<D>, contacts: usize) {
    let projection = scene.solve().unwrap();
    let kkt_report = projection.kkt_report;
    assert!(scene.overlap(&projection) < 1e-10, "overlap {:e}, {kkt_report:?}", scene.overlap(&projection));
    assert!(kkt_report.kkt_residual < 1e-10, "{kkt_report:?}");
    assert!(kkt_report.active >= contacts, "{kkt_report:?}");
    assert!((kkt_report.smallest_gap.min(0.0) + scene.overlap(&projection)).abs() < 1e-12, "{kkt_report:?}");
    assert!(scene.energy(&projection.velocities) <= scene.energy(&scene.velocities) * (1.0 + EXACT));
}

#[test]
fn disks_that_step_far_never_overlap_and_never_gain_energy() {
    for seed in 0..30 {
        for periodic in [[true, true], [true, false], [false, false]] {
            assert_sound(&dense_packing(domain([20.0, 14.0], periodic), 200, 8.0, seed), 10);
        }
    }
}

#[test]
fn spheres_that_step_far_never_overlap_and_never_gain_energy() {
    for seed in 0..10 {
        for periodic in [[true; 3], [true, false, true], [false; 3]] {
            assert_sound(&dense_packing(domain([8.0, 9.0, 7.0], periodic), 300, 6.0, seed), 10);
        }
    }
}

/// With the images and against them: each way balls meet those that slide past.
#[test]
fn disks_whose_images_slide_never_overlap() {
    for (seed, speed) in (0..30).map(|seed| (seed, [14.0, -9.0, 3.0][seed as usize % 3])) {
        let mut domain = domain([20.0, 14.0], [true, true]);
        domain.axes[1] = Axis::Sheared(LeesEdwards::steady(0.7 * seed as f64, speed, 0.25));
        let mut scene = dense_packing(domain, 200, 4.0, seed);
        if seed % 2 == 0 {
            let carried = scene.balls.iter().map(|ball| scene.domain.carried(&ball.center));
            scene.velocities.iter_mut().zip(carried).for_each(|(velocity, carried)| *velocity += carried);
        }
        let projection = scene.solve().unwrap();
        assert!(scene.overlap(&projection) < 1e-10, "overlap {:e} with seed {seed}", scene.overlap(&projection));
        assert!(projection.kkt_report.kkt_residual < 1e-10, "{:?}", projection.kkt_report);
        assert!(projection.forces.iter().any(|active| active.force > 0.0 && active.contact.image[1] != 0));
    }
}

#[test]
fn momentum_of_a_periodic_crowd_is_kept() {
    let scene = dense_packing(domain([20.0, 14.0], [true, true]), 200, 5.0, 3);
    let momentum = |velocities: &[Vector2<f64>]| scene.weights.iter().zip(velocities).map(|(weight, velocity)| velocity * *weight).sum();
    let before: Vector2<f64> = momentum(&scene.velocities);
    let after: Vector2<f64> = momentum(&scene.solve().unwrap().velocities);
    assert!((after - before).norm() < 1e-11, "{}", after - before);
}

#[test]
fn units_do_not_matter() {
    let scene = dense_packing(domain([20.0, 14.0], [true, false]), 200, 3.0, 5);
    let expected = scene.solve().unwrap();
    for (length, time, weight) in [(1e-9, 1.0, 1.0), (1e9, 1.0, 1.0), (1.0, 1e-9, 1.0), (1.0, 1e9, 1.0), (1.0, 1.0, 1e-9), (1e9, 1e-9, 1e9)]
    {
        let mut scaled = scene.clone();
        scaled.domain.size *= length;
        scaled.step *= time;
        scaled.weights.iter_mut().for_each(|own| *own *= weight);
        scaled.velocities.iter_mut().for_each(|velocity| *velocity *= length / time);
        scaled.balls.iter_mut().for_each(|ball| *ball = Ball { center: ball.center * length, radius: ball.radius * length });
        let found = scaled.solve().unwrap();
        for (velocity, expected) in found.velocities.iter().zip(&expected.velocities) {
            assert!((velocity * time / length - expected).norm() < 1e-8);
        }
        let forces = found.forces.iter().map(|force| force.force * time / length / weight);
        assert!(forces.zip(&expected.forces).all(|(force, expected)| (force - expected.force).abs() < 1e-6));
    }
}

/// Disks of radius 1 in a triangular lattice on the floor, between walls that fit.
pub(super) fn crystal(across: usize, up: usize) -> Scene<2> {
    let height = 3f64.sqrt();
    let place = |row: usize, column: usize| [1.0 + 2.0 * column as f64 + (row % 2) as f64, 1.0 + height * row as f64];
    let bodies: Vec<_> = (0..up).flat_map(|row| (0..across).map(move |column| (place(row, column), [0.0, -1e-3]))).collect();
    Scene::new(domain([2.0 * across as f64 + 1.0, height * up as f64 + 3.0], [false, false]), &bodies)
}

#[test]
fn a_pressed_crystal_stands_still() {
    let projection = crystal(10, 10).solve().unwrap();
    let weight: f64 = 100.0 * 1e-3;
    let floor = projection.forces.iter().filter(|force| force.contact.normal[1] == -1.0);
    assert!((floor.map(|force| force.force).sum::<f64>() - weight).abs() < EXACT);
    assert!(projection.velocities.iter().all(|velocity| velocity.norm() < EXACT));
    assert!(projection.kkt_report.kkt_residual < EXACT, "{:?}", projection.kkt_report);
    assert!(projection.kkt_report.active > 220, "{:?}", projection.kkt_report);
}

#[test]
fn a_pressed_crystal_of_spheres_stands_still() {
    let place = |body: usize| [body % 5, body / 5 % 5, body / 25].map(|index| 1.0 + 2.0 * index as f64);
    let bodies: Vec<_> = (0..125).map(|body| (place(body), [2e-3, 1e-3, -1e-2])).collect();
    let projection = Scene::new(domain([10.0; 3], [false; 3]), &bodies).solve().unwrap();
    assert!(projection.velocities.iter().all(|velocity| velocity.norm() < EXACT));
    assert!(projection.kkt_report.kkt_residual < EXACT, "{:?}", projection.kkt_report);
}

#[test]
fn a_disturbed_crystal_settles_without_overlap() {
    let mut scene = crystal(10, 10);
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for ball in &mut scene.balls {
        ball.radius *= 1.0 - 1e-3 * random.random::<f64>();
    }
    for _ in 0..20 {
        let projection = scene.solve().unwrap();
        assert!(scene.overlap(&projection) < 1e-11, "{:?}", projection.kkt_report);
        assert!(projection.kkt_report.kkt_residual < EXACT, "{:?}", projection.kkt_report);
        scene.balls = scene.moved(&projection);
    }
}

/// A step in which the whole pile could fall through itself, again and again until it lies still.
#[test]
fn a_loose_crystal_settles_in_long_steps() {
    let mut scene = crystal(10, 10);
    let mut random = ChaCha8Rng::seed_from_u64(2);
    scene.balls.iter_mut().for_each(|ball| ball.radius -= 0.3 * random.random::<f64>());
    for _ in 0..60 {
        scene.velocities.iter_mut().for_each(|velocity| velocity[1] -= 1.0);
        let projection = scene.solve().unwrap();
        assert!(scene.overlap(&projection) < 1e-10, "{:?}", projection.kkt_report);
        assert!(projection.kkt_report.kkt_residual < 1e-10, "{:?}", projection.kkt_report);
        scene.balls = scene.moved(&projection);
        scene.velocities = projection.velocities;
    }
    assert!(scene.velocities.iter().all(|velocity| velocity.norm() < 1e-2));
}
