//! Flows with inertia: the shifted operator, convection, and bodies with mass.

use std::{
    f64::consts::{PI, TAU},
    path::Path,
};

use nalgebra::{Matrix2, SMatrix, SVector, Vector2};
use turbid::{
    body::{Body, Motion, Twist, components, skew},
    fitted::Mesh,
    flow::{Convection, Drive, FluidSystem, InverseMethod, Stokes},
    geometry::{Axis, Ball, Domain, Inflow, LeesEdwards},
    grid::{Grid, operators::signed},
    mechanics::{FittedFlow, FlowSolver, History, MeshLevel},
    motion::Simulation,
    observe,
    petsc::{Session, Vector},
    plan::flow_solver,
    scene::{ConstraintMethod, ContactModel, MultiplierSolver, Scene, Scheme, Step, TimeSection, Tolerance},
    setup::{Configuration, Inertia, Setup, SuspendedBody},
    system::{ExtrapolationHistory, Level, Snapshot},
};

use crate::{
    Test,
    fields::{boxes_2d, boxes_3d, grid, noise},
};

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(shifted_operators_are_inverted_exactly_by_transforms),
        Test::of(iterations_with_hypre_stay_flat_from_short_steps_to_none),
        Test::of(convection_neither_makes_nor_takes_energy_and_momentum),
        Test::of(a_vortex_that_is_carried_along_is_followed_at_second_order),
        Test::of(a_wave_that_a_sheared_box_tilts_is_followed_at_second_order),
        Test::of(a_disk_in_a_sheared_box_goes_on_alike_wherever_it_is),
        Test::of(a_disk_in_a_sheared_box_without_inertia_moves_as_in_stokes_flow),
        Test::of(a_disk_falls_as_the_reference_says_with_either_inverse),
        Test::of(disks_of_any_density_start_as_fast_as_those_of_an_independent_program),
        Test::of(a_disk_that_starts_with_a_velocity_slows_down_alike_on_grid_and_mesh),
        Test::of(a_free_disk_in_shear_spins_as_slowly_as_inertia_makes_it),
        Test::of(a_disk_that_oscillates_bears_the_exact_force_and_torque),
        Test::of(heavy_disks_fall_alike_in_a_periodic_box_with_either_inverse),
        Test::of(what_flows_in_flows_on_and_out),
        Test::of(a_disk_in_an_open_channel_is_dragged_as_in_a_periodic_one),
        Test::of(a_step_from_remembered_levels_is_the_step_of_the_whole_run),
        Test::of(a_disk_that_lands_rests_on_the_floor),
        Test::of(a_heavy_sphere_with_films_does_not_rebound),
        Test::of(a_disk_that_starts_to_spin_has_its_momentum_wherever_it_is),
        Test::of(a_sphere_that_starts_at_once_bears_the_exact_force),
        Test::of(disks_across_a_thin_gap_move_as_a_mesh_that_resolves_it_says),
        Test::only_on(1, a_disk_half_a_cell_from_a_wall_falls_alike_in_steps_however_short),
        Test::of(a_fitted_mesh_follows_a_falling_disk_at_second_order),
        Test::of(a_new_mesh_has_the_momentum_of_the_old_one),
        Test::of(a_sphere_falls_straight_and_alike_with_either_inverse),
        Test::of(methods_of_first_order_move_bodies_about_as_sharp_does),
        Test::of(methods_of_first_order_solve_alike_with_either_inverse),
        Test::of(light_disks_of_first_order_start_in_steps_of_any_length),
        Test::of(a_disk_that_goes_with_the_stream_goes_on_with_it),
        Test::of(automatic_steps_from_rest_know_what_comes_and_not_the_end),
        Test::of(an_automatic_step_is_taken_again_where_the_flow_is_faster_than_it_was),
        Test::of(a_fixed_step_in_which_the_flow_passes_too_much_is_refused_with_one_that_will_do),
    ]
}

fn shifted_operators_are_inverted_exactly_by_transforms(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, shift: f64) {
        let grid = grid(session, domain, 12);
        let stokes = Stokes::shifted(session, &grid, shift);
        let mut inverse = InverseMethod::Transform.set_up(&stokes, &grid).unwrap();
        let (mut x, mut rows) = (stokes.vector().unwrap(), stokes.vector().unwrap());
        let mut rhs = noisy(&grid, &stokes);
        stokes.balance(&mut rhs).unwrap();
        inverse.precondition(&stokes, &rhs, &mut x).unwrap();
        stokes.multiply(&x, &mut rows).unwrap();
        stokes.balance(&mut rows).unwrap();
        rows.add(-1.0, &rhs).unwrap();
        let error = rows.norm().unwrap() / rhs.norm().unwrap();
        assert!(error < 1e-11, "shift {shift} in {domain:?}: {error:e}");
    }
    for shift in [0.0, 1.0, 1e3, 1e6] {
        boxes_2d().take(2).for_each(|domain| proof(session, &domain, shift));
        boxes_3d().take(2).for_each(|domain| proof(session, &domain, shift));
    }
}

fn noisy<const D: usize>(grid: &Grid<D>, stokes: &Stokes<D>) -> Vector {
    let mut vector = stokes.vector().unwrap();
    let mut values = vector.local_mut().unwrap();
    for field in 0..=D {
        for (value, index) in values[grid.local_range(field)].iter_mut().zip(grid.block(field).indices()) {
            *value = noise(field, index);
        }
    }
    drop(values);
    vector
}

/// From steady flow to steps in which viscosity passes a thirtieth of a cell.
fn iterations_with_hypre_stay_flat_from_short_steps_to_none(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, cells: usize) {
        let iterations = |shift: f64| {
            let grid = grid(session, domain, cells);
            let stokes = Stokes::shifted(session, &grid, shift * grid.mean_spacing().powi(-2));
            let mut inverse = InverseMethod::Hypre.set_up(&stokes, &grid).unwrap();
            let mut rhs = noisy(&grid, &stokes);
            stokes.balance(&mut rhs).unwrap();
            let mut x = stokes.vector().unwrap();
            FluidSystem { stokes: &stokes, inverse: Some(inverse.as_mut()) }.solve(&rhs, &mut x, 1e-8, 200).unwrap().iterations
        };
        let steady = iterations(0.0);
        for shift in [1e-3, 0.1, 1.0, 30.0, 1e3] {
            let found = iterations(shift);
            assert!(4 * found <= 5 * steady, "{found} iterations at shift {shift}, {steady} without, in {domain:?}");
        }
    }
    boxes_2d().for_each(|domain| proof(session, &domain, 31));
    boxes_3d().for_each(|domain| proof(session, &domain, 15));
}

/// The velocity of a stream function at points of the grid: without divergence in every cell, and through no wall.
fn stream<const D: usize>(grid: &Grid<D>, shape: &Vector, function: impl Fn(&SVector<f64, D>) -> f64) -> Vector {
    let mut fluid = shape.like().unwrap();
    let mut values = fluid.local_mut().unwrap();
    for (component, across, sign) in [(0, 1, 1.0), (1, 0, -1.0)] {
        let half = 0.5 * grid.spacing()[across];
        for (value, index) in values[grid.local_range(component)].iter_mut().zip(grid.block(component).indices()) {
            let (mut above, mut below) = (grid.position(component, signed(index)), grid.position(component, signed(index)));
            above[across] += half;
            below[across] -= half;
            *value = sign * (function(&above) - function(&below)) / (2.0 * half);
        }
    }
    drop(values);
    fluid
}

