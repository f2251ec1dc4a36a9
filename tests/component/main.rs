//! Component tests of the lower floors, alike on 1, 2 and 3 ranks: `mpirun -n 3 component [part of a name]`.
//!
//! `component panic-on-last-rank` does just that; all ranks must stop with a non-zero code.
//!
//! One session serves all tests, and all ranks run each test together. An assertion that fails on any rank stops them all.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod accuracy;
mod axes;
mod contact;
mod convergence;
mod crowds;
mod dry;
mod effects;
mod fields;
mod fitted;
mod fitted_scalar;
mod fluid;
mod grid;
mod hard;
mod inclusions;
mod interpolation;
mod inverses;
mod lasting;
mod laws;
mod laws_flow;
mod lubrication;
mod machine;
mod methods;
mod motion;
mod near;
mod outputs;
mod parts;
mod scalar;
mod sheared;
mod solvers;
mod stress;
mod suspension;
mod transform;

use turbid::{parallel::abort_on_panic, petsc::Session};

/// A test: the sentence that it proves, and the proof.
pub struct Test {
    name: &'static str,
    run: Box<dyn Fn(&Session)>,
}

impl Test {
    /// The test that is named as its function is.
    pub fn of<F: Fn(&Session) + 'static>(run: F) -> Test {
        let path = std::any::type_name::<F>();
        Test { name: path.strip_prefix("component::").unwrap_or(path), run: Box::new(run) }
    }
}

fn main() {
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
        grid::tests(),
        interpolation::tests(),
        fluid::tests(),
        transform::tests(),
        near::tests(),
        outputs::tests(),
        parts::tests(),
        scalar::tests(),
        inclusions::tests(),
        suspension::tests(),
        stress::tests(),
        fitted::tests(),
        fitted_scalar::tests(),
        inverses::tests(),
        effects::tests(),
        accuracy::tests(),
        axes::tests(),
        lubrication::tests(),
        hard::tests(),
        lasting::tests(),
        motion::tests(),
        sheared::tests(),
        contact::tests(),
        dry::tests(),
        laws::tests(),
        laws_flow::tests(),
    ];
    for test in floors.into_iter().flatten() {
        if wanted.is_empty() || wanted.iter().any(|part| test.name.contains(part)) {
            (test.run)(&session);
            session.world().barrier();
            say(format!("test {} ... ok", test.name));
            passed += 1;
        }
    }
    say(format!("{passed} passed, 0 failed"));
}
