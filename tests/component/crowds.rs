//! Crowds with many films: iterations that depend neither on the gap nor on the number of bodies, by both inverses, on any number of ranks.

use std::path::Path;

use turbid::{petsc::Session, plan::flow_solver, scene::Scene, setup::Setup};

use crate::Test;

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(thinner_films_take_no_more_iterations),
        Test::of(more_disks_take_few_more_iterations),
        Test::of(disks_of_two_sizes_take_few_iterations),
        Test::of(disks_between_walls_take_few_iterations),
        Test::of(many_spheres_are_solved_loosely_inside_a_flexible_method),
    ]
}

/// A periodic crowd in shear.
fn dense_suspension(dimension: u32, (count, fraction, gap): (usize, f64, f64), inverse: &str) -> String {
    let volume = if dimension == 2 { std::f64::consts::PI } else { 4.0 / 3.0 * std::f64::consts::PI };
    let side = (count as f64 * volume / fraction).powf(1.0 / f64::from(dimension));
    let (size, cells) = (vec![side.to_string(); dimension as usize].join(", "), if dimension == 2 { 5 } else { 4 });
    text(&size, "", cells, &format!("[[bodies]]\nradius = 1.0\ncount = {count}\ngap = {gap}\n"), inverse)
}

fn text(size: &str, walls: &str, cells: usize, bodies: &str, inverse: &str) -> String {
    let drive = if walls.is_empty() { "[flow]\ndrive = { shear_rate = 1.0 }\n" } else { "" };
    format!(
        "[domain]\nsize = [{size}]\n{walls}\n{drive}[resolution]\ncells_per_radius = {cells}\nmodes = {}\n\
         [method]\ninverse = \"{inverse}\"\ntolerance = 1e-6\n{bodies}[lubrication]\nmodel = \"pairwise\"\n",
        if cells == 4 { 2 } else { 3 }
    )
}

fn iterations<const D: usize>(session: &Session, text: &str) -> usize {
    let scene = Scene::parse("crowd", Path::new("."), text, &[]).unwrap();
    let mut suspension = flow_solver(session, Setup::<D>::of(&scene).unwrap()).unwrap();
    suspension.solve(&mut |_, _| ()).unwrap().cost.krylov.iterations
}

/// Measured: 16 and 18 for disks by transforms, 46 and 58 by multigrid, 12 and 14 for spheres.
fn thinner_films_take_no_more_iterations(session: &Session) {
    for inverse in ["transform", "hypre"] {
        let [wide, thin] = [0.1, 1e-4].map(|gap| iterations::<2>(session, &dense_suspension(2, (60, 0.5, gap), inverse)));
        assert!(thin <= 2 * wide && thin <= if inverse == "hypre" { 60 } else { 30 }, "disks, {inverse}: {wide} and {thin}");
    }
    let [wide, thin] = [0.1, 1e-4].map(|gap| iterations::<3>(session, &dense_suspension(3, (20, 0.3, gap), "transform")));
    assert!(thin <= 2 * wide && thin <= 30, "spheres: {wide} and {thin}");
}

fn more_disks_take_few_more_iterations(session: &Session) {
    let [few, many] = [100, 800].map(|count| iterations::<2>(session, &dense_suspension(2, (count, 0.5, 0.01), "transform")));
    assert!(many as f64 <= 1.3 * few as f64 && many <= 30, "{few} and {many}");
}

fn disks_of_two_sizes_take_few_iterations(session: &Session) {
    let bodies = "[[bodies]]\nradius = 1.0\ncount = 30\ngap = 0.01\n[[bodies]]\nradius = 1.5\ncount = 30\ngap = 0.01\n";
    let found = iterations::<2>(session, &text("21.7, 21.7", "", 5, bodies, "transform"));
    assert!(found <= 35, "{found}");
}

fn disks_between_walls_take_few_iterations(session: &Session) {
    let walls = "y = { lower = [-1.0, 0.0], upper = [1.0, 0.0] }";
    let bodies = "[[bodies]]\nradius = 1.0\ncount = 40\ngap = 0.01\n";
    let found = iterations::<2>(session, &text("21.0, 12.0", walls, 5, bodies, "transform"));
    assert!(found <= 60, "{found}");
}

fn many_spheres_are_solved_loosely_inside_a_flexible_method(session: &Session) {
    let found = iterations::<3>(session, &dense_suspension(3, (510, 0.4, 0.01), "transform"));
    assert!(found <= 40, "{found}");
}
