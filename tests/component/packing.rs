//! Packings of many bodies, which ranks share: the same whatever their number.

use std::path::Path;

use nalgebra::SVector;
use turbid::{
    body::{pack, pack_on},
    geometry::{Axis, Ball, Domain, LeesEdwards, first_fault},
    petsc::Session,
    scene::Scene,
    setup::Setup,
};

use crate::Test;

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(ranks_pack_disks_of_two_sizes_between_walls_as_one_does_alone),
        Test::of(ranks_pack_disks_whose_images_slide_as_one_does_alone),
        Test::of(ranks_pack_spheres_around_an_obstacle_as_one_does_alone),
        Test::of(groups_of_several_sizes_fill_the_fraction_that_they_are_asked_for),
        Test::of(groups_lie_wholly_in_their_regions_and_clear_of_each_other),
        Test::of(random_bodies_keep_clear_of_inflow_and_outflow_in_the_same_places_on_every_grid),
    ]
}

/// The box of this shape that the radii fill to a fraction.
fn filled<const D: usize>(shape: [f64; D], axes: [Axis<D>; D], radii: &[f64], fraction: f64) -> Domain<D> {
    let volume: f64 = radii.iter().map(|&radius| Ball::<D> { center: SVector::zeros(), radius }.volume()).sum();
    let shape = SVector::from(shape);
    Domain { size: shape * (volume / fraction / shape.product()).powf(1.0 / D as f64), axes }
}

fn assert_alike<const D: usize>(session: &Session, domain: &Domain<D>, obstacles: &[Ball<D>], radii: &[f64]) {
    let together = pack_on(session.world().into(), domain, obstacles, radii, 0.02, 1).unwrap();
    assert_eq!(together, pack(domain, obstacles, radii, 0.02, 1).unwrap());
    let balls = together.iter().zip(radii).map(|(&center, &radius)| Ball { center, radius });
    assert_eq!(first_fault(domain, &balls.chain(obstacles.iter().copied()).collect::<Vec<_>>()), None);
}

fn ranks_pack_disks_of_two_sizes_between_walls_as_one_does_alone(session: &Session) {
    let radii: Vec<f64> = (0..36_000).map(|body| if body < 12_000 { 1.0 } else { 0.6 }).collect();
    let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
    let domain = filled([2.0, 1.0], [wall; 2], &radii, 0.45);
    assert_alike(session, &domain, &[], &radii);
}

fn ranks_pack_disks_whose_images_slide_as_one_does_alone(session: &Session) {
    let radii = vec![0.5; 36_000];
    let slide = |start| Axis::Sheared(LeesEdwards::steady(start, 0.0, 0.0));
    assert_alike(session, &filled([1.0, 1.0], [Axis::Periodic, slide(31.0)], &radii, 0.4), &[], &radii);
}

fn ranks_pack_spheres_around_an_obstacle_as_one_does_alone(session: &Session) {
    let radii = vec![0.5; 34_000];
    let domain = filled([1.0, 1.0, 1.0], [Axis::Periodic; 3], &radii, 0.2);
    // across the sides of the box, where the shares of the first and the last rank meet
    let obstacle = Ball { center: SVector::from([0.0, 5.0, 0.0]), radius: 3.0 };
    assert_alike(session, &domain, &[obstacle], &radii);
}

/// Five cells of the coarsest grid that bodies may have, three cells a radius: the same seed gives one bed to a study of grids.
fn random_bodies_keep_clear_of_inflow_and_outflow_in_the_same_places_on_every_grid(_: &Session) {
    let centers = |cells: f64, bodies: &str| {
        let text = format!(
            "domain = {{ size = [16.0, 8.0], x = {{ inflow = 1.0 }}, y = \"walls\" }}\nflow = {{ model = \"stokes\" }}\n\
             resolution = {{ cells_per_radius = {cells} }}\ntime = {{ end = 1.0 }}\n{bodies}"
        );
        let scene = Scene::parse("open", Path::new("."), &text, &[]).unwrap();
        Setup::<2>::of(&scene).unwrap().bodies.iter().map(|suspended| suspended.body.ball.center).collect::<Vec<_>>()
    };
    let disks = "bodies = [{ fraction = 0.35, radius = 0.5 }]\n";
    let coarse = centers(3.0, disks);
    assert_eq!(coarse, centers(6.0, disks));
    let chains = centers(3.0, "chains = [{ count = 5, radius = 0.5, beads = 4, stretch = \"rigid\" }]\n");
    let room = 0.5 + 5.0 * 0.5 / 3.0 - 1e-9;
    assert!(coarse.len() == 57 && coarse.iter().chain(&chains).all(|center| (room..=16.0 - room).contains(&center[0])), "{coarse:?}");
}

