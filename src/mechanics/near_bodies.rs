//! What near bodies have to do with a solve that does not end.

use crate::{
    error::Error,
    geometry::{Ball, near_pairs, near_walls},
    setup::{Configuration, Setup},
};

/// Gaps in radii below which bodies count as ones that touch.
const TOUCHING: f64 = 1e-6;

/// The error of a solve that diverged with the bodies of a setup in a configuration, with their smallest gap if some touch; other errors stay.
pub fn with_smallest_gap<const D: usize>(error: Error, setup: &Setup<D>, configuration: &Configuration<D>) -> Error {
    let Error::Diverged(text) = error else { return error };
    let gap = smallest_gap(setup, configuration);
    let touching = format!(
        "; the smallest gap of bodies, to others or to walls, is {gap:.1e} radii: room between them (bodies.gap, bodies.centers) or a larger \
         lubrication.roughness may help"
    );
    Error::Diverged(if gap < TOUCHING { text + &touching } else { text })
}

/// The smallest gap between two bodies, or a body and a wall, over the smaller radius, of those that nearly touch; infinite without any.
fn smallest_gap<const D: usize>(setup: &Setup<D>, configuration: &Configuration<D>) -> f64 {
    let domain = setup.domain.clone().at(configuration.time);
    let radii = setup.bodies.iter().map(|suspended| suspended.body.ball.radius);
    let ball = |(&center, radius)| Ball { center: domain.wrap(center), radius };
    let balls: Vec<Ball<D>> = configuration.centers.iter().zip(radii).map(ball).collect();
    let reach = TOUCHING * balls.iter().map(|ball| ball.radius).fold(0.0, f64::max);
    let pairs = near_pairs(&domain, &balls, reach).into_iter();
    let of_pairs = pairs.map(|pair| pair.gap / balls[pair.first].radius.min(balls[pair.second].radius));
    let of_walls = near_walls(&domain, &balls, reach).into_iter().map(|near| near.gap / balls[near.body].radius);
    of_pairs.chain(of_walls).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::scene::Scene;

    fn text(second: f64, wall: &str, error: Error) -> String {
        let scene = format!(
            "domain.size = [8.0, 8.0]\n{wall}resolution.spacing = 0.125\n[[bodies]]\nradius = 0.5\ncenters = [[2.0, 2.0], [{second}, 2.0]]\n"
        );
        let setup = Setup::<2>::of(&Scene::parse("scene", Path::new("."), &scene, &[]).unwrap()).unwrap();
        with_smallest_gap(error, &setup, &Configuration::at_rest(&setup, &setup.centers(), &[])).to_string()
    }

    #[test]
    fn a_solve_of_bodies_that_touch_says_so() {
        let stopped = |second: f64, wall: &str| text(second, wall, Error::Diverged("stopped".into()));
        assert_eq!(stopped(3.5, ""), "stopped");
        assert_eq!(stopped(3.00001, ""), "stopped");
        let touching = stopped(3.0000001, "");
        assert!(touching.starts_with("stopped; the smallest gap of bodies, to others or to walls, is 2.0e-7 radii: "), "{touching}");
        let at_wall = stopped(7.4999999, "domain.x = \"walls\"\n");
        assert!(at_wall.contains(" is 2.0e-7 radii: "), "{at_wall}");
        assert_eq!(text(3.0000001, "", Error::refused("no")), "no");
    }
}
