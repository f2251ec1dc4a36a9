//! The machine: Krylov solvers and multigrid.

use turbid::{
    error::{Error, Result},
    petsc::{
        Amg, AmgSettings, Krylov, KrylovMethod, KrylovSettings, Matrix, Preconditioner, PreconditionerKind, Report, Session, System, Vector,
    },
};

use crate::{
    Test,
    machine::{assembled, filled, share},
};

/// Unknowns of the systems.
const N: usize = 60;
/// Wanted of all solves.
const TOLERANCE: f64 = 1e-10;
const GMRES: KrylovMethod = KrylovMethod::Gmres { restart: 30 };

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(conjugate_gradients_and_gmres_solve_a_system_written_in_rust),
        Test::of(every_iteration_is_seen_and_reported),
        Test::of(a_good_preconditioner_saves_iterations),
        Test::of(a_zero_right_hand_side_has_a_zero_solution),
        Test::of(what_is_rounding_beside_the_scene_is_zero),
        Test::of(an_exhausted_space_makes_no_solution),
        Test::of(a_solve_goes_on_from_its_true_residual),
        Test::of(a_true_residual_that_stagnates_is_an_error),
        Test::of(singular_values_come_out_of_a_solve),
        Test::of(an_error_in_a_callback_ends_the_solve_with_that_very_error),
        Test::of(a_solver_serves_again_after_an_error),
        Test::of(too_few_iterations_are_an_error_that_names_residual_and_tolerance),
        Test::of(an_amg_cycle_reduces_the_residual_of_a_laplacian),
        Test::of(preconditioners_for_conjugate_gradients_are_symmetric),
    ]
}

fn conjugate_gradients_and_gmres_solve_a_system_written_in_rust(session: &Session) {
    for (method, skew) in [(KrylovMethod::ConjugateGradients, 0.0), (GMRES, 0.7)] {
        let mut system = Chain::new(session, skew);
        let solution = filled(session, N, |index| (index as f64).sin());
        let mut rhs = solution.like().unwrap();
        system.apply(&solution, &mut rhs).unwrap();
        let mut x = rhs.like().unwrap();
        let report = solve(session, method, &mut system, &rhs, &mut x).unwrap();
        let mut residual = rhs.like().unwrap();
        system.apply(&x, &mut residual).unwrap();
        residual.add(-1.0, &rhs).unwrap();
        // the residual reported is the true one, but for the rounding of the recurrence
        assert!(residual.norm().unwrap() <= 1.01 * TOLERANCE * rhs.norm().unwrap());
        assert!(report.iterations > 5 && report.residual <= TOLERANCE, "{report:?}");
        x.add(-1.0, &solution).unwrap();
        // the smallest singular value of the chain is about 1
        assert!(x.norm().unwrap() < 10.0 * TOLERANCE * rhs.norm().unwrap());
    }
}

fn every_iteration_is_seen_and_reported(session: &Session) {
    let mut system = Chain::new(session, 0.0);
    let (rhs, mut residuals) = (filled(session, N, |index| (index as f64).cos()), Vec::new());
    let mut krylov = krylov(session, GMRES, 100);
    let report =
        krylov.solve(&mut system, &rhs, &mut rhs.like().unwrap(), &mut |iteration, residual| residuals.push((iteration, residual)));
    let report = report.unwrap();
    assert!(residuals.iter().enumerate().all(|(count, &(iteration, _))| count == iteration));
    assert_eq!(residuals.len(), report.iterations + 1);
    assert!((residuals[0].1 - 1.0).abs() < 1e-14);
    assert!((residuals[report.iterations].1 / report.residual - 1.0).abs() < 1e-14);
    let mut x = rhs.like().unwrap();
    krylov.solve(&mut system, &rhs, &mut x, &mut |_, _| {}).unwrap();
    let warm = krylov.solve(&mut system, &rhs, &mut x, &mut |_, _| {}).unwrap();
    assert_eq!(warm.iterations, 0, "a solution is not improved");
}

fn a_good_preconditioner_saves_iterations(session: &Session) {
    // entries from 1 to 1e4 on the diagonal, which the preconditioner divides by
    let rhs = filled(session, N, |_| 1.0);
    for method in [KrylovMethod::ConjugateGradients, GMRES] {
        let mut system = Chain { uneven: true, ..Chain::new(session, 0.0) };
        let plain = solve(session, method, &mut system, &rhs, &mut rhs.like().unwrap()).unwrap();
        system.preconditioned = true;
        let divided = solve(session, method, &mut system, &rhs, &mut rhs.like().unwrap()).unwrap();
        assert!(2 * divided.iterations < plain.iterations, "{method:?}: {} and {}", divided.iterations, plain.iterations);
    }
}

