//! Where a law with rebound has two answers, and this one has one (Bressan 1960, Schatzman 1978).

use nalgebra::Vector2;

use super::*;

/// The force on a ball on the floor, by pieces that shrink towards time 0: on `(t_(n+1), t_n)`, `t_n = 1/(n+1)`, nothing during the
/// first half, `-8 v_(n+1) / (t_n - t_(n+1))` during the second, `v_n = 3^-n`.
fn force(time: f64) -> f64 {
    let number = (1.0 / time - 1.0).floor();
    let (late, early) = (1.0 / (number + 1.0), 1.0 / (number + 2.0));
    if time < 0.5 * (late + early) { 0.0 } else { -8.0 * 3f64.powf(-number - 1.0) / (late - early) }
}

/// A ball that keeps its speed when it lands may lie still or bounce higher and higher under this force; without rebound it lies still.
#[test]
fn without_rebound_the_ball_that_could_bounce_for_ever_lies_still() {
    let steps = 1000;
    let mut scene = Scene::new(domain([20.0, 20.0], [true, false]), &[([5.0, 1.0], [0.0, 0.0])]);
    scene.step = 1.0 / f64::from(steps);
    let mut pressed = 0;
    for step in 0..steps {
        let push = force((f64::from(step) + 0.5) * scene.step);
        assert!(push <= 0.0);
        scene.velocities[0] += Vector2::new(0.0, push * scene.step);
        let projection = scene.solve().unwrap();
        pressed += usize::from(projection.kkt_report.active > 0);
        scene.balls = scene.moved(&projection);
        scene.velocities = projection.velocities;
        // overlaps of 1e-11 radii are let grow and parted again; the bouncing ball rises to 0.08
        let (depth, speed) = (1.0 - scene.balls[0].center[1], scene.velocities[0].norm());
        assert!(depth.abs() < 1e-9 && speed < 1e-7, "step {step}: {depth:e} {speed:e}");
    }
    assert!(pressed > 330, "{pressed}");
}
