//! What cannot be solved, and what can, just.

use nalgebra::Vector2;
use serde_json::Value;

use super::*;
use crate::{contact::Island, error::Error};

fn refusal(scene: &Scene<2>) -> (String, Value) {
    let error = scene.solve().unwrap_err();
    assert_eq!(error.exit_code(), 1);
    let Error::Contact { text, island, .. } = error else { panic!("{error:?}") };
    (text, serde_json::from_str(&island).unwrap())
}

#[test]
fn a_body_squeezed_by_two_others_has_no_way_out() {
    let mut scene = row(3, |body| Vector2::new(1.0 - body as f64, 0.0));
    (scene.weights[0], scene.weights[2]) = (f64::INFINITY, f64::INFINITY);
    let (text, island) = refusal(&scene);
    assert_eq!(
        text,
        "contact of 3 bodies (0, 1, 2) at 2 places failed: bodies are squeezed with no way out by prescribed motions (0, 2); change the motions, or end before"
    );
    assert_eq!(island["bodies"][0]["wanted"][0], 1.0);
    assert_eq!((&island["bodies"][0]["weight"], &island["bodies"][1]["weight"]), (&Value::Null, &1.0.into()));
    assert_eq!(island["contacts"].as_array().unwrap().len(), 2);
    assert_eq!((&island["contacts"][0]["partner"]["body"], &island["step"]), (&1.into(), &1.0.into()));
}

/// A row with a bend of 1e-6, which linear constraints let out by moves of a million overlaps: the methods stop before they get there.
#[test]
fn a_row_pushed_against_a_wall_has_no_way_out() {
    let places = [[4.999999999999998, 2.0], [7.000000000152042, 2.000002627897152], [9.000000000135852, 2.0000135257028515]];
    let velocities =
        [[1.0, 0.0], [0.5000130462725249, 0.014108574997118251], [8.111748051042866e-7, 0.13149411546100417], [-0.1464, -0.0582]];
    let places = places.into_iter().chain([[11.0, 1.9999829385325056]]);
    let bodies: Vec<([f64; 2], [f64; 2])> = places.zip(velocities).collect();
    let mut scene = Scene::new(domain([12.0, 4.0], [false, false]), &bodies);
    (scene.weights, scene.step) = (vec![f64::INFINITY, 22.9, 22.9, 22.9], 0.00078125);
    let text = refusal(&scene).0;
    assert!(text.contains("squeezed with no way out by prescribed motion (0)"), "{text}");
}

/// Rows of disks sheared by images that slide climb over each other, for which there is no room: none at all, or none in so long a step.
#[test]
fn jammed_bodies_are_told_from_those_that_want_a_shorter_step() {
    for (room, remedy) in [(0.0, "however short the step: they are jammed"), (1e-2, "try a smaller time.step")] {
        let (width, height) = (2.0 + room, 3f64.sqrt() * (1.0 + room / 2.0));
        let bodies: Vec<([f64; 2], [f64; 2])> = (0..16)
            .map(|body| {
                let (along, row) = ((body % 4) as f64, body / 4);
                ([(along + 0.25 + 0.5 * f64::from(row % 2)) * width, (f64::from(row) + 0.5) * height], [0.0, 0.0])
            })
            .collect();
        let mut scene = Scene::new(domain([4.0 * width, 4.0 * height], [true, true]), &bodies);
        scene.step = 0.2;
        scene.domain.axes[1] = Axis::Sheared(LeesEdwards::steady(0.0, 4.0 * height, 0.0).over(scene.step));
        let text = refusal(&scene).0;
        assert!(text.contains("squeezed with no way out") && text.contains(remedy), "{text}");
    }
}

#[test]
fn a_body_pressed_against_a_wall_has_no_way_out() {
    let mut scene = Scene::new(domain([20.0, 4.0], [true, false]), &[([5.0, 3.0], [0.0, -0.1]), ([5.0, 1.0], [0.0, 0.0])]);
    scene.weights[0] = f64::INFINITY;
    assert!(refusal(&scene).0.contains("squeezed"));
}