fn a_zero_right_hand_side_has_a_zero_solution(session: &Session) {
    let (rhs, mut x) = (filled(session, N, |_| 0.0), filled(session, N, |_| 1.0));
    let report = solve(session, GMRES, &mut Chain::new(session, 0.0), &rhs, &mut x).unwrap();
    assert_eq!((report, x.norm().unwrap()), (Report::default(), 0.0));
}

fn what_is_rounding_beside_the_scene_is_zero(session: &Session) {
    let (rhs, mut x) = (filled(session, N, |index| 1e-15 * (index as f64).cos()), filled(session, N, |_| 1.0));
    let mut krylov = krylov(session, GMRES, 100);
    let report = krylov.solve_above(1e-13, &mut Chain::new(session, 0.0), &rhs, &mut x, &mut |_, _| {}).unwrap();
    assert_eq!((report.iterations, x.norm().unwrap()), (0, 0.0));
    assert!(report.residual > 0.0 && report.residual <= TOLERANCE);
    // what stands out of it is solved, but not below it
    let rhs = filled(session, N, |index| 1e-12 * (index as f64).cos());
    let report = krylov.solve_above(1e-13, &mut Chain::new(session, 0.0), &rhs, &mut x, &mut |_, _| {}).unwrap();
    assert!((1..6).contains(&report.iterations), "{report:?}");
}

/// The last row has no entry, and a load: after three vectors nothing is left to try, which is no solution, however small the load is.
fn an_exhausted_space_makes_no_solution(session: &Session) {
    let range = share(session, N);
    let entry = |index: usize| if index + 1 < N { 1.0 + (index % 2) as f64 } else { 0.0 };
    for load in [1.0, 1e-17] {
        let (rhs, mut system) = (filled(session, N, |_| load), Diagonal(range.clone().map(entry).collect()));
        let error = solve(session, GMRES, &mut system, &rhs, &mut rhs.like().unwrap()).unwrap_err();
        assert!(matches!(&error, Error::Diverged(text) if text.contains("tolerance")), "load {load:e}: {error}");
    }
}

/// A preconditioner that is not quite linear leads the solver's estimate astray, the farther the more it wavers.
fn a_solve_goes_on_from_its_true_residual(session: &Session) {
    let (rhs, mut again) = (filled(session, N, |index| (index as f64).cos()), 0);
    for step in 0..24 {
        let part = if step > 0 { 1e-11 * 1.5f64.powi(step) } else { 0.0 };
        let mut system = Wavering { preconditioner: part, ..Wavering::new(session) };
        let mut x = rhs.like().unwrap();
        let report = solve(session, GMRES, &mut system, &rhs, &mut x).unwrap();
        let mut residual = rhs.like().unwrap();
        system.chain.apply(&x, &mut residual).unwrap();
        residual.add(-1.0, &rhs).unwrap();
        assert!(residual.norm().unwrap() <= TOLERANCE * rhs.norm().unwrap(), "step {step}");
        assert!(report.residual <= TOLERANCE, "step {step}: {report:?}");
        // each iteration takes one application, and so does the true residual; a solve that goes on takes two more
        let more = system.applied - report.iterations - 1;
        assert!(step > 0 || more == 0, "a solve that has converged goes on: {} applications, {report:?}", system.applied);
        again += usize::from(more > 0);
    }
    assert!(again > 0, "no estimate was wrong");
}

fn a_true_residual_that_stagnates_is_an_error(session: &Session) {
    let rhs = filled(session, N, |index| (index as f64).cos());
    let mut system = Wavering { operator: 1e-9, ..Wavering::new(session) };
    let error = solve(session, GMRES, &mut system, &rhs, &mut rhs.like().unwrap()).unwrap_err();
    assert!(matches!(&error, Error::Diverged(text) if text.contains("stagnates")), "{error}");
    // a residual that falls, but too slowly, is given up as well
    assert!(system.applied < 4 * 30, "{} applications", system.applied);
}

fn singular_values_come_out_of_a_solve(session: &Session) {
    let (rhs, range) = (filled(session, N, |_| 1.0), share(session, N));
    let mut system = Diagonal((0..N).map(|index| 1.0 + index as f64 / 10.0).skip(range.start).take(range.len()).collect());
    let mut krylov = krylov(session, GMRES, 100);
    krylov.keep_singular_values().unwrap();
    krylov.solve(&mut system, &rhs, &mut rhs.like().unwrap(), &mut |_, _| {}).unwrap();
    let (largest, smallest) = krylov.extreme_singular_values().unwrap();
    // Ritz values reach the ends of the spectrum from inside; a solve to 1e-10 finds them to a per cent
    assert!((largest / (1.0 + (N - 1) as f64 / 10.0) - 1.0).abs() < 0.01, "{largest}");
    assert!((smallest - 1.0).abs() < 0.01, "{smallest}");
}