fn convection_neither_makes_nor_takes_energy_and_momentum(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>) {
        let grid = grid(session, domain, 14);
        let shape = Stokes::new(session, &grid).vector().unwrap();
        // zero on walls, of waves along periodic axes, different in every layer
        let function = |x: &SVector<f64, D>| {
            let wave = |axis: usize, number: f64, phase: f64| {
                let way = x[axis] / domain.size[axis];
                if domain.periodic(axis) { (TAU * number * way + phase).sin() } else { (0.5 * TAU * number * way).sin() }
            };
            let layers = if D == 3 { 1.0 + 0.4 * wave(2, 1.0, 0.3) } else { 1.0 };
            layers * (wave(0, 1.0, 0.2) * wave(1, 2.0, 0.9) + 0.7 * wave(0, 2.0, 1.3) * wave(1, 1.0, 0.4))
        };
        let velocity = stream(&grid, &shape, function);
        let mut rows = shape.like().unwrap();
        Convection::new(&grid, &shape).unwrap().evaluate(&velocity, &mut rows).unwrap();
        let power = velocity.dot(&rows).unwrap();
        let scale = velocity.norm().unwrap() * rows.norm().unwrap();
        assert!(scale > 0.0 && power.abs() < 1e-12 * scale, "{power:e} of {scale:e} in {domain:?}");
        for axis in (0..D).filter(|_| domain.fully_periodic()) {
            let mut sum = [rows.local().unwrap()[grid.local_range(axis)].iter().sum::<f64>()];
            session.world().sum(&mut sum);
            assert!(sum[0].abs() < 1e-9 * scale, "momentum {:e}", sum[0]);
        }
    }
    boxes_2d().for_each(|domain| proof(session, &domain));
    boxes_3d().for_each(|domain| proof(session, &domain));
}

fn setup<const D: usize>(domain: Domain<D>, spacing: f64, viscosity: f64, bodies: Vec<(SuspendedBody<D>, f64)>) -> Setup<D> {
    let (bodies, densities): (Vec<SuspendedBody<D>>, Vec<f64>) = bodies.into_iter().unzip();
    let inverse = InverseMethod::fastest(&domain);
    Setup {
        changing_drive: None,
        domain,
        spacing,
        viscosity,
        drive: Drive::Rest,
        bodies,
        inertia: Some(Inertia { fluid: 1.0, starts: vec![Twist::zero(); densities.len()], bodies: densities }),
        trajectories: Default::default(),
        constraint: ConstraintMethod::Sharp,
        interactions: Default::default(),
        inverse,
        tolerance: Tolerance::Fixed(1e-8),
    }
}

fn configuration<const D: usize>(centers: &[SVector<f64, D>], time: f64) -> Configuration<'_, D> {
    Configuration::new(centers, time, 1e-8)
}

/// Vortices in a square carried along: `u = U + v(x - U t) exp(-2 k^2 nu t)` with `v = (sin kx cos ky, -cos kx sin ky)` is exact.
fn a_vortex_that_is_carried_along_is_followed_at_second_order(session: &Session) {
    let (viscosity, wind, end, wave) = (0.02, Vector2::new(0.7, -0.4), 0.4, TAU);
    let error = |cells: usize| {
        let domain = Domain { size: Vector2::new(1.0, 1.0), axes: [Axis::Periodic; 2] };
        let setup = Setup { drive: Drive::MeanVelocity(wind), ..setup(domain, 1.0 / cells as f64, viscosity, Vec::new()) };
        let mut flow = flow_solver(session, setup).unwrap();
        let exact = |time: f64| {
            let decay = (-2.0 * wave * wave * viscosity * time).exp();
            let at = |x: &Vector2<f64>| x - wind * time;
            // the discrete flow of the stream function, made as strong as the exact one
            let mut fluid = stream(flow.grid(), &fluid_vector(session, flow.grid()), |x| {
                let x = at(x);
                (wave * x[0]).sin() * (wave * x[1]).sin() / wave * decay
            });
            let mut values = fluid.local_mut().unwrap();
            (0..2).for_each(|axis| values[flow.grid().local_range(axis)].iter_mut().for_each(|value| *value += wind[axis]));
            drop(values);
            fluid
        };
        let (start, last) = (exact(0.0), exact(end));
        let found = followed(flow.as_mut(), start, (end, cells));
        distance(session, flow.grid(), found, &last)
    };
    at_second_order(error, 0.02);
}

/// A fluid vector of zeros.
fn fluid_vector(session: &Session, grid: &Grid<2>) -> Vector {
    Vector::new(session, grid.local_fluid_unknowns()).unwrap()
}

/// The flow without bodies that comes of another in so many steps to an end.
fn followed(flow: &mut dyn FlowSolver<2>, fluid: Vector, (end, steps): (f64, usize)) -> Vector {
    let (multipliers, centers, twists) = (Vec::new(), Vec::new(), Vec::new());
    let start = Level {
        time: 0.0,
        fluid,
        smooth: multipliers.clone(),
        slow: multipliers.clone(),
        lagging: multipliers.clone(),
        multipliers,
        centers,
        twists,
        spin_ups: Vec::new(),
        impulses: Vec::new(),
        resolved: 0.0,
    };
    flow.restore(History { levels: vec![start], ..History::default() }).unwrap();
    let step = |step: usize| flow.solve_at(&configuration(&[], end * step as f64 / steps as f64), &mut |_, _| {}).unwrap().fluid;
    (1..=steps).map(step).last().unwrap()
}

/// Root mean square of the difference between the velocities of two flows on a grid.
fn distance(session: &Session, grid: &Grid<2>, mut one: Vector, other: &Vector) -> f64 {
    one.add(-1.0, other).unwrap();
    let values = one.local().unwrap();
    let square = |axis: usize| values[grid.local_range(axis)].iter().map(|value| value * value).sum::<f64>();
    let mut sum = [square(0) + square(1)];
    session.world().sum(&mut sum);
    (sum[0] / grid.cells().iter().product::<usize>() as f64).sqrt()
}

/// That errors with 24 and 48 cells are those of a method of second order, the latter below a bound.
fn at_second_order(error: impl Fn(usize) -> f64, bound: f64) {
    let (coarse, fine) = (error(24), error(48));
    let order = (coarse / fine).log2();
    assert!(order > 1.85 && fine < bound, "errors {coarse:e} and {fine:e}, order {order}");
}

/// Kelvin's wave in a shear of rate 1, `psi = A(t) cos(k x - k t y)`: its vorticity is carried along and decays by viscosity alone, so that
/// `A (1 + t^2) = A_0 exp(-nu k^2 (t + t^3/3))` is exact. Images slide by a cell in each step.
fn a_wave_that_a_sheared_box_tilts_is_followed_at_second_order(session: &Session) {
    let (viscosity, wave, end) = (0.01, TAU, 1.0);
    let error = |cells: usize| {
        let slide = LeesEdwards::steady(0.0, 1.0, 0.0);
        let domain = Domain { size: Vector2::new(1.0, 1.0), axes: [Axis::Periodic, Axis::Sheared(slide)] };
        let setup = Setup { drive: Drive::Shear(1.0), ..setup(domain, 1.0 / cells as f64, viscosity, Vec::new()) };
        let mut flow = flow_solver(session, setup).unwrap();
        let shape = fluid_vector(session, flow.grid());
        let exact = |grid: &Grid<2>, time: f64| {
            let decay = (-viscosity * wave * wave * (time + time.powi(3) / 3.0)).exp() / (1.0 + time * time);
            stream(grid, &shape, |x| (wave * (x[0] - time * x[1])).cos() * decay / wave)
        };
        let start = exact(flow.grid(), 0.0);
        let found = followed(flow.as_mut(), start, (end, cells));
        distance(session, flow.grid(), found, &exact(flow.grid(), end))
    };
    at_second_order(error, 0.004);
}

