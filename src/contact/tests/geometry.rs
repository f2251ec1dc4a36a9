//! Where contacts are: seams, images, groups, and bodies that fly through each other.

use nalgebra::{Vector2, Vector3};

use super::*;
use crate::contact::{Contact, Partner, candidates};

#[test]
fn a_scene_without_contact_has_no_problem() {
    let scene = Scene::new(domain([20.0, 20.0], [true, false]), &[([5.0, 5.0], [1.0, 0.0]), ([9.0, 5.0], [0.5, 0.0])]);
    let projection = scene.solve().unwrap();
    let kkt_report = projection.kkt_report;
    assert_eq!((kkt_report.pairs, kkt_report.rounds, kkt_report.iterations, kkt_report.islands), (0, 0, 0, 0));
    assert_eq!((projection.velocities, kkt_report.smallest_gap), (scene.velocities, f64::INFINITY));
}

#[test]
fn two_groups_are_two_islands() {
    let group = |x: f64| [([x, 1.0], [0.0, -0.1]), ([x, 3.0], [0.0, -0.1]), ([x, 5.0], [0.0, 0.0])];
    let bodies = [group(5.0), group(12.0)].concat();
    let kkt_report = Scene::new(domain([20.0, 20.0], [true, false]), &bodies).solve().unwrap().kkt_report;
    assert_eq!((kkt_report.islands, kkt_report.pairs, kkt_report.active), (2, 6, 4));
}

#[test]
fn a_body_that_does_not_give_way_connects_nothing() {
    let mut scene = row(5, |body| Vector2::new(2.0 - body as f64, 0.0));
    scene.weights[2] = f64::INFINITY;
    assert_eq!(scene.solve().unwrap().kkt_report.islands, 2);
}

#[test]
fn bodies_meet_across_the_seam() {
    let scene = Scene::new(domain([20.0, 20.0], [true, true]), &[([1.5, 0.2], [-1.0, 0.0]), ([19.0, 19.8], [1.0, 0.0])]);
    let projection = scene.solve().unwrap();
    assert_eq!(projection.forces[0].contact.image, [-1, -1]);
    assert!(scene.overlap(&projection) < EXACT);
    assert!((projection.velocities[0] + projection.velocities[1]).norm() < EXACT);
}

#[test]
fn two_images_of_one_pair_are_two_contacts() {
    let scene = Scene::new(domain([4.0, 20.0], [true, true]), &[([1.0, 5.0], [0.0, 0.0]), ([3.0, 5.0], [0.3, 0.0])]);
    let projection = scene.solve().unwrap();
    assert_eq!(projection.forces.iter().map(|force| force.contact.image).collect::<Vec<_>>(), [[-1, 0], [0, 0]]);
    assert!(projection.velocities.iter().all(|velocity| (velocity - Vector2::new(0.15, 0.0)).norm() < EXACT));
}

#[test]
fn an_image_stays_the_same_while_centers_are_followed() {
    let domain = domain([20.0, 20.0], [true, false]);
    let image = |shift: f64| {
        let ball = |x: f64| Ball { center: Vector2::new(x + shift, 5.0), radius: 1.0 };
        candidates(&domain, &[ball(19.5), ball(21.5)], &[1.0; 2], 0.1)[0].image
    };
    for shift in [-50.0, 0.0, 0.3, 19.0, 70.0] {
        assert_eq!(image(shift), [0, 0]);
    }
}

#[test]
fn bodies_that_would_fly_through_each_other_meet() {
    for speed in [5.0, 50.0] {
        let scene = Scene::new(domain([200.0, 20.0], [false, false]), &[([50.0, 5.0], [speed, 0.0]), ([60.0, 5.5], [-speed, 0.0])]);
        let projection = scene.solve().unwrap();
        let moved = scene.moved(&projection);
        assert!(moved[0].center[0] < moved[1].center[0], "{} {}", moved[0].center, moved[1].center);
        assert!(scene.overlap(&projection) < EXACT);
    }
}

#[test]
fn bodies_meet_images_many_boxes_away() {
    let scene = Scene::new(domain([10.0; 3], [true; 3]), &[([2.0, 5.0, 5.0], [0.0; 3]), ([5.0, 7.5, 5.0], [35.0, 0.0, -0.1])]);
    assert_eq!(scene.solve().unwrap().kkt_report.pairs, 0);
    let mut lower = scene.clone();
    lower.balls[1].center[1] = 6.5;
    let projection = lower.solve().unwrap();
    assert!(projection.kkt_report.active > 0 && lower.overlap(&projection) < EXACT);
    let common: Vector3<f64> = projection.velocities.iter().sum();
    assert!((common - Vector3::new(35.0, 0.0, -0.1)).norm() < 1e-11);
}

#[test]
fn bodies_that_move_alike_do_not_meet_however_fast() {
    let bodies: Vec<_> = (0..20).map(|body| ([2.5 * f64::from(body) + 1.5, 5.0], [1e4, 0.0])).collect();
    let kkt_report = Scene::new(domain([50.0, 10.0], [true, false]), &bodies).solve().unwrap().kkt_report;
    assert_eq!((kkt_report.pairs, kkt_report.rounds), (0, 0));
}

#[test]
fn candidates_are_pairs_then_walls_and_someone_gives_way() {
    let domain = domain([8.0, 20.0], [true, false]);
    let ball = |x| Ball { center: Vector2::new(x, 1.05), radius: 1.0 };
    let balls = [ball(1.0), ball(3.1), ball(5.2)];
    let found = |weights: [f64; 3]| candidates(&domain, &balls, &weights, 0.2).iter().map(Contact::identity).collect::<Vec<_>>();
    let pair = |body, other| (body, Partner::Body(other), [0, 0]);
    let floor = |body| (body, Partner::Wall { axis: 1, upper: false }, [0, 0]);
    assert_eq!(found([1.0; 3]), [pair(0, 1), pair(1, 2), floor(0), floor(1), floor(2)]);
    assert_eq!(found([f64::INFINITY, f64::INFINITY, 1.0]), [pair(1, 2), floor(2)]);
}

#[test]
fn normals_point_from_the_body_to_the_partner() {
    let domain = domain([20.0, 20.0], [true, false]);
    let ball = |x, y| Ball { center: Vector2::new(x, y), radius: 1.0 };
    for contact in candidates(&domain, &[ball(1.0, 1.1), ball(19.4, 18.9), ball(19.2, 1.1)], &[1.0; 3], 0.5) {
        let expected = match contact.partner {
            Partner::Body(_) => Vector2::new(-1.0, 0.0),
            Partner::Wall { upper, .. } => Vector2::new(0.0, if upper { 1.0 } else { -1.0 }),
        };
        assert!((contact.normal - expected).norm() < EXACT);
        assert!(contact.opening(&[Vector2::new(-2.0, 0.0), Vector2::zeros(), Vector2::zeros()]) <= 0.0);
    }
}
