//! Normal stresses of sheared suspensions, against exact values and by two roads.

use std::path::Path;

use nalgebra::{Matrix3, Vector2, Vector3};

use crate::Test;
use crate::suspension::{assert_near, couette, free, periodic_cube, solve, suspended};
use turbid::{
    body::{Motion, skew},
    contact::{Contact, ContactForce, Partner},
    flow::Drive,
    geometry::{Axis, Ball, Domain},
    mechanics::FlowSolver,
    motion::Simulation,
    observe::{self, Part, Viscosity},
    petsc::Session,
    scene::{ConstraintMethod, Scene},
    setup::Setup,
    system::Solution,
};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(two_disks_in_a_periodic_box_have_the_known_normal_stress_difference),
        Test::of(one_body_in_a_box_has_no_normal_stress),
        Test::of(normal_stresses_of_parts_are_those_of_the_tensor_in_any_units),
        Test::of(pressure_on_bodies_is_what_walls_bear),
        Test::of(films_bear_pressure_as_a_resolved_flow_does),
        Test::of(torques_and_forces_that_cancel_reach_the_walls),
        Test::of(torques_on_clusters_and_chains_reach_the_walls),
        Test::of(a_net_force_along_the_walls_leaves_no_viscosity),
    ]
}

const PAIR: [[f64; 2]; 2] = [[0.3, 0.4], [0.65, 0.62]];

fn viscosity(suspension: &dyn FlowSolver<2>, solution: &Solution<2>) -> Viscosity {
    observe::viscosity(suspension.setup(), suspension.grid(), solution, &[]).unwrap().unwrap()
}

/// Reference, section 2.4, P2.
fn two_disks_in_a_periodic_box_have_the_known_normal_stress_difference(session: &Session) {
    let disks = PAIR.map(|center| suspended(Vector2::from(center), 0.15, free(), 10));
    let (suspension, solution) = solve(session, periodic_cube(1.0 / 64.0, Drive::Shear(1.0), disks.to_vec()));
    let viscosity = viscosity(suspension.as_ref(), &solution);
    assert_near("viscosity", viscosity.relative(), 1.3457188363, 1e-3);
    assert!((viscosity.normal.first - 0.074669119).abs() < 1e-3, "{viscosity:?}");
    assert_eq!((viscosity.normal.second, viscosity.normal_parts.get(Part::Contact)), (None, None));
}

/// By symmetry, which holds on a grid as well if the body lies in one of its centres of symmetry.
fn one_body_in_a_box_has_no_normal_stress(session: &Session) {
    let disk = suspended(Vector2::repeat(0.5), 0.2, free(), 6);
    let (suspension, solution) = solve(session, periodic_cube(1.0 / 32.0, Drive::Shear(2.0), vec![disk]));
    let plane = viscosity(suspension.as_ref(), &solution).normal;
    assert!(plane.first.abs() < 1e-7 && plane.pressure.unwrap().abs() < 1e-7, "{plane:?}");
    let sphere = suspended(Vector3::repeat(0.5), 0.25, free(), 3);
    let (suspension, solution) = solve(session, periodic_cube(1.0 / 16.0, Drive::Shear(2.0), vec![sphere]));
    let space = observe::viscosity(suspension.setup(), suspension.grid(), &solution, &[]).unwrap().unwrap().normal;
    let all = [space.first, space.second.unwrap(), space.pressure.unwrap()];
    assert!(all.iter().all(|stress| stress.abs() < 1e-7), "{space:?}");
}