/// A disk in a sheared box whose particle Reynolds number is this, at a height, with a velocity relative to the shear: viscosity, spin and velocity relative
/// to the shear after a while.
fn in_sheared_box(session: &Session, (model, reynolds): (&str, f64), height: f64, velocity: &str) -> (f64, f64, Vector2<f64>) {
    let density = if model == "stokes" { String::new() } else { format!("density = {reynolds}\n") };
    let text = format!(
        "[domain]\nsize = [8.0, 8.0]\n[flow]\nmodel = \"{model}\"\n{density}drive = {{ shear_rate = 1.0, periodic = \"sheared\" }}\n\
         [resolution]\ncells_per_radius = 6\n[method]\ninverse = \"transform\"\ntolerance = 1e-8\n\
         [[bodies]]\nradius = 1.0\ncenters = [[3.0, {height}]]\n{density}{velocity}[time]\nend = 2.0\n"
    );
    let scene = Scene::parse("sheared", Path::new("."), &text, &[]).unwrap();
    let mut simulation = Simulation::<2>::new(session, &scene).unwrap();
    while !simulation.over() {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
    let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
    let (flow, solution) = (simulation.suspension().unwrap(), observation.solution.unwrap());
    let viscosity = observe::viscosity(flow.setup(), flow.grid(), &solution, &[]).unwrap().unwrap().relative();
    let Twist { velocity, spin } = solution.bodies[0].twist;
    (viscosity, spin[(1, 0)], velocity - simulation.domain().carried(&solution.bodies[0].center))
}

/// At the middle of the box, through which the boundary of the frames goes, at its bottom, and from one box into the next.
fn a_disk_in_a_sheared_box_goes_on_alike_wherever_it_is(session: &Session) {
    let [middle, bottom] = [4.0, 0.0].map(|height| in_sheared_box(session, ("navier-stokes", 1.0), height, ""));
    assert!((middle.0 - bottom.0).abs() < 0.01 * (bottom.0 - 1.0), "{middle:?} {bottom:?}");
    assert!((middle.1 / bottom.1 - 1.0).abs() < 0.01 && bottom.1 > -0.49, "{middle:?} {bottom:?}");
    let [inside, across] = [2.2, 0.2].map(|height| in_sheared_box(session, ("navier-stokes", 1.0), height, "velocity = [0.0, -1.0]\n"));
    // of the velocity at the start, a hundredth is left
    assert!((inside.2 - across.2).norm() < 0.005 && inside.2.norm() > 0.005, "{inside:?} {across:?}");
    assert!((inside.1 / across.1 - 1.0).abs() < 0.01, "{inside:?} {across:?}");
}

fn a_disk_in_a_sheared_box_without_inertia_moves_as_in_stokes_flow(session: &Session) {
    let (inert, creeping) = (in_sheared_box(session, ("navier-stokes", 1e-3), 0.0, ""), in_sheared_box(session, ("stokes", 0.0), 0.0, ""));
    assert!((inert.0 - creeping.0).abs() < 1e-4 && (inert.1 - creeping.1).abs() < 2e-4, "{inert:?} {creeping:?}");
}

fn free<const D: usize>(center: [f64; D], radius: f64, order: usize, force: SVector<f64, D>) -> SuspendedBody<D> {
    let motion = Motion::Free { force, torque: SMatrix::zeros() };
    SuspendedBody { body: Body { ball: Ball { center: center.into(), radius }, motion }, order }
}

fn closed<const D: usize>(size: [f64; D]) -> Domain<D> {
    Domain { size: size.into(), axes: [Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() }; D] }
}

fn run<const D: usize>(session: &Session, setup: Setup<D>, step: f64, end: f64) -> Simulation<D> {
    let time = TimeSection { step: Step::Fixed(step), end, scheme: Scheme::TwoStep, travel: 0.1, error: 1e-3, until: None };
    let flow = flow_solver(session, setup.with_contact(ContactModel::Inelastic)).unwrap();
    let mut simulation = Simulation::flowing(session, flow, time);
    while !simulation.over() {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
    simulation
}

/// The motion of the first body at the time that a run has reached.
fn motion<const D: usize>(simulation: &mut Simulation<D>) -> Twist<D> {
    simulation.evaluate(&mut |_, _| {}).unwrap().twists[0]
}

/// The settling disk of Glowinski et al. (2001): speed at t = 0.05 by a converged fitted mesh, 2.679 (`turbid validation` has its whole way).
fn a_disk_falls_as_the_reference_says_with_either_inverse(session: &Session) {
    let disk = (free([1.0, 4.0], 0.125, 4, Vector2::new(0.0, -245.0 * 0.125 * 0.125 * TAU / 2.0)), 1.25);
    let mut simulation = run(session, setup(closed([2.0, 6.0]), 0.125 / 4.0, 0.1, vec![disk]), 0.0025, 0.05);
    let speed = -motion(&mut simulation).velocity[1];
    assert!((speed / 2.679 - 1.0).abs() < 0.01, "{speed}");
    // in a channel of the same width, both inverses
    let channel = |inverse| {
        let axes = [Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() }, Axis::Periodic];
        let channel = setup(Domain { size: Vector2::new(2.0, 3.0), axes }, 0.125 / 4.0, 0.1, vec![disk_at(1.0, 2.0)]);
        motion(&mut run(session, Setup { inverse, ..channel }, 0.0025, 0.025)).velocity
    };
    let (one, other) = (channel(InverseMethod::Hypre), channel(InverseMethod::Transform));
    assert!((one - other).norm() < 1e-5 * one.norm(), "{one} {other}");
}

fn disk_at(x: f64, y: f64) -> (SuspendedBody<2>, f64) {
    (free([x, y], 0.125, 4, Vector2::new(0.3, -245.0 * 0.125 * 0.125 * TAU / 2.0)), 1.25)
}

/// Speeds at t = 0.02 of disks whose acceleration without viscosity would be 108.889: an independent implementation in Python of the same method on the same
/// grid. Half the step changes none by a hundredth.
fn disks_of_any_density_start_as_fast_as_those_of_an_independent_program(session: &Session) {
    let volume = 0.125 * 0.125 * TAU / 2.0;
    for (density, known) in [(10.0, 1.9447), (1.25, 1.3543), (0.5, 1.1307), (0.1, 0.9544), (0.01, 0.9064)] {
        let speed = |step: f64| {
            let force = 108.889 * (density + 1.0) * volume;
            let disk = (free([1.0, 1.0], 0.125, 4, Vector2::new(0.0, -force)), density);
            -motion(&mut run(session, setup(closed([2.0, 2.0]), 0.125 / 4.0, 0.1, vec![disk]), step, 0.02)).velocity[1]
        };
        let (coarse, fine) = (speed(2e-3), speed(1e-3));
        assert!((fine / known - 1.0).abs() < 0.012, "density {density}: {fine}, not {known}");
        assert!((coarse / fine - 1.0).abs() < 0.01, "density {density}: {coarse} and {fine} with half the step");
    }
    // much heavier than the fluid: it hardly notices it
    let disk = (free([1.0, 1.0], 0.125, 4, Vector2::new(0.0, -100.0 * 100.0 * volume)), 100.0);
    let heavy = -motion(&mut run(session, setup(closed([2.0, 2.0]), 0.125 / 4.0, 0.01, vec![disk]), 5e-4, 0.01)).velocity[1];
    assert!((0.98..1.0).contains(&heavy), "{heavy}");
}

