//! Impacts whose outcome is known in closed form.

use nalgebra::Vector2;

use super::*;
use crate::contact::Partner;

#[test]
fn an_impact_on_a_touching_row_is_shared_by_all() {
    for count in [2, 3, 5, 10] {
        let mut scene = row(count, |body| Vector2::new(if body == 0 { 1.0 } else { 0.0 }, 0.0));
        scene.step = 0.1;
        let velocities = scene.solve().unwrap().velocities;
        for velocity in velocities {
            assert!((velocity - Vector2::new(1.0 / count as f64, 0.0)).norm() < EXACT, "{velocity}");
        }
    }
}

#[test]
fn the_momentum_of_a_pair_is_kept() {
    let mut scene = Scene::new(domain([20.0, 20.0], [true, true]), &[([5.0, 5.0], [3.0, 0.2]), ([7.5, 6.0], [-1.0, -0.7])]);
    scene.weights = vec![0.3, 7.0];
    let projection = scene.solve().unwrap();
    let momentum = |velocities: &[Vector2<f64>]| velocities[0] * 0.3 + velocities[1] * 7.0;
    assert!(projection.velocities != scene.velocities);
    assert!((momentum(&projection.velocities) - momentum(&scene.velocities)).norm() < EXACT);
    assert!(projection.kkt_report.smallest_gap > 0.0);
    assert_eq!(projection.kkt_report.iterations, 0);
}

#[test]
fn forces_say_how_much_each_body_is_turned_aside() {
    let scene = row(4, |body| Vector2::new(1.0 - body as f64, 0.3 * body as f64));
    let projection = scene.solve().unwrap();
    let mut pushes = [Vector2::zeros(); 4];
    for force in &projection.forces {
        assert!(force.force >= 0.0);
        pushes[force.contact.body] -= force.contact.normal * force.force;
        let Partner::Body(other) = force.contact.partner else { continue };
        pushes[other] += force.contact.normal * force.force;
    }
    for (body, push) in pushes.iter().enumerate() {
        assert!((scene.weights[body] * (projection.velocities[body] - scene.velocities[body]) - push).norm() < EXACT);
    }
}

#[test]
fn a_falling_ball_stops_on_the_plane() {
    let scene = Scene::new(domain([20.0, 20.0], [true, false]), &[([5.0, 1.3], [0.7, -2.0])]);
    let projection = scene.solve().unwrap();
    assert!((projection.velocities[0] - Vector2::new(0.7, -0.3)).norm() < EXACT);
    assert!(projection.kkt_report.smallest_gap.abs() < EXACT);
    assert!((projection.forces[0].force - 1.7).abs() < EXACT);
    assert_eq!(projection.kkt_report.islands, 1);
}

#[test]
fn a_column_carries_the_weight_above() {
    const COUNT: usize = 8;
    let bodies: Vec<_> = (0..COUNT).map(|body| ([5.0, 1.0 + 2.0 * body as f64], [0.0, -0.1])).collect();
    let projection = Scene::new(domain([20.0, 40.0], [true, false]), &bodies).solve().unwrap();
    assert!(projection.velocities.iter().all(|velocity| velocity.norm() < EXACT));
    for force in projection.forces {
        let carried = match force.contact.partner {
            Partner::Wall { .. } => COUNT,
            Partner::Body(other) => COUNT - other,
        };
        assert!((force.force - 0.1 * carried as f64).abs() < EXACT);
    }
}

#[test]
fn a_column_with_gaps_closes_them_all_in_a_long_step() {
    let bodies: Vec<_> = (0..20).map(|body| ([5.0, 1.2 + 2.2 * f64::from(body)], [0.0, -30.0])).collect();
    let scene = Scene::new(domain([20.0, 60.0], [true, false]), &bodies);
    let projection = scene.solve().unwrap();
    for (body, ball) in scene.moved(&projection).iter().enumerate() {
        assert!((ball.center[1] - 1.0 - 2.0 * body as f64).abs() < 10.0 * EXACT, "{}", ball.center);
    }
    assert!(projection.kkt_report.rounds < 10, "{}", projection.kkt_report.rounds);
}

#[test]
fn a_body_whose_motion_is_given_pushes_a_free_one() {
    let mut scene = row(2, |body| Vector2::new(if body == 0 { 1.0 } else { 0.0 }, 0.25));
    scene.weights[0] = f64::INFINITY;
    let projection = scene.solve().unwrap();
    assert_eq!(projection.velocities[0], scene.velocities[0]);
    assert!((projection.velocities[1] - Vector2::new(1.0, 0.25)).norm() < EXACT);
}

#[test]
fn a_heavy_body_is_turned_aside_less() {
    let mut scene = row(2, |body| Vector2::new(if body == 0 { 1.0 } else { 0.0 }, 0.0));
    scene.weights = vec![1e6, 1e-6];
    let velocities = scene.solve().unwrap().velocities;
    let common = 1e6 / (1e6 + 1e-6);
    assert!(velocities.iter().all(|velocity| (velocity - Vector2::new(common, 0.0)).norm() < EXACT));
}

#[test]
fn bodies_that_overlap_are_parted_within_the_step() {
    let mut scene = row(3, |_| Vector2::zeros());
    scene.balls[1].center[0] -= 0.3;
    scene.step = 0.01;
    let projection = scene.solve().unwrap();
    assert!(scene.overlap(&projection) < EXACT);
    assert!((projection.velocities[0][0] + 15.0).abs() < 1e-9 && (projection.velocities[1][0] - 15.0).abs() < 1e-9);
    assert_eq!(projection.velocities[2].norm(), 0.0);
}

#[test]
fn bodies_that_part_are_left_alone() {
    let scene = row(3, |body| Vector2::new(body as f64, 0.0));
    let projection = scene.solve().unwrap();
    assert_eq!((projection.velocities, projection.kkt_report.pairs), (scene.velocities, 0));
}
