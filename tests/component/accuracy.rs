//! Settings that an accuracy chooses, and the bars that go with them, against known answers.

use std::{f64::consts::PI, path::Path};

use turbid::{
    error::Error,
    motion::Simulation,
    petsc::Session,
    plan::flow_solver,
    run::{EstimatedQuantity, Finished, Options, RefinementSequence, complete, refine_whole_runs},
    scene::Scene,
    setup::Setup,
    validation::{KnownScene, known_scenes, random_scene},
};

use crate::Test;

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::only_on(1, true_errors_lie_inside_their_bars_and_bars_inside_the_accuracy),
        Test::only_on(1, random_scenes_lie_inside_their_bars),
        Test::only_on(1, lattices_with_films_lie_inside_their_bars),
        Test::of(modes_are_chosen_by_what_they_bear),
        Test::of(spheres_with_films_have_a_mode_a_cell_and_disks_fewer),
        Test::of(a_tighter_accuracy_takes_a_finer_grid),
        Test::of(an_accuracy_out_of_reach_is_refused_with_the_error_that_was_reached),
        Test::only_on(1, a_steady_flow_with_inertia_lies_inside_its_bar),
        Test::only_on(1, a_disk_that_settles_lies_inside_its_bar),
        Test::of(a_flow_that_is_not_steady_at_the_end_has_no_accuracy),
        Test::only_on(1, the_drag_that_has_a_bar_is_that_of_forces_alone),
    ]
}

/// All scenes in 2D at two accuracies (`turbid validation --bars` takes those in 3D as well).
fn true_errors_lie_inside_their_bars_and_bars_inside_the_accuracy(session: &Session) {
    let (mut bars, mut honest) = (0, 0);
    for scene in known_scenes().iter().filter(|scene| scene.dimension().unwrap() == 2) {
        for accuracy in [1e-2, 3e-3] {
            let bar = scene.solve(session, accuracy).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
            assert!(bar.estimated <= accuracy, "{}: {:.1e} for {accuracy}", scene.name, bar.estimated);
            assert!(bar.error <= accuracy, "{}: off by {:.1e}, asked for {accuracy}", scene.name, bar.error);
            bars += 1;
            honest += usize::from(bar.error <= bar.estimated);
        }
    }
    assert!(bars >= 24 && 12 * honest >= 11 * bars, "only {honest} of {bars} bars hold the true error");
}

/// The first of the fifty that `turbid validation --bars --random 50` takes; `--random 20 --space` takes twenty lattices and random cells in 3D.
fn random_scenes_lie_inside_their_bars(session: &Session) {
    (1..=3).for_each(|seed| holds(session, &random_scene(session, seed).unwrap()));
}

/// Films out of reach once cost such lattices the modes that bear their drag, on all grids alike: 0.4 % were missing from bars of 0.3 %.
fn lattices_with_films_lie_inside_their_bars(session: &Session) {
    let lattices: Vec<KnownScene> = known_scenes().into_iter().filter(|scene| scene.name.contains("films")).collect();
    assert_eq!(lattices.len(), 4);
    lattices.iter().for_each(|lattice| holds(session, lattice));
}

fn holds(session: &Session, scene: &KnownScene) {
    let bar = scene.solve(session, 1e-2).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
    assert!(bar.error <= bar.estimated && bar.estimated <= 1e-2, "{}: {:.1e} {:.1e}", scene.name, bar.error, bar.estimated);
}

/// Films stand for relative motions of pairs: a fixed bed of spheres at 0.3 lacks 10 % of its drag with two modes at four cells, and 1 % with four.
fn spheres_with_films_have_a_mode_a_cell_and_disks_fewer(_: &Session) {
    let orders = |size: &str, center: &str, motion: &str, cells: f64| {
        let text = format!(
            "[domain]\nsize = {size}\n[flow]\ndrive = {{ shear_rate = 1.0 }}\n[resolution]\ncells_per_radius = {cells:?}\n\
             [method]\ninverse = \"transform\"\n[lubrication]\nmodel = \"pairwise\"\n[[bodies]]\nradius = 1.0\ncenters = [{center}]\n{motion}"
        );
        let scene = Scene::parse("modes", Path::new("."), &text, &[]).unwrap();
        match scene.dimension() {
            2 => Setup::<2>::of(&scene).unwrap().bodies[0].order,
            _ => Setup::<3>::of(&scene).unwrap().bodies[0].order,
        }
    };
    let spheres = [3.2, 4.0, 5.0, 6.0, 8.0].map(|cells| orders("[8.0, 8.0, 8.0]", "[1.3, 2.1, 3.3]", "", cells));
    assert_eq!(spheres, [4, 4, 5, 6, 8]);
    let disks = |motion: &str| [3.0, 4.0, 5.0, 6.0, 8.0].map(|cells| orders("[8.0, 8.0]", "[1.3, 2.1]", motion, cells));
    assert_eq!(disks(""), [3, 3, 3, 3, 4]);
    assert_eq!(disks("motion = \"fixed\""), [3, 4, 5, 6, 8]);
}