/// A disk twice as heavy as the fluid is put into it with a velocity and a spin: it shares its momentum with the fluid that it pushes aside, and slows down.
fn a_disk_that_starts_with_a_velocity_slows_down_alike_on_grid_and_mesh(session: &Session) {
    let ends = ["sharp", "fitted"].map(|constraint| {
        let text = format!(
            "domain = {{ size = [2.0, 2.0], x = \"walls\", y = \"walls\" }}\n\
             flow = {{ model = \"navier-stokes\", viscosity = 0.02, density = 1.0 }}\n\
             resolution = {{ cells_per_radius = 5 }}\nmethod = {{ constraint = \"{constraint}\" }}\n\
             bodies = [{{ radius = 0.25, centers = [[0.8, 1.1]], density = 2.0, velocity = [1.0, 0.0], spin = 2.0 }}]\n\
             time = {{ end = 0.1, step = 0.005 }}\n"
        );
        let scene = Scene::parse("start", Path::new("."), &text, &[]).unwrap();
        let mut simulation = Simulation::<2>::new(session, &scene).unwrap();
        let mut energies = Vec::new();
        loop {
            let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
            let (flow, solution) = (simulation.suspension().unwrap(), observation.solution.as_ref().unwrap());
            energies.push(observe::InertialNumbers::of(flow.setup(), flow.grid(), solution, false).unwrap().unwrap().kinetic_energy);
            let twist = observation.twists[0];
            if simulation.over() {
                assert!(energies.windows(2).all(|pair| pair[1] < pair[0]), "{constraint}: {energies:?}");
                break twist;
            }
            assert!(energies.len() > 1 || (twist.velocity == Vector2::x() && twist.spin[(1, 0)] == 2.0), "{constraint}: {twist:?}");
            simulation.step(&observation, &mut |_, _| {}).unwrap();
        }
    });
    let [one, other] = ends;
    assert!((one.velocity - other.velocity).norm() < 0.015 * other.velocity.norm(), "{ends:?}");
    assert!((one.spin - other.spin).norm() < 0.03 * other.spin.norm(), "{ends:?}");
    assert!(other.velocity[0] > 0.3 && other.velocity[0] < 2.0 / 3.0, "added mass alone takes a third: {ends:?}");
}

/// A free disk in a Couette cell at Re = 1 (radius 0.125, cell 1 x 1): spin 0.4632696 of the rate (0.4855642 without inertia).
fn a_free_disk_in_shear_spins_as_slowly_as_inertia_makes_it(session: &Session) {
    let walls = Axis::Walls { lower: Vector2::new(-0.5, 0.0), upper: Vector2::new(0.5, 0.0) };
    let domain = Domain { size: Vector2::new(1.0, 1.0), axes: [Axis::Periodic, walls] };
    let disk = (free([0.5, 0.5], 0.125, 4, Vector2::zeros()), 1.0);
    let mut simulation = run(session, setup(domain, 0.125 / 4.0, 0.015625, vec![disk]), 0.04, 25.0);
    let spin = motion(&mut simulation).spin[(0, 1)];
    assert!((spin / 0.4632696 - 1.0).abs() < 0.015, "{spin}");
}

/// In a periodic box of six radii, a layer of 0.28 radii around the disk: amplitudes over viscosity and speed, and phases before the velocity, in degrees
/// (`turbid validation --inertia=oscillating-disk` derives and refines them).
fn a_disk_that_oscillates_bears_the_exact_force_and_torque(session: &Session) {
    let (viscosity, steps) = (0.5 * 0.28 * 0.28, 96);
    for (motion, axis, exact, phase) in [("amplitude = [1e-4, 0.0]", 0, 162.390565, 66.589), ("rotation = 1e-4", 1, 39.090116, 34.582)] {
        let text = format!(
            "domain = {{ size = [6.0, 6.0] }}\nflow = {{ model = \"navier-stokes\", viscosity = {viscosity}, density = 1.0 }}\n\
             resolution = {{ cells_per_radius = 5, modes = 5 }}\n\
             bodies = [{{ radius = 1.0, centers = [[3.1, 2.9]], motion = {{ {motion}, frequency = {}, phase = {} }} }}]\n\
             time = {{ end = {}, step = {} }}\n",
            1.0 / TAU,
            0.25 * TAU,
            2.0 * TAU,
            TAU / steps as f64
        );
        let scene = Scene::parse("oscillation", Path::new("."), &text, &[]).unwrap();
        let mut simulation = Simulation::<2>::new(session, &scene).unwrap();
        let mut found = [0.0; 2];
        loop {
            let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
            let (state, body) = (simulation.state(), &observation.solution.as_ref().unwrap().bodies[0]);
            let load = [body.force[0], body.torque[(1, 0)]][axis] / (viscosity * 1e-4);
            if state.steps > steps {
                found[0] += load * state.time.sin() * 2.0 / steps as f64;
                found[1] += load * state.time.cos() * 2.0 / steps as f64;
            }
            if simulation.over() {
                let way = 1e-4 * (state.time.cos() - 1.0);
                assert!(axis == 1 || (state.bodies[0].center[0] - 3.1 - way).abs() < 1e-12);
                break;
            }
            simulation.step(&observation, &mut |_, _| {}).unwrap();
        }
        // the velocity is -sin t, the load what resists it
        let (size, lead) = (found[0].hypot(found[1]), found[1].atan2(found[0]).to_degrees());
        assert!((size / exact - 1.0).abs() < 0.01 && (lead - phase).abs() < 1.0, "{motion}: {size} at {lead} degrees");
    }
}

/// The mean velocity is given, and no row of the linear system sees it: starting points must not bring another one.
fn heavy_disks_fall_alike_in_a_periodic_box_with_either_inverse(session: &Session) {
    let motion = |inverse| {
        let domain = Domain { size: Vector2::new(4.0, 4.0), axes: [Axis::Periodic; 2] };
        let disks = [[1.0, 3.0], [2.8, 1.2]].map(|center| (free(center, 0.4, 3, Vector2::new(0.0, -2.5)), 1.5)).into();
        let setup = Setup { inverse, drive: Drive::MeanVelocity(Vector2::new(0.2, 0.0)), ..setup(domain, 0.1, 0.1, disks) };
        motion(&mut run(session, setup, 0.02, 0.6)).velocity
    };
    let (one, other) = (motion(InverseMethod::Hypre), motion(InverseMethod::Transform));
    assert!((one - other).norm() < 1e-4 * one.norm(), "{one} {other}");
}

