//! What each inverse of the fluid costs, scene by scene: a table made of real runs.

use std::path::{Path, PathBuf};

use super::command::{PetscOptions, Study};
use crate::{
    error::Result,
    experiment::{
        arguments::Start,
        folder::Scratch,
        launcher::{Job, Launcher, StartArguments, WITHOUT_PICTURE},
        summary::RunSummary,
    },
    flow::InverseMethod,
    output::{prepare_folder, say},
    scene::Scene,
    setup::Setup,
};

/// What to run.
#[derive(Debug, Clone, clap::Args)]
pub struct Inverses {
    /// Scene files.
    #[arg(required = true)]
    pub scenes: Vec<PathBuf>,
    /// Override a key of each scene: --set bodies.0.count=100
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,
    /// Numbers of ranks.
    #[arg(long, value_delimiter = ',', default_values_t = [1])]
    pub ranks: Vec<usize>,
    /// How runs are started.
    #[command(flatten)]
    pub start: StartArguments,
}

/// What a run tells of its cost.
#[derive(Debug, Clone, Copy, PartialEq)]
struct InverseCost {
    unknowns: f64,
    /// Of the instant, or the mean of all solves.
    iterations: f64,
    /// Everything of an instant, or a step.
    seconds: f64,
    memory_bytes: f64,
}

impl Study<PetscOptions> for Inverses {
    const NAME: &'static str = "inverses";
    const ABOUT: &'static str = "Run scenes with each Stokes solver that suits them and print what each costs";

    fn run(&self, petsc: &PetscOptions) -> Result<()> {
        let launcher = Launcher::new(&Start { launcher: &self.start.launcher, petsc, ranks: 1 })?;
        let scenes = self.scenes.iter().map(|path| Scene::read(path, &self.overrides)).collect::<Result<Vec<_>>>()?;
        let methods = scenes.iter().map(methods).collect::<Result<Vec<_>>>()?;
        let folder = Path::new("out");
        prepare_folder(folder)?;
        let scratch = Scratch::within(folder)?;
        say("| scene | unknowns | ranks | iterations: transform / hypre | seconds: transform / hypre | ratio | MB: transform / hypre |")?;
        say("|-|-|-|-|-|-|-|")?;
        for ((path, scene), methods) in self.scenes.iter().zip(&scenes).zip(methods) {
            for &ranks in &self.ranks {
                let cost = |method: &InverseMethod| {
                    let overrides = [&self.overrides[..], &[format!("method.inverse={}", method.word()), WITHOUT_PICTURE.into()]].concat();
                    let job = Job { scene: path, overrides: &overrides, folder: &scratch.0.join("out"), ranks, repeat: self.start.repeat };
                    launcher.measure(&job, |path| Ok(InverseCost::of(&RunSummary::read(path)?)), |cost| cost.seconds)
                };
                let costs = methods.iter().map(cost).collect::<Result<Vec<_>>>()?;
                say(&row(&path.display().to_string(), ranks, &costs))?;
            }
            if scene.time.is_some() {
                say("| (a scene in time: mean iterations of a solve, seconds of a step) | | | | | | |")?;
            }
        }
        Ok(())
    }
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

impl InverseCost {
    fn of(summary: &RunSummary) -> InverseCost {
        let seconds = match summary.in_time() {
            true => summary.solve_seconds() / summary.number("/steps").max(1.0),
            false => summary.setup_seconds() + summary.solve_seconds(),
        };
        InverseCost { unknowns: summary.unknowns(), iterations: summary.iterations(), seconds, memory_bytes: summary.memory_bytes() }
    }
}

/// A row of the table for the costs with the fastest inverse and, if that is another one, with multigrid.
fn row(name: &str, ranks: usize, costs: &[InverseCost]) -> String {
    let unknowns = (costs.first().map_or(0.0, |cost| cost.unknowns) / 1e3).floor();
    let each = |value: &dyn Fn(&InverseCost) -> String| {
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
        let cost = |seconds| InverseCost { unknowns: 12_345.0, iterations: 30.0, seconds, memory_bytes: 2e6 };
        assert_eq!(row("a", 2, &[cost(0.25), cost(1.0)]), "| `a` | 12 k | 2 | 30 / 30 | 0.25 / 1.00 | 4.0 | 2 / 2 |");
        assert_eq!(row("a", 1, &[cost(1.0)]), "| `a` | 12 k | 1 | - / 30 | - / 1.00 | - | - / 2 |");
    }

    #[test]
    fn steps_and_solves_are_taken_one_by_one() {
        let solver = serde_json::json!({"grid_unknowns": 10, "multiplier_unknowns": 5, "iterations": 7, "setup_seconds": 1,
            "assembly_seconds": 2, "solve_seconds": 3, "peak_memory_bytes": 4});
        let summary = |motion| RunSummary(serde_json::json!({"steps": 4, "solver": solver, "motion": motion}));
        assert_eq!(
            InverseCost::of(&summary(serde_json::Value::Null)),
            InverseCost { unknowns: 15.0, iterations: 7.0, seconds: 6.0, memory_bytes: 4.0 }
        );
        let moving = InverseCost::of(&summary(serde_json::json!({"solves": 5, "iterations": 50, "seconds": 8})));
        assert_eq!((moving.iterations, moving.seconds), (10.0, 2.0));
    }
}