/// `N1 = Sigma_xx - Sigma_yy`, `N2 = Sigma_yy - Sigma_zz` and `-tr Sigma / 3`, of stresslets and of a contact, over viscosity, rate and volume.
fn normal_stresses_of_parts_are_those_of_the_tensor_in_any_units(session: &Session) {
    let found = [[1.0; 3], [2.5, 0.3, 40.0]].map(|[length, viscosity, rate]| {
        let centers = [Vector3::new(0.3, 0.4, 0.5), Vector3::new(0.62, 0.66, 0.58)].map(|center| center * length);
        let spheres = centers.map(|center| suspended(center, 0.2 * length, free(), 3));
        let cube = periodic_cube(length / 16.0, Drive::Shear(rate), spheres.to_vec());
        let domain = Domain { size: cube.domain.size * length, ..cube.domain };
        let (suspension, solution) = solve(session, Setup { domain, viscosity, ..cube });
        let (apart, force) = (centers[1] - centers[0], 0.7 * viscosity * rate * length * length);
        let (normal, separation) = (apart.normalize(), apart.norm());
        let (partner, gap) = (Partner::Body(1), separation - 0.4 * length);
        let contact = Contact { body: 0, partner, image: [0; 3], sliding: Vector3::zeros(), normal, separation, gap };
        let stress = observe::viscosity(suspension.setup(), suspension.grid(), &solution, &[ContactForce::normal(contact, force)]);
        let unit = viscosity * rate * length.powi(3);
        let pushed = normal * normal.transpose() * (-force * separation / unit);
        let flow: Matrix3<f64> = solution.bodies.iter().map(|body| body.stresslet / unit).sum();
        (stress.unwrap().unwrap(), pushed, flow)
    });
    let first = |stress: &Matrix3<f64>| stress[(0, 0)] - stress[(1, 1)];
    let second = |stress: &Matrix3<f64>| stress[(1, 1)] - stress[(2, 2)];
    for (viscosity, pushed, flow) in &found {
        let [of_contact, of_flow] = [Part::Contact, Part::Hydrodynamic].map(|part| viscosity.normal_parts.get(part).unwrap());
        for (normal, stress) in [(of_contact, pushed), (of_flow, flow), (viscosity.normal, &viscosity.stress.total())] {
            assert!((normal.first - first(stress)).abs() < 1e-12, "{normal:?} of {stress}");
            assert!((normal.second.unwrap() - second(stress)).abs() < 1e-12, "{normal:?} of {stress}");
        }
        assert!((of_contact.pressure.unwrap() + pushed.trace() / 3.0).abs() < 1e-12, "{of_contact:?}");
        let sum = of_contact.pressure.unwrap() + of_flow.pressure.unwrap();
        assert!((viscosity.normal.pressure.unwrap() - sum).abs() < 1e-12 && sum > 0.01, "{viscosity:?}");
    }
    let numbers =
        found.map(|(viscosity, ..)| [viscosity.normal.first, viscosity.normal.second.unwrap(), viscosity.normal.pressure.unwrap()]);
    let off = numbers[0].iter().zip(&numbers[1]).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max);
    assert!(off < 1e-7 && numbers[0][0].abs() > 1e-2 && numbers[0][1].abs() > 1e-2, "{numbers:?}");
}

/// The mean normal stress, here 0.024, is the same on every plane between the walls: on a wall it is the pressure there.
fn pressure_on_bodies_is_what_walls_bear(session: &Session) {
    let methods = [(ConstraintMethod::Sharp, 1e-3), (ConstraintMethod::Penalty(None), 5e-3)];
    for (constraint, error) in methods {
        let disks = PAIR.map(|center| suspended(Vector2::from(center), 0.15, free(), 9));
        let setup = Setup { constraint, ..couette(1.0, 1.0 / 80.0, 2.0, disks.to_vec()) };
        let (suspension, solution) = solve(session, setup);
        let normal = viscosity(suspension.as_ref(), &solution).normal;
        let across = -normal.pressure.unwrap() - 0.5 * normal.first;
        let borne = wall_stress(session, suspension.as_ref(), &solution, 2.0);
        assert!((across - borne).abs() < error, "{}: {across} instead of {borne}", constraint.word());
    }
    // multipliers at points inside leave the pressure there open
    let disks = PAIR.map(|center| suspended(Vector2::from(center), 0.15, free(), 9));
    let setup = Setup { constraint: ConstraintMethod::Distributed, ..couette(1.0, 1.0 / 40.0, 2.0, disks.to_vec()) };
    let (suspension, solution) = solve(session, setup);
    assert_eq!(viscosity(suspension.as_ref(), &solution).normal.pressure, None);
}