/// Nothing in the way: the profile goes through unchanged, over a uniform and a parabolic inflow and with either inverse, in 2D and 3D.
fn what_flows_in_flows_on_and_out(session: &Session) {
    fn proof<const D: usize>(session: &Session, axes: [Axis<D>; D], inverse: InverseMethod) {
        let domain = Domain { size: SVector::from_fn(|axis, _| if axis == 0 { 2.0 } else { 1.0 }), axes };
        let (open, inflow) = domain.open().unwrap();
        let mut flow = flow_solver(session, Setup { inverse, ..setup(domain.clone(), 1.0 / 12.0, 0.02, Vec::new()) }).unwrap();
        let mut solution = flow.solve_at(&configuration(&[], 0.0), &mut |_, _| {}).unwrap();
        for step in 1..=6 {
            solution = flow.solve_at(&configuration(&[], 0.02 * f64::from(step)), &mut |_, _| {}).unwrap();
        }
        let grid = flow.grid();
        let values = solution.fluid.local().unwrap();
        for (value, index) in values[grid.local_range(open)].iter().zip(grid.block(open).indices()) {
            let profile = domain.inflow_at(&grid.position(open, signed(index)));
            assert!((value - profile).abs() < 0.01 * inflow.speed, "{value}, not {profile}");
        }
        // read off at the ends and in corners
        let points: Vec<SVector<f64, D>> = [[0.0, 0.5], [2.0, 0.5], [1.999, 0.001], [0.001, 0.999]]
            .map(|[x, y]| SVector::from_fn(|axis, _| if axis == 0 { x } else { y }))
            .into();
        for (point, velocity) in points.iter().zip(observe::velocities(grid, &solution.fluid, &points).unwrap()) {
            assert!((velocity[open] - domain.inflow_at(point)).abs() < 0.02 * inflow.speed, "{velocity} at {point}");
        }
        let mean = domain.mean_inflow();
        assert!((solution.mean_velocity[open] / mean - 1.0).abs() < 0.01, "{} of {mean}", solution.mean_velocity);
    }
    let still = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
    let open = |parabolic| Inflow { speed: 0.5, parabolic };
    proof::<2>(session, [Axis::Open(open(false)), Axis::Periodic], InverseMethod::Transform);
    proof::<2>(session, [Axis::Open(open(true)), still], InverseMethod::Hypre);
    proof::<3>(session, [Axis::Open(open(false)), Axis::Periodic, Axis::Periodic], InverseMethod::Transform);
}

fn a_disk_in_an_open_channel_is_dragged_as_in_a_periodic_one(session: &Session) {
    let drag = |x: &str, drive: &str| {
        let text = format!(
            "domain = {{ size = [3.0, 1.0], x = {x}, y = \"walls\" }}\n{drive}resolution = {{ cells_per_radius = 4, modes = 4 }}\n\
             bodies = [{{ radius = 0.125, centers = [[1.5, 0.45]], motion = \"fixed\" }}]\n"
        );
        let scene = Scene::parse("channel", Path::new("."), &text, &[]).unwrap();
        let solution = flow_solver::<2>(session, Setup::of(&scene).unwrap()).unwrap().solve(&mut |_, _| {}).unwrap();
        assert!((solution.mean_velocity[0] - 1.0).abs() < 2e-3, "{}", solution.mean_velocity);
        solution.bodies[0].force[0]
    };
    let (open, periodic) = (drag("{ inflow = 1.5 }", ""), drag("\"periodic\"", "flow.drive = { mean_velocity = [1.0, 0.0] }\n"));
    assert!((open / periodic - 1.0).abs() < 5e-3, "{open} and {periodic}");
}

fn a_step_from_remembered_levels_is_the_step_of_the_whole_run(session: &Session) {
    let flow = || {
        let disks = vec![disk_at(0.7, 2.0), disk_at(1.2, 2.3)];
        flow_solver(session, setup(closed([2.0, 3.0]), 0.125 / 4.0, 0.1, disks)).unwrap()
    };
    let centers = |step: usize| [Vector2::new(0.7, 2.0 - 0.003 * step as f64), Vector2::new(1.2, 2.3 - 0.004 * step as f64)];
    let solve = |flow: &mut dyn FlowSolver<2>, step: usize| {
        flow.solve_at(&configuration(&centers(step), 0.002 * step as f64), &mut |_, _| {}).unwrap()
    };
    let mut whole = flow();
    (0..4).for_each(|step| drop(solve(whole.as_mut(), step)));
    let copies = whole.history(f64::INFINITY).levels.into_iter().map(|level| {
        let mut fluid = level.fluid.like().unwrap();
        fluid.copy_from(&level.fluid).unwrap();
        let Level { time, multipliers, smooth, slow, lagging, centers, twists, spin_ups, impulses, resolved, .. } = level;
        let (multipliers, centers, twists) = (multipliers.clone(), centers.clone(), twists.clone());
        let (smooth, slow, lagging) = (smooth.clone(), slow.clone(), lagging.clone());
        let (spin_ups, impulses, resolved) = (spin_ups.clone(), impulses.clone(), *resolved);
        Level { time: *time, fluid, multipliers, smooth, slow, lagging, centers, twists, spin_ups, impulses, resolved }
    });
    let mut resumed = flow();
    resumed.restore(History { levels: copies.collect(), ..History::default() }).unwrap();
    let (one, other) = (solve(whole.as_mut(), 4), solve(resumed.as_mut(), 4));
    for (one, other) in one.bodies.iter().zip(&other.bodies) {
        assert!((one.twist.velocity - other.twist.velocity).norm() < 1e-6 * one.twist.velocity.norm());
    }
    // again at the same time, as contacts ask for, is the same step
    let again = solve(whole.as_mut(), 4);
    assert!((again.bodies[0].twist.velocity - one.bodies[0].twist.velocity).norm() < 1e-6 * one.bodies[0].twist.velocity.norm());
}

fn a_disk_that_lands_rests_on_the_floor(session: &Session) {
    let disk = (free([0.5, 0.19], 0.125, 4, Vector2::new(0.0, -10.0)), 5.0);
    let mut simulation = run(session, setup(closed([1.0, 1.0]), 0.125 / 4.0, 0.1, vec![disk]), 0.005, 0.4);
    let (height, speed) = (simulation.state().bodies[0].center[1], motion(&mut simulation).velocity.norm());
    assert!((0.125 - 1e-9..0.125 + 1e-3).contains(&height), "{height}");
    assert!(speed < 1e-3, "{speed}");
}

fn a_heavy_sphere_with_films_does_not_rebound(session: &Session) {
    let text = "gravity = [0.0, -10.0, 0.0]\ndomain = { size = [4.0, 5.0, 4.0], y = \"walls\" }\nresolution = { cells_per_radius = 4 }\n\
                flow = { model = \"navier-stokes\", viscosity = 0.5, density = 1.0 }\nlubrication = { model = \"pairwise\" }\n\
                bodies = [{ radius = 0.8, centers = [[2.0, 1.1, 2.0]], density = 8.0 }]\ncontact = { model = \"inelastic\" }\ntime = { end = 0.7 }\n";
    let mut simulation = Simulation::<3>::new(session, &scene(text)).unwrap();
    let mut touched = 0;
    while !simulation.over() {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        simulation.step(&observation, &mut |_, _| {}).unwrap();
        let gap = simulation.whole_state().bodies[0].center[1] / 0.8 - 1.0;
        assert!(touched == 0 || gap < 1e-9, "after {touched} steps on the floor a gap of {gap:e}");
        touched += usize::from(touched > 0 || gap < 1e-9);
    }
    assert!(touched > 3, "{touched}");
}