#[test]
fn a_body_that_just_fits_between_walls_is_not_squeezed() {
    for height in [2.0, 2.0 - 1e-15, 2.0 + 1e-15] {
        let mut scene = Scene::new(domain([20.0, height], [true, false]), &[([5.0, 1.0], [0.3, -0.1])]);
        let projection = scene.solve().unwrap();
        assert!((projection.velocities[0] - Vector2::new(0.3, 0.0)).norm() < 1e-9);
        scene.velocities[0][1] = 1e3;
        assert!((scene.solve().unwrap().velocities[0] - Vector2::new(0.3, 0.0)).norm() < 1e-9);
    }
}

#[test]
fn velocities_that_are_not_finite_are_refused() {
    let (text, island) = refusal(&row(2, |body| Vector2::new(if body == 1 { f64::NAN } else { 0.0 }, 0.0)));
    assert_eq!(text, "body 1 has a velocity that is not finite; try a smaller time.step");
    assert_eq!(island["bodies"][0]["index"], 1);
}

#[test]
fn steps_and_weights_that_are_none_are_refused() {
    for step in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let scene = Scene { step, ..row(2, |_| Vector2::zeros()) };
        assert!(refusal(&scene).0.starts_with(&format!("a step of {step} is none")));
    }
    for weight in [0.0, f64::NAN] {
        let scene = Scene { weights: vec![1.0, weight], ..row(2, |_| Vector2::zeros()) };
        assert!(refusal(&scene).0.starts_with(&format!("body 1 weighs {weight}")));
    }
}

#[test]
fn weights_however_different_give_an_answer_or_an_error() {
    let mut refused = 0;
    for ratio in [1.0_f64, 1e6, 1e13, 1e60, 1e120] {
        let mut scene = Scene::new(domain([20.0, 20.0], [true, false]), &[([5.0, 1.2], [0.0, -1.0]), ([5.5, 3.4], [0.0, -3.0])]);
        scene.weights = vec![ratio.sqrt().recip(), ratio.sqrt()];
        match scene.solve() {
            Ok(projection) => assert!(projection.kkt_report.smallest_gap > -1e-4, "{ratio:e}: {:?}", projection.kkt_report),
            Err(error) => {
                assert!(matches!(error, Error::Contact { .. }), "{ratio:e}: {error}");
                refused += 1;
            }
        }
    }
    assert_eq!(refused, 3);
}

#[test]
fn an_absurd_step_is_refused() {
    let mut scene = row(2, |body| Vector2::new(0.0, body as f64));
    scene.domain = domain([200.0, 100.0], [true, true]);
    scene.step = 1e9;
    assert!(refusal(&scene).0.starts_with("body 1 moves by 1.000e9 of its radius in one step"), "{}", refusal(&scene).0);
}

/// A hundred million pairs, of 200 bytes each.
#[test]
fn a_step_whose_pairs_no_memory_holds_is_refused() {
    let mut scene = row(2, |body| Vector2::new(0.0, body as f64));
    scene.domain = domain([200.0, 100.0], [true, true]);
    scene.step = 1e6;
    assert!(refusal(&scene).0.starts_with("body 1 moves by 1.000e6 of its radius in one step"), "{}", refusal(&scene).0);
}

#[test]
fn an_island_read_back_fails_again_in_the_same_way() {
    let mut scene = row(3, |body| Vector2::new(1.0 - body as f64, 0.0));
    (scene.weights[0], scene.weights[2]) = (f64::INFINITY, f64::INFINITY);
    let Error::Contact { text, island, .. } = scene.solve().unwrap_err() else { panic!("no contact error") };
    let Island { domain, balls, weights, velocities, step } = Island::<2>::read(&island).unwrap();
    let again = Scene { domain, balls, weights, velocities, step };
    let Error::Contact { text: found, island: written, .. } = again.solve().unwrap_err() else { panic!("no contact error") };
    assert_eq!((found, written), (text, island.clone()));
    assert!(matches!(Island::<3>::read(&island), Err(Error::Refused(_))));
    assert!(matches!(Island::<2>::read("{}"), Err(Error::Refused(_))));
}
