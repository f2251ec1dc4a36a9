//! One answer by either inverse of the fluid: the coupled system with multigrid, and the condensed one with transforms.

use std::path::{Path, PathBuf};

use nalgebra::{SVector, Vector2};
use turbid::{
    flow::{Drive, InverseMethod},
    geometry::{Axis, Domain},
    petsc::Session,
    scene::{Scene, Tolerance},
    setup::{Setup, SuspendedBody},
    system::Solution,
};

use super::{
    Test,
    suspension::{fixed, free, periodic_cube, solve, suspended},
};

/// Residual of the solves, and what it may leave in velocities and forces of crowds.
const TOLERANCE: f64 = 1e-8;
const LEFT: f64 = 100.0 * TOLERANCE;

/// Unknowns of the largest examples that are solved.
const MOST_UNKNOWNS: f64 = 3e5;

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::only_on(2, every_example_has_one_answer),
        Test::of(every_drive_has_one_answer_in_a_channel),
        Test::of(a_porous_crystal_has_one_answer),
        Test::of(transforms_take_no_more_iterations_than_multigrid),
    ]
}

/// Solves with both inverses; all that comes out must agree.
fn agree<const D: usize>(session: &Session, name: &str, mut setup: Setup<D>) {
    setup.tolerance = Tolerance::Fixed(TOLERANCE);
    setup.inverse = InverseMethod::Hypre;
    let (_, hypre) = solve(session, setup.clone());
    setup.inverse = InverseMethod::Transform;
    let (_, transform) = solve(session, setup);
    for (one, two) in numbers(&hypre).iter().zip(numbers(&transform)) {
        let scale = one.iter().chain(&two).fold(f64::MIN_POSITIVE, |scale, value| scale.max(value.abs()));
        let distance = one.iter().zip(&two).map(|(one, two)| (one - two).abs()).fold(0.0, f64::max);
        assert!(distance <= LEFT * scale, "{name}: {distance:.1e} apart, of {scale:.1e}");
    }
    let (mut difference, scale) = (hypre.fluid, transform.fluid.norm().unwrap());
    difference.add(-1.0, &transform.fluid).unwrap();
    assert!(difference.norm().unwrap() <= LEFT * scale, "{name}: flows differ");
}

/// What moves, and what pulls: two scales.
fn numbers<const D: usize>(solution: &Solution<D>) -> [Vec<f64>; 2] {
    let motions = solution.bodies.iter().flat_map(|state| [state.twist.velocity.as_slice(), state.twist.spin.as_slice()].concat());
    let loads =
        solution.bodies.iter().flat_map(|state| [state.force.as_slice(), state.torque.as_slice(), state.stresslet.as_slice()].concat());
    [motions.chain(solution.mean_velocity.iter().copied()).collect(), loads.chain(solution.pressure_gradient.iter().copied()).collect()]
}

fn examples() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut scenes: Vec<PathBuf> = files.filter(|path| path.extension().is_some_and(|extension| extension == "toml")).collect();
    scenes.sort();
    scenes
}

fn every_example_has_one_answer(session: &Session) {
    let mut compared = 0;
    for path in examples() {
        let scene = Scene::read(&path, &[]).unwrap();
        let name = path.display().to_string();
        if !scene.dry() && !scene.scalar() {
            compared +=
                if scene.domain.size.len() == 2 { compare::<2>(session, &name, &scene) } else { compare::<3>(session, &name, &scene) };
        }
    }
    assert!(compared >= 5, "only {compared} examples suit transforms");
}

fn compare<const D: usize>(session: &Session, name: &str, scene: &Scene) -> usize {
    let setup = Setup::<D>::of(scene).unwrap();
    // a large box asks nothing else and takes a minute by multigrid; flows with inertia have no answer at an instant
    let unknowns = (D + 1) as f64 * setup.domain.volume() / setup.spacing.powi(D as i32);
    if unknowns > MOST_UNKNOWNS || setup.inertia.is_some() || InverseMethod::fastest(&setup.domain) == InverseMethod::Hypre {
        return 0;
    }
    agree(session, name, setup);
    1
}

/// A few disks that do not touch, one of them a little larger.
fn disks(motion: impl Fn(usize) -> turbid::body::Motion<2>) -> Vec<SuspendedBody<2>> {
    let centers = [[0.21, 0.23], [0.68, 0.31], [0.37, 0.74], [0.99, 0.71]];
    let disk =
        |(place, center): (usize, &[f64; 2])| suspended(Vector2::from(*center), if place == 0 { 0.15 } else { 0.12 }, motion(place), 4);
    centers.iter().enumerate().map(disk).collect()
}

fn every_drive_has_one_answer_in_a_channel(session: &Session) {
    let still = Axis::Walls { lower: Vector2::zeros(), upper: Vector2::zeros() };
    let sliding = Axis::Walls { lower: Vector2::y() * -0.5, upper: Vector2::y() * 0.5 };
    let wind = SVector::from([0.3, 0.0]);
    for (name, axes, drive) in [
        ("mean velocity", [Axis::Periodic, still], Drive::MeanVelocity(wind)),
        ("pressure gradient", [Axis::Periodic, still], Drive::PressureGradient(wind)),
        ("body force", [Axis::Periodic, still], Drive::BodyForce(wind)),
        ("walls across the first axis", [sliding, Axis::Periodic], Drive::Rest),
    ] {
        let domain = Domain { size: Vector2::repeat(1.0), axes };
        let bodies = disks(|place| if place % 2 == 0 { free() } else { fixed() });
        let setup = Setup { domain, drive, ..periodic_cube(1.0 / 37.0, Drive::Rest, bodies) };
        agree(session, name, setup);
    }
}

/// Fixed disks in a periodic box under a pressure gradient: the mean velocity is an unknown.
fn a_porous_crystal_has_one_answer(session: &Session) {
    let drive = Drive::PressureGradient(Vector2::new(-1.0, 0.4));
    agree(session, "porous", periodic_cube(1.0 / 36.0, drive, disks(|_| fixed())));
    let drive = Drive::MeanVelocity(Vector2::new(1.0, 0.2));
    agree(session, "half of them free", periodic_cube(1.0 / 36.0, drive, disks(|place| if place < 2 { free() } else { fixed() })));
}

fn transforms_take_no_more_iterations_than_multigrid(session: &Session) {
    let iterations = |inverse| {
        let mut setup = periodic_cube(1.0 / 36.0, Drive::Shear(1.0), disks(|_| free()));
        setup.inverse = inverse;
        solve(session, setup).1.cost.krylov.iterations
    };
    let [multigrid, transforms] = [InverseMethod::Hypre, InverseMethod::Transform].map(iterations);
    assert!(transforms <= multigrid && transforms > 0, "{multigrid} and {transforms} iterations");
}