/// A neutrally buoyant disk alone in a fluid at rest, whose spin is 0.2439 of what it was at the time 0.1 (radius squared over kinematic viscosity; Laplace
/// inversion of the exact solution). What is carried in is the momentum of the disk, whatever points of the grid lie in it.
fn a_disk_that_starts_to_spin_has_its_momentum_wherever_it_is(session: &Session) {
    for center in [[6.0, 6.0], [6.05, 6.0], [6.125, 6.0625]] {
        let text = format!(
            "domain = {{ size = [12.0, 12.0] }}\nflow = {{ model = \"navier-stokes\", viscosity = 0.5, density = 1.0 }}\n\
             resolution = {{ cells_per_radius = 4 }}\nbodies = [{{ radius = 1.0, centers = [{center:?}], density = 1.0, spin = 1.0 }}]\n\
             time = {{ end = 0.2, step = 0.01 }}\n"
        );
        let mut simulation = Simulation::<2>::new(session, &scene(&text)).unwrap();
        while !simulation.over() {
            let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
            simulation.step(&observation, &mut |_, _| {}).unwrap();
        }
        let twist = motion(&mut simulation);
        assert!((components(&twist.spin)[0] / 0.2439 - 1.0).abs() < 0.02, "{center:?}: {}", components(&twist.spin)[0]);
        assert!(twist.velocity.norm() < 1e-3, "{center:?}: {}", twist.velocity);
    }
}