/// A body-centred cubic array at 0.3, whose drag four modes miss by 2 %: 12.667 times that of a lone sphere at 16 cells with ten modes.
fn modes_are_chosen_by_what_they_bear(session: &Session) {
    for (cells, films) in [(5, "pairwise"), (6, "none"), (6, "pairwise")] {
        let text = format!(
            "[domain]\nsize = [3.0337, 3.0337, 3.0337]\n[flow]\ndrive = {{ mean_velocity = [1.0, 0.0, 0.0] }}\n\
             [resolution]\ncells_per_radius = {cells}\n[method]\ninverse = \"transform\"\n[lubrication]\nmodel = \"{films}\"\n\
             [[bodies]]\nradius = 1.0\ncenters = [[0.7, 0.7, 0.7], [2.21685, 2.21685, 2.21685]]\nmotion = \"fixed\""
        );
        let scene = Scene::parse("array", Path::new("."), &text, &[]).unwrap();
        let solution = flow_solver(session, Setup::<3>::of(&scene).unwrap()).unwrap().solve(&mut |_, _| {}).unwrap();
        let drag = solution.bodies[0].force[0] / (6.0 * PI);
        assert!((drag / 12.667 - 1.0).abs() < 4e-3, "{cells} cells, {films}: {drag}");
    }
}

fn disk(accuracy: f64, more: &[&str]) -> Scene {
    let text = format!(
        "accuracy = {accuracy}\n[domain]\nsize = [1.0, 1.0]\n[flow]\ndrive = {{ mean_velocity = [1.0, 0.0] }}\n[method]\ninverse = \"auto\"\n\
         [[bodies]]\nradius = 0.3\ncenters = [[0.513, 0.527]]\nmotion = \"fixed\""
    );
    let more: Vec<String> = more.iter().map(|&change| change.to_owned()).collect();
    Scene::parse("disk", Path::new("."), &text, &more).unwrap()
}

fn a_tighter_accuracy_takes_a_finer_grid(session: &Session) {
    let cells = [0.3, 1e-2, 1e-3, 1e-4].map(|accuracy| {
        let (calibration, (suspension, _)) =
            RefinementSequence::<2>::begin(session, &disk(accuracy, &[])).unwrap().refine_until_met().unwrap();
        assert_eq!(calibration.levels.last().unwrap().grid_unknowns, suspension.cost().grid_unknowns);
        assert!(calibration.error(EstimatedQuantity::Drag).is_some_and(|error| error <= accuracy));
        assert!(calibration.error(EstimatedQuantity::Viscosity).is_none());
        calibration.cells_per_radius
    });
    assert!(cells.is_sorted() && cells[0] < cells[2] && cells[2] < cells[3], "{cells:?}");
}

/// Two disks a thousandth of a radius apart across a flow: what they feel takes more modes and cells than there are.
fn an_accuracy_out_of_reach_is_refused_with_the_error_that_was_reached(session: &Session) {
    let centers = "bodies.0.centers=[[0.3, 0.5], [0.7, 0.5]]";
    let scene = disk(1e-5, &["bodies.0.radius=0.1999", centers, "bodies.0.motion=fixed"]);
    let Err(Error::Refused(refusal)) = RefinementSequence::<2>::begin(session, &scene).unwrap().refine_until_met() else {
        panic!("not refused")
    };
    for part in ["disk.toml:1: accuracy = 0.00001: cannot be met", "drag is known to", "96 cells per radius", "ask for less"] {
        assert!(refusal.to_string().contains(part), "no {part:?} in {refusal}");
    }
}