/// Half the couple per volume, and less the first moment of forces: walls and stresslets agree as they do without.
fn torques_and_forces_that_cancel_reach_the_walls(session: &Session) {
    let loaded = |force: f64, torque: f64| Motion::Free { force: Vector2::new(force, 0.3), torque: skew(&[torque]) };
    let unloaded =
        viscosity_of(session, couette(1.0, 1.0 / 40.0, 2.0, PAIR.map(|center| suspended(center.into(), 0.15, free(), 7)).to_vec()));
    for (loads, change) in [([[0.0, 0.7], [0.0, -0.2]], 0.125), ([[1.5, 0.0], [-1.5, 0.4]], 0.265)] {
        let body = |(center, [force, torque]): (&[f64; 2], [f64; 2])| suspended(Vector2::from(*center), 0.15, loaded(force, torque), 7);
        let bodies = PAIR.iter().zip(loads).map(body).collect();
        let found = viscosity_of(session, couette(1.0, 1.0 / 40.0, 2.0, bodies));
        assert_near("walls", found.from_walls.unwrap(), found.relative(), 1e-6);
        // torque / 2 and force times height, over viscosity, rate and volume; what the flow makes of them comes besides
        assert!(
            (found.parts.get(Part::Interaction).unwrap() - change).abs() < 1e-12 && unloaded.parts.get(Part::Interaction).is_none(),
            "{found:?}"
        );
        assert!((found.stress.total()[(0, 1)] - found.relative()).abs() < 1e-12);
    }
    let sphere = |center: [f64; 3], torque: f64| {
        let motion = Motion::Free { force: Vector3::zeros(), torque: skew(&[0.2, -0.1, torque]) };
        suspended(Vector3::from(center), 0.2, motion, 3)
    };
    let walls = Axis::Walls { lower: Vector3::x() * -0.5, upper: Vector3::x() * 0.5 };
    let cube = periodic_cube(1.0 / 16.0, Drive::Rest, vec![sphere([0.3, 0.4, 0.5], 0.3), sphere([0.75, 0.6, 0.4], 0.1)]);
    let domain = Domain { axes: [Axis::Periodic, walls, Axis::Periodic], ..cube.domain };
    let (suspension, solution) = solve(session, Setup { domain, ..cube });
    let found = observe::viscosity(suspension.setup(), suspension.grid(), &solution, &[]).unwrap().unwrap();
    assert_near("walls in space", found.from_walls.unwrap(), found.relative(), 1e-6);
    assert!((found.parts.get(Part::Interaction).unwrap() - 0.2).abs() < 1e-12);
}

fn viscosity_of<const D: usize>(session: &Session, setup: Setup<D>) -> Viscosity {
    let (suspension, solution) = solve(session, setup);
    observe::viscosity(suspension.setup(), suspension.grid(), &solution, &[]).unwrap().unwrap()
}

/// What ties balls carries torques on, and adds a stress of its own.
fn torques_on_clusters_and_chains_reach_the_walls(session: &Session) {
    let tied = |bodies: &str| {
        Scene::parse(
            "stress",
            Path::new("."),
            &format!(
                "domain = {{ size = [8.0, 8.0], y = {{ lower = [-4.0, 0.0], upper = [4.0, 0.0] }} }}\nflow = {{ model = \"stokes\" }}\n\
                 resolution = {{ cells_per_radius = 4 }}\nmethod = {{ inverse = \"transform\", tolerance = 1e-9 }}\n\
                 time = {{ end = 0.1, step = 0.05 }}\n{bodies}"
            ),
            &[],
        )
        .unwrap()
    };
    let load = "torque = 2.0, force = [0.0, 0.5]";
    for bodies in [
        format!("clusters = [{{ shape = \"rod\", beads = 3, radius = 0.5, centers = [[3.0, 3.0]], rotation = 0.7, {load} }}]\n"),
        format!(
            "chains = [{{ beads = 4, radius = 0.4, centers = [[2.0, 5.0], [2.9, 5.1], [3.8, 5.0], [4.7, 5.2]], stretch = \"rigid\", {load} }}]\n"
        ),
    ] {
        let mut simulation = Simulation::<2>::new(session, &tied(&bodies)).unwrap();
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        let (flow, solution) = (simulation.suspension().unwrap(), observation.solution.unwrap());
        let found = observe::viscosity(flow.setup(), flow.grid(), &solution, &observation.contacts).unwrap().unwrap();
        assert!(found.parts.get(Part::Interaction).unwrap() > 0.01 && found.parts.get(Part::Bonds).is_some(), "{found:?}");
        assert_near(&bodies, found.from_walls.unwrap(), found.relative(), 1e-5);
    }
}

fn a_net_force_along_the_walls_leaves_no_viscosity(session: &Session) {
    let pushed = Motion::Free { force: Vector2::new(1.0, 0.0), torque: skew(&[0.0]) };
    let disks = vec![suspended(Vector2::new(0.3, 0.4), 0.15, pushed, 5), suspended(Vector2::new(0.7, 0.6), 0.15, free(), 5)];
    let (suspension, solution) = solve(session, couette(1.0, 1.0 / 24.0, 2.0, disks));
    assert!(observe::viscosity(suspension.setup(), suspension.grid(), &solution, &[]).unwrap().is_none());
    let why = observe::why_no_viscosity(suspension.setup()).unwrap();
    assert!(why.contains("differ by 5.000e-1"), "{why}");
    let driven = Setup { drive: Drive::PressureGradient(Vector2::new(-1.0, 0.0)), ..couette(1.0, 1.0 / 24.0, 2.0, Vec::new()) };
    assert!(observe::why_no_viscosity(&driven).unwrap().contains("differ by 5.000e-1"));
    assert_eq!(observe::why_no_viscosity(&couette(1.0, 1.0 / 24.0, 2.0, Vec::new())), None);
}