/// A sphere that moves at once from rest bears `(m_a U + impulse of Basset's force) / dt` in the mean over the first step, and then Basset's force with the drag.
fn a_sphere_that_starts_at_once_bears_the_exact_force(session: &Session) {
    let (speed, step, radius) = (0.1, 0.01, 1.0);
    let text = format!(
        "domain = {{ size = [8.0, 8.0, 8.0] }}\nflow = {{ model = \"navier-stokes\", viscosity = 1.0, density = 1.0 }}\nresolution = {{ cells_per_radius = 5 }}\n\
         bodies = [{{ radius = {radius}, centers = [[4.1, 4.3, 3.8]], motion = {{ velocity = [{speed}, 0.0, 0.0] }} }}]\ntime = {{ end = 0.06, step = {step} }}\n"
    );
    let mut simulation = Simulation::<3>::new(session, &scene(&text)).unwrap();
    let mut forces = Vec::new();
    while !simulation.over() {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        forces.push(observation.solution.as_ref().unwrap().bodies[0].force[0]);
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
    // the mean over a step of 6 pi mu a U (1 + a / sqrt(pi nu t)), and half the mass of the fluid in the first one
    let mean = |number: usize| {
        let [from, to] = [number - 1, number].map(|number| (number as f64 * step).sqrt());
        -6.0 * PI * speed * (1.0 + 2.0 * radius / PI.sqrt() * (to - from) / step)
    };
    let exact = [mean(1) - 2.0 / 3.0 * PI * speed / step, mean(2), mean(3), mean(4), mean(5)];
    for ((number, force), (exact, error)) in forces.iter().enumerate().skip(1).zip(exact.iter().zip([0.05, 0.25, 0.15, 0.1, 0.1])) {
        assert!((force / exact - 1.0).abs() < error, "row {number}: {force} for {exact}");
    }
}

/// Disks of several densities pulled past each other at a gap of 0.0045 radii: motions at t = 0.05 by a fitted mesh, of which 12 and 24 edges a
/// radius give the same six digits. Without films the disks spin at half that speed.
fn disks_across_a_thin_gap_move_as_a_mesh_that_resolves_it_says(session: &Session) {
    let text = "domain = { size = [6.0, 6.0], y = \"walls\" }\nflow = { model = \"navier-stokes\", viscosity = 1.0, density = 1.0 }\n\
                resolution = { cells_per_radius = 6 }\nlubrication = { model = \"pairwise\" }\nmethod = { inverse = \"transform\" }\n\
                bodies = [{ radius = 1.0, centers = [[2.0, 3.0]], density = 5.0, force = [0.0, -10.0] },\n\
                          { radius = 1.0, centers = [[4.002, 3.1]], density = 2.0, force = [-3.0, 5.0] }]\n\
                time = { end = 0.05, step = 0.005 }\n";
    let scene = Scene::parse("films", Path::new("."), text, &[]).unwrap();
    let mut simulation = Simulation::<2>::new(session, &scene).unwrap();
    while !simulation.over() {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
    let found = simulation.evaluate(&mut |_, _| {}).unwrap().twists;
    let known = [([-0.00482393, -0.02383518], 0.00471306), ([-0.00725679, 0.02225655], 0.00877203)];
    for (twist, (velocity, spin)) in found.iter().zip(known) {
        assert!((twist.velocity - Vector2::from(velocity)).norm() < 0.005 * Vector2::from(velocity).norm(), "{}", twist.velocity);
        assert!((twist.spin[(1, 0)] / spin - 1.0).abs() < 0.03, "{}, not {spin}", twist.spin);
    }
}

/// From steps in which viscosity passes an eighth of a square cell to those of a two hundredth; a fitted mesh resolves the gap.
fn a_disk_half_a_cell_from_a_wall_falls_alike_in_steps_however_short(session: &Session) {
    let speed = |constraint: &str, step: f64| {
        let text = format!(
            "domain = {{ size = [8.0, 6.0], y = \"walls\" }}\ngravity = [0.0, -1e-3]\n\
             flow = {{ model = \"navier-stokes\", viscosity = 1.0, density = 1.0 }}\n\
             resolution = {{ cells_per_radius = 5 }}\nmethod = {{ constraint = \"{constraint}\" }}\n\
             bodies = [{{ radius = 1.0, centers = [[4.03, 1.1]], density = 1.5 }}]\n\
             lubrication = {{ model = \"{}\" }}\ntime = {{ end = 0.04, step = {step} }}\n",
            if constraint == "sharp" { "pairwise" } else { "none" }
        );
        let scene = Scene::parse("gap", Path::new("."), &text, &[]).unwrap();
        let mut simulation = Simulation::<2>::new(session, &scene).unwrap();
        while !simulation.over() {
            let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
            simulation.step(&observation, &mut |_, _| {}).unwrap();
        }
        -motion(&mut simulation).velocity[1]
    };
    let resolved = speed("fitted", 0.005);
    let [long, short, shortest] = [0.005, 0.001, 0.0002].map(|step| speed("sharp", step));
    assert!((long / short - 1.0).abs() < 0.01 && (shortest / short - 1.0).abs() < 0.003, "{long:e} {short:e} {shortest:e}");
    assert!((shortest / resolved - 1.0).abs() < 0.1, "{shortest:e} {resolved:e}");
}

fn fitted(setup: Setup<2>) -> Setup<2> {
    Setup { constraint: ConstraintMethod::Fitted, ..setup }
}

/// The settling disk again, on a mesh as coarse as any; in a smaller box, halved steps change the speed by a fourth.
fn a_fitted_mesh_follows_a_falling_disk_at_second_order(session: &Session) {
    let speed = |setup: Setup<2>, step: f64, end: f64| {
        let time = TimeSection { step: Step::Fixed(step), end, scheme: Scheme::TwoStep, travel: 0.1, error: 1e-3, until: None };
        let mut simulation = Simulation::flowing(session, flow_solver(session, fitted(setup)).unwrap(), time);
        while !simulation.over() {
            let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
            simulation.step(&observation, &mut |_, _| {}).unwrap();
        }
        -motion(&mut simulation).velocity[1]
    };
    let disk = |x: f64, y: f64| (free([x, y], 0.125, 3, Vector2::new(0.0, -245.0 * 0.125 * 0.125 * TAU / 2.0)), 1.25);
    let found = speed(setup(closed([2.0, 6.0]), 0.125 / 3.0, 0.1, vec![disk(1.0, 4.0)]), 0.005, 0.05);
    assert!((found / 2.679 - 1.0).abs() < 0.005, "{found}");
    let [one, two, four] =
        [1.0, 2.0, 4.0].map(|parts| speed(setup(closed([0.8, 0.8]), 0.125 / 3.0, 0.1, vec![disk(0.4, 0.5)]), 0.008 / parts, 0.04));
    let order = ((one - two) / (two - four)).log2();
    assert!((1.8..2.5).contains(&order), "order {order}: {one} {two} {four}");
}

/// Momentum, angular momentum and kinetic energy of the fluid on a mesh with its nodes elsewhere, over density.
fn moments(mesh: &Mesh, level: &MeshLevel) -> [f64; 4] {
    let mesh = Mesh { nodes: level.nodes.clone(), ..mesh.clone() };
    let mut sum = [0.0; 4];
    for triangle in &mesh.triangles {
        for sample in mesh.shape(triangle).samples().unwrap() {
            let velocity = sample.interpolate(&triangle.nodes, |node| level.velocities[node]);
            let parts = [velocity.x, velocity.y, sample.point.perp(&velocity), 0.5 * velocity.norm_squared()];
            sum.iter_mut().zip(parts).for_each(|(sum, part)| *sum += sample.weight * part);
        }
    }
    sum
}

/// A disk is led down in a closed box until a new mesh is made; a flow that goes on from the levels makes the same step.
fn a_new_mesh_has_the_momentum_of_the_old_one(session: &Session) {
    let flow = || {
        let disk = (free([0.4, 0.6], 0.1, 3, Vector2::new(0.0, -1.0)), 2.0);
        FittedFlow::new(session, fitted(setup(closed([0.8, 0.8]), 0.1 / 3.0, 0.1, vec![disk]))).unwrap()
    };
    let solve = |flow: &mut FittedFlow<2>, step: usize| {
        let centers = [Vector2::new(0.4, 0.6 - 0.02 * step as f64)];
        flow.solve_at(&configuration(&centers, 0.1 * step as f64), &mut |_, _| {}).unwrap().bodies[0].twist
    };
    let (mut whole, mut before, mut step) = (flow(), [0.0; 4], 0);
    while whole.cost().meshes < 2 {
        if let (Some(mesh), Some(level)) = (whole.mesh(), whole.history(f64::INFINITY).mesh_levels.first()) {
            before = moments(mesh, level);
        }
        solve(&mut whole, step);
        step += 1;
    }
    let after = moments(whole.mesh().unwrap(), whole.history(f64::INFINITY).mesh_levels[1]);
    assert!((3..20).contains(&step) && before[1] > 0.0, "{step} steps, {before:?}");
    // rounding; velocities interpolated at the nodes miss it by 6e-5 and more
    for moment in 0..3 {
        assert!((after[moment] - before[moment]).abs() < 1e-12 * before[1], "{before:?} and {after:?}");
    }
    // as the divergence on the new mesh has it, on this coarse one by 1.5e-3
    assert!((after[3] / before[3] - 1.0).abs() < 3e-3, "{before:?} and {after:?}");
    let mut resumed = flow();
    let past = whole.history(f64::INFINITY).past.unwrap();
    let last = Snapshot { fluid: None, multipliers: Vec::new(), centers: past.last.centers.clone(), mean_flow: Vec::new() };
    let past = Some(ExtrapolationHistory { time: past.time, last, earlier: None });
    let mesh_levels = whole.history(f64::INFINITY).mesh_levels.into_iter().cloned().collect();
    resumed.restore(History { past, levels: Vec::new(), mesh_levels }).unwrap();
    let (one, other) = (solve(&mut whole, step), solve(&mut resumed, step));
    assert!((one.velocity - other.velocity).norm() < 1e-10 * one.velocity.norm(), "{one:?} and {other:?}");
}

fn a_sphere_falls_straight_and_alike_with_either_inverse(session: &Session) {
    let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
    let speed = |inverse| {
        let domain = Domain { size: SVector::from([4.0, 4.0, 4.0]), axes: [Axis::Periodic, wall, Axis::Periodic] };
        let sphere = (free([2.03, 1.96, 2.11], 0.5, 2, SVector::from([0.0, 0.0, -3.0])), 2.0);
        let setup = Setup { inverse, ..setup(domain, 0.5 / 3.0, 0.1, vec![sphere]) };
        motion(&mut run(session, setup, 0.05, 0.25)).velocity
    };
    let (one, other) = (speed(InverseMethod::Hypre), speed(InverseMethod::Transform));
    assert!((one - other).norm() < 1e-5 * one.norm(), "{one} {other}");
    assert!(one[2] < 0.0 && one[0].abs() + one[1].abs() < 0.01 * one.norm(), "{one}");
}

const FIRST_ORDER: [ConstraintMethod; 3] =
    [ConstraintMethod::MeanValue(MultiplierSolver::Krylov), ConstraintMethod::Distributed, ConstraintMethod::Penalty(None)];

/// Parts by which velocity and spin may differ from those by `sharp`: measured, and a tenth more.
type Bounds = [[f64; 2]; 3];

/// A disk (four cells a radius), heavy and light, and a sphere (three) that start to fall and turn: bodies of mean values are too large, distributed ones
/// too small, by parts of a cell.
fn methods_of_first_order_move_bodies_about_as_sharp_does(session: &Session) {
    fn proof<const D: usize>(session: &Session, setup: &Setup<D>, step: f64, bounds: Bounds) {
        let found = |constraint| motion(&mut run(session, Setup { constraint, ..setup.clone() }, step, 5.0 * step));
        let sharp = found(ConstraintMethod::Sharp);
        for (method, [of_velocity, of_spin]) in FIRST_ORDER.into_iter().zip(bounds) {
            let other = found(method);
            let velocity = (other.velocity - sharp.velocity).norm() / sharp.velocity.norm();
            let spin = (other.spin - sharp.spin).norm() / sharp.spin.norm();
            assert!(velocity < of_velocity && spin < of_spin, "{}: {velocity} and {spin}", method.word());
        }
    }
    let turned = |(mut suspended, _): (SuspendedBody<2>, f64), density: f64| {
        let Motion::Free { torque, .. } = &mut suspended.body.motion else { unreachable!() };
        *torque = Matrix2::new(0.0, -0.2, 0.2, 0.0);
        (suspended, density)
    };
    let axes = [Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() }, Axis::Periodic];
    let of_disks: [(f64, Bounds); 2] =
        [(1.25, [[0.105, 0.22], [0.1, 0.195], [0.024, 0.006]]), (0.1, [[0.145, 0.29], [0.155, 0.36], [0.0413, 0.029]])];
    for (density, bounds) in of_disks {
        let channel = setup(Domain { size: Vector2::new(2.0, 2.0), axes }, 0.125 / 4.0, 0.1, vec![turned(disk_at(1.0, 1.2), density)]);
        proof(session, &channel, 0.0025, bounds);
    }
    let mut sphere = free([1.53, 1.46, 1.61], 0.5, 2, SVector::from([0.0, 0.0, -3.0]));
    let Motion::Free { torque, .. } = &mut sphere.body.motion else { unreachable!() };
    *torque = skew(&[0.0, 0.0, 0.5]);
    let domain = Domain {
        size: SVector::from([3.0, 3.0, 3.0]),
        axes: [Axis::Periodic, Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() }, Axis::Periodic],
    };
    proof(session, &setup(domain, 0.5 / 3.0, 0.1, vec![(sphere, 2.0)]), 0.05, [[0.165, 0.31], [0.147, 0.225], [0.0125, 0.037]]);
}