fn an_error_in_a_callback_ends_the_solve_with_that_very_error(session: &Session) {
    for (apply, precondition) in [(4, usize::MAX), (usize::MAX, 4)] {
        for method in [KrylovMethod::ConjugateGradients, GMRES] {
            let rhs = filled(session, N, |index| (index as f64).cos());
            let mut system = Faulty { chain: Chain::new(session, 0.0), left: [apply, precondition] };
            let error = solve(session, method, &mut system, &rhs, &mut rhs.like().unwrap()).unwrap_err();
            assert!(matches!(&error, Error::Refused(text) if text.remedy == "the fifth is one too many"), "{error:?}");
        }
    }
}

fn a_solver_serves_again_after_an_error(session: &Session) {
    let (rhs, mut krylov) = (filled(session, N, |index| (index as f64).cos()), krylov(session, GMRES, 100));
    let mut faulty = Faulty { chain: Chain::new(session, 0.0), left: [4, usize::MAX] };
    krylov.solve(&mut faulty, &rhs, &mut rhs.like().unwrap(), &mut |_, _| {}).unwrap_err();
    let report = krylov.solve(&mut Chain::new(session, 0.0), &rhs, &mut rhs.like().unwrap(), &mut |_, _| {}).unwrap();
    assert!(report.residual <= TOLERANCE);
    // the old error is not told twice
    let mut wrong = Vector::new(session, N + 3).unwrap();
    assert!(matches!(wrong.copy_from(&rhs), Err(Error::Petsc { .. })));
}

fn too_few_iterations_are_an_error_that_names_residual_and_tolerance(session: &Session) {
    let rhs = filled(session, N, |index| (index as f64).cos());
    let mut last = 0.0;
    let mut krylov = krylov(session, GMRES, 3);
    let mut see = |_: usize, residual: f64| last = residual;
    let error = krylov.solve(&mut Chain::new(session, 0.0), &rhs, &mut rhs.like().unwrap(), &mut see).unwrap_err();
    let text = error.to_string();
    assert!(matches!(error, Error::Diverged(_)), "{text}");
    for part in ["3 iterations", &format!("residual of {last:.1e}"), &format!("tolerance {TOLERANCE:.1e}")] {
        assert!(text.contains(part), "{text:?} lacks {part:?}");
    }
}

fn an_amg_cycle_reduces_the_residual_of_a_laplacian(session: &Session) {
    for singular in [false, true] {
        let matrix = laplacian(session, 24, singular);
        let amg = Amg::new(&matrix, singular, &AmgSettings::laplacian(2)).unwrap();
        let mut residual = filled(session, 24 * 24, |index| ((index * index) as f64).sin());
        residual.remove_mean().unwrap();
        let (mut correction, mut change) = (residual.like().unwrap(), residual.like().unwrap());
        for _ in 0..4 {
            let before = residual.norm().unwrap();
            amg.apply(&residual, &mut correction).unwrap();
            matrix.multiply(&correction, &mut change).unwrap();
            residual.add(-1.0, &change).unwrap();
            // a V-cycle on a small Laplacian is known to gain about a factor of ten
            assert!(residual.norm().unwrap() < 0.3 * before);
            assert!(!singular || correction.mean().unwrap().abs() < 1e-12);
        }
    }
}

fn preconditioners_for_conjugate_gradients_are_symmetric(session: &Session) {
    let matrix = laplacian(session, 24, false);
    let one = filled(session, 24 * 24, |index| ((index * index) as f64).sin());
    let other = filled(session, 24 * 24, |index| (index as f64).cos());
    let amg = Amg::new(&matrix, false, &AmgSettings::laplacian(2).symmetric()).unwrap();
    symmetric_and_positive((&one, &other), |input, output| amg.apply(input, output));
    for kind in [PreconditionerKind::Jacobi, PreconditionerKind::IncompleteCholesky, PreconditionerKind::BoomerAmg] {
        let preconditioner = Preconditioner::new(&matrix, kind).unwrap();
        symmetric_and_positive((&one, &other), |input, output| preconditioner.apply(input, output));
    }
}

fn symmetric_and_positive((one, other): (&Vector, &Vector), apply: impl Fn(&Vector, &mut Vector) -> Result<()>) {
    let (mut of_one, mut of_other) = (one.like().unwrap(), one.like().unwrap());
    apply(one, &mut of_one).unwrap();
    apply(other, &mut of_other).unwrap();
    let (there, back) = (of_one.dot(other).unwrap(), one.dot(&of_other).unwrap());
    let scale = of_one.dot(one).unwrap();
    assert!(scale > 0.0);
    assert!((there - back).abs() < 1e-10 * scale, "{there} and {back}");
}