/// The fixed disk of a square array at Re 20: 58.914 is the mean pressure gradient over viscosity, by spectral elements.
fn array(end: &str) -> Scene {
    let radius = (0.2 / PI).sqrt();
    let text = format!(
        "accuracy = 1e-2\ndomain.size = [1.0, 1.0]\n\
         flow = {{ model = \"navier-stokes\", viscosity = {:?}, density = 1.0, drive = {{ mean_velocity = [1.0, 0.0] }} }}\n\
         method.inverse = \"transform\"\nbodies = [{{ radius = {radius:?}, centers = [[0.521, 0.5104]], motion = \"fixed\" }}]\ntime.end = {end}\n",
        0.1 * radius
    );
    Scene::parse("array", Path::new("."), &text, &[]).unwrap()
}

fn a_steady_flow_with_inertia_lies_inside_its_bar(session: &Session) {
    let Finished { summary, .. } = complete::<2>(session, &array("4.0"), None, Options::default()).unwrap();
    let accuracy = summary.accuracy.unwrap();
    let estimated = accuracy.estimated.drag.unwrap();
    let found = summary.flow.unwrap().pressure_gradient[0].abs() / (0.1 * (0.2 / PI).sqrt());
    let error = (found / 58.914 - 1.0).abs();
    assert!(error <= estimated && estimated <= 1e-2, "{error:e} {estimated:e} on {:?}", accuracy.calibrated_on);
    assert!(accuracy.calibrated_on.len() >= 3 && accuracy.drag.is_some(), "{:?}", accuracy.calibrated_on);
}

/// The settling disk of Glowinski et al. (2001) up to t = 0.1, when a mesh that fits it has a speed of 4.0547.
fn a_disk_that_settles_lies_inside_its_bar(session: &Session) {
    let text = "accuracy = 2e-2\ngravity = [0.0, -980.0]\ndomain = { size = [2.0, 6.0], x = \"walls\", y = \"walls\" }\n\
                flow = { model = \"navier-stokes\", viscosity = 0.1, density = 1.0 }\n\
                bodies = [{ radius = 0.125, centers = [[1.0, 4.0]], density = 1.25 }]\ntime.end = 0.1\n";
    let scene = Scene::parse("settling", Path::new("."), text, &[]).unwrap();
    let calibration = refine_whole_runs::<2>(session, &scene).unwrap();
    let [estimate] = calibration.estimates[..] else { panic!("{:?}", calibration.estimates) };
    let mut simulation = Simulation::<2>::new(session, &calibration.resolved(&scene)).unwrap();
    let speed = loop {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        if simulation.over() {
            break -observation.twists[0].velocity[1];
        }
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    };
    let error = (speed / 4.0547 - 1.0).abs();
    assert!(
        estimate.quantity == EstimatedQuantity::Velocity && error <= estimate.error && estimate.error <= 2e-2,
        "{error:e} {estimate:?}"
    );
}

/// A disk held in a stream that turns as well: its bar is that of force and torque together.
fn the_drag_that_has_a_bar_is_that_of_forces_alone(session: &Session) {
    let text = "accuracy = 2e-2\ndomain.size = [1.0, 1.0]\nflow.drive = { mean_velocity = [1.0, 0.0] }\n\
                bodies = [{ radius = 0.2, centers = [[0.513, 0.527]], motion = { spin = 4.0 } }]\n";
    let scene = Scene::parse("turning", Path::new("."), text, &[]).unwrap();
    let Finished { summary, .. } = complete::<2>(session, &scene, None, Options::default()).unwrap();
    let (forces, accuracy) = (summary.forces.unwrap(), summary.accuracy.unwrap());
    let (force, torque) = (forces.mean[0].hypot(forces.mean[1]), forces.mean_torque.unwrap()[0].abs() / 0.2);
    let (drag, error) = (accuracy.drag.unwrap(), accuracy.estimated.drag.unwrap());
    // of one body the root mean square is the size; a disk alone has the torque 4 pi mu a^2 w
    assert!((drag.root_mean_square / force - 1.0).abs() < 1e-12 && torque > 4.0 * PI * 0.2 * 4.0, "{drag:?} {force} {torque}");
    assert!((drag.bar / (error * force.hypot(torque)) - 1.0).abs() < 1e-9, "{drag:?} {error}");
}

/// After a tenth of the time the drag still falls.
fn a_flow_that_is_not_steady_at_the_end_has_no_accuracy(session: &Session) {
    let Err(Error::Refused(refusal)) = refine_whole_runs::<2>(session, &array("0.2")) else { panic!("not refused") };
    for part in ["array.toml:1: accuracy = 0.01: is that of a steady flow", "time.end = 0.2", "set a later end"] {
        assert!(refusal.to_string().contains(part), "no {part:?} in {refusal}");
    }
}