fn methods_of_first_order_solve_alike_with_either_inverse(session: &Session) {
    let axes = [Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() }, Axis::Periodic];
    let channel = setup(Domain { size: Vector2::new(1.0, 1.0), axes }, 0.125 / 3.0, 0.1, vec![disk_at(0.47, 0.6)]);
    for constraint in FIRST_ORDER {
        let [one, other] = [InverseMethod::Hypre, InverseMethod::Transform]
            .map(|inverse| motion(&mut run(session, Setup { inverse, constraint, ..channel.clone() }, 0.005, 0.015)));
        let (velocity, spin) = ((one.velocity - other.velocity).norm(), (one.spin - other.spin).norm() * 0.125);
        assert!(velocity.max(spin) < 1e-5 * other.velocity.norm(), "{}: {velocity:e} and {spin:e}", constraint.word());
    }
}

/// A disk a hundredth as heavy as the fluid, in steps in which viscosity reaches a twentieth of a cell, moves its added mass and, by mean values, a layer of
/// the grid besides.
fn light_disks_of_first_order_start_in_steps_of_any_length(session: &Session) {
    let axes = [Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() }, Axis::Periodic];
    let (volume, step) = (0.125 * 0.125 * TAU / 2.0, 2e-5);
    for constraint in FIRST_ORDER {
        let disk = (free([0.5, 0.5], 0.125, 4, Vector2::new(0.0, -100.0 * volume)), 0.01);
        let channel = Setup { constraint, ..setup(Domain { size: Vector2::new(1.0, 1.0), axes }, 0.125 / 4.0, 0.1, vec![disk]) };
        let speed = -motion(&mut run(session, channel, step, 20.0 * step)).velocity[1];
        let part = speed / (100.0 / 1.01 * 20.0 * step);
        assert!((0.65..1.1).contains(&part), "{}: {part} of the speed without viscosity", constraint.word());
    }
}

/// A scene of a flow with inertia in time.
fn scene(text: &str) -> Scene {
    Scene::parse("scene", Path::new("."), text, &[]).unwrap()
}

/// Without spin it is at rest in a frame in which the fluid is: on meshes and grids, whatever it weighs and however long a step is.
fn a_disk_that_goes_with_the_stream_goes_on_with_it(session: &Session) {
    for (method, cells, step, density) in
        [("fitted", 4, 0.02, 1.0), ("fitted", 4, 0.01, 2.0), ("fitted", 6, 0.02, 2.0), ("fitted", 6, 0.01, 1.0), ("sharp", 4, 0.02, 2.0)]
    {
        let scene = scene(&format!(
            "[domain]\nsize = [8.0, 8.0]\n[flow]\nmodel = \"navier-stokes\"\nviscosity = 0.05\ndensity = 1.0\n\
             drive = {{ mean_velocity = [1.0, 0.0] }}\n[resolution]\ncells_per_radius = {cells}\n[method]\nconstraint = \"{method}\"\n\
             [[bodies]]\nradius = 1.0\ncenters = [[4.1, 4.0]]\nvelocity = [1.0, 0.0]\ndensity = {density}\n\
             [time]\nend = {}\nstep = {step}\n",
            3.0 * step
        ));
        let mut simulation = Simulation::<2>::new(session, &scene).unwrap();
        while !simulation.over() {
            let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
            simulation.step(&observation, &mut |_, _| {}).unwrap();
        }
        let Twist { velocity, spin } = motion(&mut simulation);
        let lost = (velocity - Vector2::new(1.0, 0.0)).norm() + spin.norm();
        assert!(lost < 1e-6, "{method}, {cells} cells, steps of {step}, density {density}: {velocity}, {spin}");
    }
}

/// A fixed disk in a channel whose fluid moves at once, and more of a scene.
fn channel(end: f64, more: &str) -> Scene {
    scene(&format!(
        "[domain]\nsize = [6.0, 4.0]\ny = \"walls\"\n[flow]\nmodel = \"navier-stokes\"\nviscosity = 0.1\ndensity = 1.0\n\
         drive = {{ mean_velocity = [1.0, 0.0] }}\n[resolution]\ncells_per_radius = 4\n\
         [[bodies]]\nradius = 0.5\ncenters = [[3.0, 2.0]]\nmotion = \"fixed\"\n[time]\nend = {end}\n{more}"
    ))
}

/// Times, Courant numbers and drags of the first body, step by step, but for the start.
fn drags(session: &Session, scene: &Scene) -> Vec<[f64; 3]> {
    let mut simulation = Simulation::<2>::new(session, scene).unwrap();
    let mut observed = Vec::new();
    loop {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        let state = simulation.state();
        if state.steps > 0 {
            let courant = simulation.suspension().unwrap().evolution_on_grid().unwrap().courant(state.last_step).unwrap().unwrap();
            observed.push([state.time, courant, observation.solution.as_ref().unwrap().bodies[0].force[0]]);
        }
        if simulation.over() {
            return observed;
        }
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
}

/// The drag at t = 0.1 is 5.98 in steps of 0.005.
fn automatic_steps_from_rest_know_what_comes_and_not_the_end(session: &Session) {
    let runs = [0.1, 0.4].map(|end| drags(session, &channel(end, "")));
    let fixed = drags(session, &channel(0.1, "step = 0.005\n"));
    let (&[time, _, drag], &[_, _, exact]) = (runs[0].last().unwrap(), fixed.last().unwrap());
    assert!((time - 0.1).abs() < 1e-12 && (drag / exact - 1.0).abs() < 0.1, "{drag}, {exact}");
    let common = runs[0].len() - 1;
    assert!(common >= 2 && runs[0][..common] == runs[1][..common], "{runs:?}");
    assert!(runs.iter().flatten().all(|[_, courant, _]| *courant <= 0.7), "{runs:?}");
}

/// A second disk stands nearly still for a while and is then led through the channel ten times as fast as the stream, which only the flow that comes of
/// a step tells: its travel limits none.
fn an_automatic_step_is_taken_again_where_the_flow_is_faster_than_it_was(session: &Session) {
    let path = "[[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.301, 0.0005, 0.0], [0.35, 0.5, 0.0], [1.0, 7.0, 0.0]]";
    let second = format!("travel = 1.0\n[[bodies]]\nradius = 0.25\ncenters = [[1.0, 0.7]]\nmotion = {{ path = {path} }}\n");
    let observed = drags(session, &channel(0.36, &second));
    let steps: Vec<f64> = observed.windows(2).map(|pair| pair[1][0] - pair[0][0]).collect();
    assert!(steps.windows(2).any(|pair| pair[1] < 0.6 * pair[0]), "{steps:?}");
    assert!(observed.iter().all(|[_, courant, _]| *courant <= 0.7), "{observed:?}");
}

fn a_fixed_step_in_which_the_flow_passes_too_much_is_refused_with_one_that_will_do(session: &Session) {
    let mut simulation = Simulation::<2>::new(session, &channel(0.4, "step = 0.1\n")).unwrap();
    let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
    simulation.step(&observation, &mut |_, _| {}).unwrap();
    let refusal = simulation.evaluate(&mut |_, _| {}).err().unwrap().to_string();
    assert!(refusal.contains("time.step = 1.0000e-1") && refusal.contains("0.7"), "{refusal}");
    let step: f64 = refusal.split("set time.step = ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    let observed = drags(session, &channel(0.4, &format!("step = {step}\n")));
    assert!(observed.iter().all(|[_, courant, _]| *courant <= 0.7), "{refusal}");
}