/// Half the volume in bodies that are 1.4 times as large; cells count across the smallest body, in any unit of length.
fn groups_of_several_sizes_fill_the_fraction_that_they_are_asked_for(_: &Session) {
    fn placed<const D: usize>(size: f64, unit: f64, sizes: &str) -> Setup<D> {
        let size = vec![(size * unit).to_string(); D].join(", ");
        let text = format!(
            "domain = {{ size = [{size}] }}\nresolution = {{ cells_per_radius = 4 }}\nflow = {{ drive = {{ shear_rate = 1.0 }} }}\n\
             bodies = [{{ radius = {unit}, fraction = 0.4, sizes = {sizes} }}]\n"
        );
        Setup::<D>::of(&Scene::parse("sizes", Path::new("."), &text, &[]).unwrap()).unwrap()
    }
    let radii = |setup: &Setup<2>| setup.bodies.iter().map(|suspended| suspended.body.ball.radius).collect::<Vec<f64>>();
    let disks = placed::<2>(40.0, 1.0, "{ ratio = 1.4, share = 0.5 }");
    let area = |large: bool| radii(&disks).iter().filter(|radius| (**radius > 1.2) == large).map(|radius| radius * radius).sum::<f64>();
    assert!((disks.fraction() - 0.4).abs() < 0.002 && (area(true) / area(false) - 1.0).abs() < 0.03, "{}", disks.fraction());
    let scaled = placed::<2>(40.0, 1e-6, "{ ratio = 1.4, share = 0.5 }");
    let alike = |(one, other): (&f64, f64)| (one - other * 1e6).abs() < 1e-12;
    assert!(radii(&disks).iter().zip(radii(&scaled)).all(alike) && disks.bodies.len() == scaled.bodies.len());
    let small = placed::<2>(40.0, 1.0, "[0.5, 1.0]");
    assert!((small.spacing / 0.125 - 1.0).abs() < 0.03, "{}", small.spacing);
    let spheres = placed::<3>(14.0, 1.0, "{ deviation = 0.2, smallest = 0.7, largest = 1.5 }");
    assert!((spheres.fraction() - 0.4).abs() < 0.003, "{}", spheres.fraction());
}

/// Two layers with a given disk between them across an end of the box, a chain in a third region and disks of no region around all of them.
fn groups_lie_wholly_in_their_regions_and_clear_of_each_other(session: &Session) {
    for axes in ["", "y = \"walls\"\n", "flow.drive = { shear_rate = 1.0, periodic = \"sheared\" }\n"] {
        let (domain, drive) = if axes.starts_with("flow") { ("", axes) } else { (axes, "") };
        let text = format!(
            "{drive}[domain]\nsize = [20.0, 16.0]\n{domain}[resolution]\nspacing = 0.06\n\
             [[bodies]]\nradius = 1.0\ncenters = [[7.0, {}], [0.2, 8.0]]\n\
             [[bodies]]\nradius = 0.5\nfraction = 0.5\nregion = [[0.0, 0.2], [20.0, 5.0]]\n\
             [[bodies]]\nradius = 0.4\ncount = 40\nregion = [[2.0, 9.0], [12.0, 15.9]]\n\
             [[bodies]]\nradius = 0.3\ncount = 60\n\
             [[bodies]]\nradius = 0.2\nfraction = 0.1\nregion = [[0.0, 0.2], [20.0, 5.0]]\n\
             [[chains]]\nradius = 0.25\nbeads = 4\ncount = 6\nstretch = \"rigid\"\nregion = [[14.0, 6.0], [19.0, 12.0]]\n\
             [time]\nend = 1.0\n",
            if domain.is_empty() { 15.7 } else { 14.8 }
        );
        let scene = Scene::parse("regions", Path::new("."), &text, &[]).unwrap();
        let setup = Setup::<2>::on(session.world().into(), &scene).unwrap();
        let group = |ball: &Ball<2>| scene.bodies.iter().position(|bodies| bodies.radius == ball.radius).unwrap();
        let balls: Vec<(usize, Ball<2>)> =
            setup.bodies.iter().map(|suspended| (group(&suspended.body.ball), suspended.body.ball)).collect();
        for &(group, Ball { center, radius }) in &balls {
            let Some(region) = &scene.bodies[group].region else { continue };
            let within =
                |axis: usize| region.lower[axis] + radius <= center[axis] + 1e-9 && center[axis] + radius <= region.upper[axis] + 1e-9;
            assert!((0..2).all(|axis| region.spans(axis, setup.domain.size[axis]) || within(axis)), "{group}: {center} of {region:?}");
        }
        let only: Vec<Ball<2>> = balls.iter().map(|&(_, ball)| ball).collect();
        assert_eq!(first_fault(&setup.domain, &only), None);
        let filled =
            |group: usize| balls.iter().filter(|(own, _)| *own == group).map(|(_, ball)| ball.volume()).sum::<f64>() / (20.0 * 4.8);
        assert!((filled(1) - 0.5).abs() < 0.005 && (filled(4) - 0.1).abs() < 0.001, "{} {}", filled(1), filled(4));
        let at_random: Vec<usize> = balls.iter().map(|(group, _)| *group).filter(|group| (1..5).contains(group)).collect();
        assert!(at_random.is_sorted() && balls.len() == at_random.len() + 2 + 24);
        assert_eq!(only, Setup::<2>::of(&scene).unwrap().bodies.iter().map(|suspended| suspended.body.ball).collect::<Vec<_>>());
    }
    let small = "domain = { size = [8.0, 8.0] }\nresolution = { spacing = 0.1 }\nbodies = [{ radius = 0.5, count = 1, region = [[0.0, 0.0], [0.9, 8.0]] }]\n";
    let refused = Setup::<2>::of(&Scene::parse("small", Path::new("."), small, &[]).unwrap()).unwrap_err().to_string();
    assert!(refused.contains("count = 1: in their region") && refused.contains("does not fit between the walls"), "{refused}");
}
