//! What each inverse of the fluid costs, scene by scene: a table made of real runs.

use std::{
    fs,
    path::{Path, PathBuf},
};

use serde::Deserialize;

use super::launcher::{Job, Launcher, Scratch, WITHOUT_PICTURE};
use crate::{
    error::{Error, Result},
    flow::InverseMethod,
    output::{prepare_folder, say},
    scene::Scene,
    simulation::Setup,
};

/// What to run.
#[derive(Debug, Clone)]
pub struct InverseOptions {
    /// Scene files.
    pub scenes: Vec<PathBuf>,
    /// What is set in each.
    pub overrides: Vec<String>,
    /// Rank counts.
    pub ranks: Vec<usize>,
    /// Command line that starts a run, with `{ranks}` in it.
    pub launcher: String,
    /// Runs of each, of which the fastest counts.
    pub repeat: usize,
    /// Options for PETSc.
    pub petsc: Vec<String>,
}

/// What a run tells of its cost.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cost {
    unknowns: usize,
    /// Of the instant, or the mean of all solves.
    iterations: f64,
    /// Everything of an instant, or a step.
    seconds: f64,
    memory_bytes: f64,
}

#[derive(Deserialize)]
struct Summary {
    steps: usize,
    solver: Solver,
    motion: Option<Motion>,
}

#[derive(Deserialize)]
struct Solver {
    grid_unknowns: usize,
    multiplier_unknowns: usize,
    iterations: usize,
    setup_seconds: f64,
    assembly_seconds: f64,
    solve_seconds: f64,
    peak_memory_bytes: f64,
}

#[derive(Deserialize)]
struct Motion {
    solves: usize,
    iterations: usize,
    seconds: f64,
}

/// Runs all scenes with all inverses that suit them and prints a table; to be called outside of MPI.
///
/// # Errors
/// A scene or the launcher cannot be used, or a run fails.
pub fn inverses(options: &InverseOptions) -> Result<()> {
    let launcher = Launcher::new(&options.launcher, &options.petsc)?;
    let scenes = options.scenes.iter().map(|path| Scene::read(path, &options.overrides)).collect::<Result<Vec<_>>>()?;
    let methods = scenes.iter().map(methods).collect::<Result<Vec<_>>>()?;
    let folder = Path::new("out");
    prepare_folder(folder)?;
    let scratch = Scratch::within(folder)?;
    say("| scene | unknowns | ranks | iterations: transform / hypre | seconds: transform / hypre | ratio | MB: transform / hypre |")?;
    say("|-|-|-|-|-|-|-|")?;
    for ((path, scene), methods) in options.scenes.iter().zip(&scenes).zip(methods) {
        for &ranks in &options.ranks {
            let cost = |method: &InverseMethod| options.measure(&launcher, &scratch.0.join("out"), (path, *method), ranks);
            let costs = methods.iter().map(cost).collect::<Result<Vec<_>>>()?;
            say(&row(&path.display().to_string(), ranks, &costs))?;
        }
        if scene.time.is_some() {
            say("| (a scene in time: mean iterations of a solve, seconds of a step) | | | | | | |")?;
        }
    }
    Ok(())
}

/// The inverses that suit a scene, the general one last.
fn methods(scene: &Scene) -> Result<Vec<InverseMethod>> {
    if scene.dry() {
        return Err(scene.refuse("flow.model", "\"none\"", "a dry scene has no fluid to invert; choose a scene with a flow"));
    }
    let fastest = match scene.dimension() {
        2 => InverseMethod::fastest(&Setup::<2>::of(scene)?.domain),
        _ => InverseMethod::fastest(&Setup::<3>::of(scene)?.domain),
    };
    Ok(if fastest == InverseMethod::Hypre { vec![fastest] } else { vec![fastest, InverseMethod::Hypre] })
}

impl InverseOptions {
    fn measure(&self, launcher: &Launcher, folder: &Path, (scene, method): (&Path, InverseMethod), ranks: usize) -> Result<Cost> {
        let mut overrides = self.overrides.clone();
        overrides.extend([format!("method.inverse={}", method.word()), WITHOUT_PICTURE.to_owned()]);
        launcher.measure((ranks, self.repeat), &Job { scene, overrides: &overrides, folder }, Cost::read, |cost| cost.seconds)
    }
}

impl Cost {
    fn read(path: &Path) -> Result<Cost> {
        let unreadable = |source| Error::File { path: path.to_owned(), source };
        let text = fs::read_to_string(path).map_err(unreadable)?;
        Ok(Cost::of(&serde_json::from_str(&text).map_err(|error| unreadable(error.into()))?))
    }

    fn of(Summary { steps, solver, motion }: &Summary) -> Cost {
        let (iterations, seconds) = match motion {
            Some(motion) => (motion.iterations as f64 / motion.solves.max(1) as f64, motion.seconds / (*steps).max(1) as f64),
            None => (solver.iterations as f64, solver.setup_seconds + solver.assembly_seconds + solver.solve_seconds),
        };
        let unknowns = solver.grid_unknowns + solver.multiplier_unknowns;
        Cost { unknowns, iterations, seconds, memory_bytes: solver.peak_memory_bytes }
    }
}

/// A row of the table for the costs with the fastest inverse and, if that is another one, with multigrid.
fn row(name: &str, ranks: usize, costs: &[Cost]) -> String {
    let unknowns = costs.first().map_or(0, |cost| cost.unknowns) / 1000;
    let each = |value: &dyn Fn(&Cost) -> String| {
        let values: Vec<String> = costs.iter().map(value).collect();
        if values.len() == 1 { format!("- / {}", values[0]) } else { values.join(" / ") }
    };
    let iterations = each(&|cost| format!("{:.0}", cost.iterations));
    let seconds = each(&|cost| format!("{:.2}", cost.seconds));
    let memory = each(&|cost| format!("{:.0}", cost.memory_bytes / 1e6));
    let ratio = if let [fast, slow] = costs { format!("{:.1}", slow.seconds / fast.seconds) } else { "-".into() };
    format!("| `{name}` | {unknowns} k | {ranks} | {iterations} | {seconds} | {ratio} | {memory} |")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_has_both_inverses_or_a_gap() {
        let cost = |seconds| Cost { unknowns: 12_345, iterations: 30.0, seconds, memory_bytes: 2e6 };
        assert_eq!(row("a", 2, &[cost(0.25), cost(1.0)]), "| `a` | 12 k | 2 | 30 / 30 | 0.25 / 1.00 | 4.0 | 2 / 2 |");
        assert_eq!(row("a", 1, &[cost(1.0)]), "| `a` | 12 k | 1 | - / 30 | - / 1.00 | - | - / 2 |");
    }

    #[test]
    fn steps_and_solves_are_taken_one_by_one() {
        let solver = r#"{"grid_unknowns": 10, "multiplier_unknowns": 5, "iterations": 7, "setup_seconds": 1, "assembly_seconds": 2,
            "solve_seconds": 3, "peak_memory_bytes": 4}"#;
        let summary = |motion: &str| serde_json::from_str(&format!(r#"{{"steps": 4, "solver": {solver}, "motion": {motion}}}"#)).unwrap();
        assert_eq!(Cost::of(&summary("null")), Cost { unknowns: 15, iterations: 7.0, seconds: 6.0, memory_bytes: 4.0 });
        let moving = Cost::of(&summary(r#"{"solves": 5, "iterations": 50, "seconds": 8}"#));
        assert_eq!((moving.iterations, moving.seconds), (10.0, 2.0));
    }
}