/// A periodic chain: `3 + scale` on the diagonal, `-1 -+ skew` beside it.
struct Chain {
    matrix: [Matrix; 2],
    uneven: bool,
    preconditioned: bool,
}

impl Chain {
    fn new(session: &Session, skew: f64) -> Chain {
        let even = assembled(session, (N, N), |row| vec![(row, 3.0), ((row + 1) % N, -1.0 - skew), ((row + N - 1) % N, -1.0 + skew)]);
        let uneven = assembled(session, (N, N), |row| vec![(row, scale(row)), ((row + 1) % N, -0.1), ((row + N - 1) % N, -0.1)]);
        Chain { matrix: [even, uneven], uneven: false, preconditioned: false }
    }
}

fn scale(row: usize) -> f64 {
    10f64.powf(4.0 * row as f64 / N as f64)
}

impl System for Chain {
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        self.matrix[usize::from(self.uneven)].multiply(input, output)
    }

    fn precondition(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        output.copy_from(input)?;
        if self.preconditioned {
            let range = share(input.session(), N);
            output.local_mut()?.iter_mut().zip(range).for_each(|(value, row)| *value /= scale(row));
        }
        Ok(())
    }
}

/// A diagonal matrix by its local part.
struct Diagonal(Vec<f64>);

impl System for Diagonal {
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        output.copy_from(input)?;
        output.local_mut()?.iter_mut().zip(&self.0).for_each(|(value, entry)| *value *= entry);
        Ok(())
    }
}

/// A chain whose maps differ from call to call by these parts of themselves, as rounding would have it.
struct Wavering {
    chain: Chain,
    preconditioner: f64,
    operator: f64,
    applied: usize,
    preconditioned: usize,
}

impl Wavering {
    fn new(session: &Session) -> Wavering {
        Wavering { chain: Chain::new(session, 0.0), preconditioner: 0.0, operator: 0.0, applied: 0, preconditioned: 0 }
    }
}

/// Scales entries by factors that differ from one by up to `part`, differently for every `call`.
fn waver(part: f64, call: usize, vector: &mut Vector) -> Result<()> {
    let range = share(vector.session(), N);
    let factor = |row: usize| 1.0 + part * ((1 + row * row + 7 * call * row) as f64).sin();
    vector.local_mut()?.iter_mut().zip(range).for_each(|(value, row)| *value *= factor(row));
    Ok(())
}

impl System for Wavering {
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        self.applied += 1;
        self.chain.apply(input, output)?;
        waver(self.operator, self.applied, output)
    }

    fn precondition(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        self.preconditioned += 1;
        self.chain.precondition(input, output)?;
        waver(self.preconditioner, self.preconditioned, output)
    }
}

/// A system whose two maps work only so many times.
struct Faulty {
    chain: Chain,
    left: [usize; 2],
}

impl Faulty {
    fn count(&mut self, map: usize) -> Result<()> {
        let left = self.left[map].checked_sub(1);
        self.left[map] = left.ok_or_else(|| Error::refused("the fifth is one too many"))?;
        Ok(())
    }
}

impl System for Faulty {
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        self.count(0)?;
        self.chain.apply(input, output)
    }

    fn precondition(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        self.count(1)?;
        self.chain.precondition(input, output)
    }
}

fn krylov(session: &Session, method: KrylovMethod, most_iterations: usize) -> Krylov {
    let settings = KrylovSettings { method, tolerance: TOLERANCE, most_iterations };
    Krylov::new(session, share(session, N).len(), c"test_", settings).unwrap()
}

fn solve(session: &Session, method: KrylovMethod, system: &mut dyn System, rhs: &Vector, x: &mut Vector) -> Result<Report> {
    krylov(session, method, 1000).solve(system, rhs, x, &mut |_, _| {})
}

/// The 5-point Laplacian of a square of unit cells, with values or (`singular`) fluxes given on its sides.
fn laplacian(session: &Session, side: usize, singular: bool) -> Matrix {
    assembled(session, (side * side, side * side), |row| {
        let (x, y) = (row % side, row / side);
        let inside = [(x > 0, row.wrapping_sub(1)), (x + 1 < side, row + 1), (y > 0, row.wrapping_sub(side)), (y + 1 < side, row + side)];
        let mut entries: Vec<(usize, f64)> = inside.iter().filter(|(inside, _)| *inside).map(|&(_, column)| (column, -1.0)).collect();
        entries.push((row, if singular { entries.len() as f64 } else { 4.0 }));
        entries
    })
}
