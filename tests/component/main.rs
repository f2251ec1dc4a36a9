//! Component tests of the lower floors, on 1, 2 and 3 ranks: `mpirun -n 3 component [part of a name]`.
//!
//! A few that take long and say nothing about ranks run on one number of them only, unless they are named; a file (`friction::`) names none.
//! `component --share=1/2` runs every second test, `component --share=2/2` the others: two processes of one rank each fill two cores.
//!
//! `component panic-on-last-rank` does just that; all ranks must stop with a non-zero code.
//! `component caller-with-mpi` is a program that has started MPI before.
//!
//! One session serves all tests, and all ranks run each test together. An assertion that fails on any rank stops them all.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod accuracy;
mod axes;
mod caller;
mod chains;
mod clusters;
mod conformance;
mod contact;
mod convergence;
mod crowds;
mod drives;
mod dry;
mod dry_cells;
mod dry_clusters;
mod effects;
mod energy;
mod expressions;
mod fields;
mod files;
mod fitted;
mod fitted_scalar;
mod fluid;
mod friction;
mod friction_by_law;
mod friction_by_law_in_flow;
mod friction_in_flow;
mod friction_of_tied;
mod friction_pairs;
mod friction_turning_in_flow;
mod friction_with_all;
mod grid;
mod halves;
mod hard;
mod impacts;
mod inclusions;
mod inertia;
mod interpolation;
mod inverses;
mod laws;
mod laws_flow;
mod lubrication;
mod machine;
mod methods;
mod momentum;
mod motion;
mod near;
mod objects;
mod objects_resumed;
mod of_ones_own;
mod outputs;
mod ownership;
mod packing;
mod pressed;
mod protocols;
mod scalar;
mod shapes;
mod sheared;
mod solvers;
mod steps;
mod stress;
mod suspension;
mod transform;
mod units;
mod vorticity;

use std::time::Instant;

use turbid::{parallel::abort_on_panic, petsc::Session};

/// A test: the sentence that it proves, and the proof.
pub struct Test {
    name: &'static str,
    run: Box<dyn Fn(&Session)>,
    /// The only number of ranks on which it runs if it is not named.
    ranks: Option<usize>,
}

impl Test {
    /// The test that is named as its function is.
    pub fn of<F: Fn(&Session) + 'static>(run: F) -> Test {
        let path = std::any::type_name::<F>();
        Test { name: path.strip_prefix("component::").unwrap_or(path), run: Box::new(run), ranks: None }
    }

    /// The test on this number of ranks only: what it says does not depend on them, and other tests say it of less on any number.
    pub fn only_on<F: Fn(&Session) + 'static>(ranks: usize, run: F) -> Test {
        Test { ranks: Some(ranks), ..Test::of(run) }
    }
}

/// The share of the tests that is asked for: which, and of how many.
fn share() -> (usize, usize) {
    let asked = std::env::args().find_map(|argument| argument.strip_prefix("--share=").map(str::to_owned));
    let Some((place, count)) = asked.as_deref().map(|asked| asked.split_once('/').unwrap()) else { return (0, 1) };
    (place.parse::<usize>().unwrap() - 1, count.parse().unwrap())
}

fn main() {
    if std::env::args().any(|argument| argument == "caller-with-mpi") {
        return caller::parts_of_the_ranks_solve_on_their_own();
    }
    let session = Session::start(&[]).unwrap();
    abort_on_panic();
    let wanted: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    assert!(!(wanted == ["panic-on-last-rank"] && session.world().rank() + 1 == session.world().size()), "as asked");
    if wanted == ["panic-on-last-rank"] {
        session.world().barrier();
    }
    let say = |text: String| {
        if session.world().rank() == 0 {
            println!("{text}");
        }
    };
    say(format!("{} ranks", session.world().size()));
    let mut passed = 0;
    let floors = [
        machine::tests(),
        methods::tests(),
        convergence::tests(),
        crowds::tests(),
        solvers::tests(),
        steps::tests(),
        grid::tests(),
        halves::tests(),
        interpolation::tests(),
        fluid::tests(),
        friction::tests(),
        friction_by_law::tests(),
        friction_by_law_in_flow::tests(),
        friction_in_flow::tests(),
        friction_of_tied::tests(),
        friction_pairs::tests(),
        friction_turning_in_flow::tests(),
        friction_with_all::tests(),
        transform::tests(),
        units::tests(),
        near::tests(),
        of_ones_own::tests(),
        objects::tests(),
        objects_resumed::tests(),
        outputs::tests(),
        ownership::tests(),
        packing::tests(),
        pressed::tests(),
        conformance::tests(),
        scalar::tests(),
        inclusions::tests(),
        impacts::tests(),
        inertia::tests(),
        energy::tests(),
        expressions::tests(),
        suspension::tests(),
        stress::tests(),
        fitted::tests(),
        fitted_scalar::tests(),
        inverses::tests(),
        effects::tests(),
        accuracy::tests(),
        axes::tests(),
        chains::tests(),
        clusters::tests(),
        lubrication::tests(),
        hard::tests(),
        files::tests(),
        momentum::tests(),
        motion::tests(),
        protocols::tests(),
        drives::tests(),
        shapes::tests(),
        sheared::tests(),
        vorticity::tests(),
        contact::tests(),
        dry::tests(),
        dry_cells::tests(),
        dry_clusters::tests(),
        laws::tests(),
        laws_flow::tests(),
    ];
    let (place, count) = share();
    let ranks = session.world().size();
    let fits = |test: &Test| test.ranks.is_none_or(|only| only == ranks);
    let runs = |test: &Test| match &wanted[..] {
        [] => fits(test),
        parts => parts.iter().any(|part| test.name.contains(part) && (fits(test) || !part.ends_with("::"))),
    };
    for test in floors.into_iter().flatten().filter(runs).skip(place).step_by(count) {
        let start = Instant::now();
        (test.run)(&session);
        session.world().barrier();
        say(format!("test {} ... ok, {:.2} s", test.name, start.elapsed().as_secs_f64()));
        passed += 1;
    }
    say(format!("{passed} passed, 0 failed"));
}