/// Near bodies, and bodies near a wall, on grids and with modes that leave most of it to films, and with nearly all modes.
/// Measured: 0.250 for 0.259, by the wall 1.69 for 1.73 (1.64 to 1.71 with five to eight cells and three to five modes), spheres 0.180 for 0.178.
fn films_bear_pressure_as_a_resolved_flow_does(session: &Session) {
    let pressures = |text: &str, films: &str| {
        let scene = Scene::parse("films", Path::new("."), &format!("lubrication.model = \"{films}\"\n{text}"), &[]).unwrap();
        let of = |viscosity: Viscosity| (viscosity.normal.pressure.unwrap(), viscosity.normal_parts.get(Part::Lubrication));
        match scene.domain.size.len() {
            2 => of(viscosity_of(session, Setup::<2>::of(&scene).unwrap())),
            _ => of(viscosity_of(session, Setup::<3>::of(&scene).unwrap())),
        }
    };
    let pair = "[domain]\nsize = [5.0, 5.0]\n[flow]\ndrive = { shear_rate = 1.0 }\n[[bodies]]\nradius = 1.0\ncenters = [[1.7, 3.19], [3.15, 1.74]]\n";
    let by_wall = "[domain]\nsize = [6.0, 4.0]\ny = { lower = [-2.0, 0.0], upper = [2.0, 0.0] }\n[[bodies]]\nradius = 1.0\n\
                   centers = [[2.0, 2.65], [3.4, 1.1]]\n";
    let spheres = "[domain]\nsize = [5.0, 4.0, 5.0]\ny = { lower = [-2.0, 0.0, 0.0], upper = [2.0, 0.0, 0.0] }\n[[bodies]]\nradius = 1.0\n\
                   centers = [[2.0, 2.65, 2.5], [3.4, 1.1, 2.5]]\n";
    for (text, cells, modes, resolved, tolerance) in
        [(pair, 6, 3, (24, 24), 0.05), (by_wall, 6, 3, (24, 24), 0.05), (spheres, 6, 3, (12, 12), 0.06)]
    {
        let resolution = |cells: usize, modes: usize| format!("resolution = {{ cells_per_radius = {cells}, modes = {modes} }}\n{text}");
        let ((with, of_films), (all, none)) =
            (pressures(&resolution(cells, modes), "pairwise"), pressures(&resolution(resolved.0, resolved.1), "none"));
        let part = of_films.unwrap().pressure.unwrap();
        assert!((with / all - 1.0).abs() < tolerance && none.is_none(), "{with} of which films {part}, resolved {all}");
        assert!(part > 0.2 * all, "{with} of which films {part}, resolved {all}");
    }
}

/// Mean normal stress on both walls over the rate, less that of the mean pressure of the fluid.
fn wall_stress(session: &Session, suspension: &dyn FlowSolver<2>, solution: &Solution<2>, rate: f64) -> f64 {
    let grid = suspension.grid();
    let balls: Vec<Ball<2>> = suspension.setup().bodies.iter().map(|suspended| suspended.body.ball).collect();
    assert!(matches!(grid.domain().axes[1], Axis::Walls { .. }));
    let (inside, rows) = (observe::inside(grid, &balls), grid.cells()[1]);
    let values = solution.fluid.local().unwrap();
    let mut sums = [0.0; 3];
    for ((index, pressure), inside) in grid.block(2).indices().zip(&values[grid.local_range(2)]).zip(inside) {
        let from_wall = index[1].min(rows - 1 - index[1]);
        // linear from the two rows next to each wall
        sums[0] += [1.5, -0.5].get(from_wall).unwrap_or(&0.0) * pressure / (2 * grid.cells()[0]) as f64;
        sums[1] += (1.0 - inside) * pressure;
        sums[2] += 1.0 - inside;
    }
    session.world().sum(&mut sums);
    -(sums[0] - sums[1] / sums[2]) / rate
}
