//! One setting of all that decides the accuracy of a run: method, grid, modes, tolerance, step.

use serde::{Deserialize, Serialize};

use crate::scene::{FlowModel, Modes, Scene, Spacing, Step, Tolerance};

/// Methods with surface modes.
const WITH_MODES: [&str; 2] = ["sharp", "mean-value"];

/// A setting; what is absent is left as the scene has it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CostSetting {
    /// Word of the constraint method.
    pub method: String,
    /// The grid.
    pub grid: Resolution,
    /// Order of the surface modes, automatic if absent.
    pub modes: Option<usize>,
    /// Relative residual at which a solve ends.
    pub tolerance: Option<f64>,
    /// The time step; absent at an instant.
    pub step: Option<TimeStep>,
}

/// How fine a grid is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Resolution {
    /// Cells across the radius of the smallest body.
    CellsPerRadius(f64),
    /// A length, or one a little off it that makes solvers quick.
    Spacing(f64),
    /// A length, or the nearest that divides the box.
    Exactly(f64),
}

/// How long steps are.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TimeStep {
    /// This long.
    Step(f64),
    /// As long as bodies take for this part of their radius.
    Travel(f64),
}

/// Whether a method has surface modes.
pub fn has_modes(method: &str) -> bool {
    WITH_MODES.contains(&method)
}

impl CostSetting {
    /// The scene as it is written.
    ///
    /// # Panics
    /// The scene is dry.
    pub fn of_scene(scene: &Scene) -> CostSetting {
        let resolution = scene.resolution.as_ref().expect("only dry scenes have no resolution");
        let method = scene.method.constraint.word();
        let modes = match resolution.modes {
            Modes::Count(modes) if has_modes(method) => Some(modes),
            _ => None,
        };
        CostSetting {
            method: method.to_owned(),
            grid: Resolution::of(resolution.spacing),
            modes,
            tolerance: None,
            step: TimeStep::of(scene),
        }
    }

    /// What makes a scene so, as `key=value`.
    pub fn overrides(&self) -> Vec<String> {
        let mut overrides = vec![format!("method.constraint={}", self.method)];
        overrides.push(match self.grid {
            Resolution::CellsPerRadius(cells) => format!("resolution.cells_per_radius={cells:?}"),
            Resolution::Spacing(spacing) => format!("resolution.spacing={spacing:?}"),
            Resolution::Exactly(spacing) => format!("resolution.spacing={{ exactly = {spacing:?} }}"),
        });
        overrides.push(self.modes.map_or("resolution.modes=auto".into(), |modes| format!("resolution.modes={modes}")));
        overrides.extend(self.tolerance.map(|tolerance| format!("method.tolerance={tolerance:?}")));
        overrides.extend(self.step.map(|step| match step {
            TimeStep::Step(step) => format!("time.step={step:?}"),
            TimeStep::Travel(travel) => format!("time.travel={travel:?}"),
        }));
        overrides
    }

    /// What a run costs in proportion, with no regard to the method: cells of the grid times steps.
    pub fn work(&self, dimension: usize, radius: f64) -> f64 {
        self.grid.spacing(radius).powi(-(dimension as i32)) / self.step.map_or(1.0, TimeStep::length)
    }

    /// The tolerance of its solves in a scene.
    pub fn tolerance_in(&self, scene: &Scene) -> f64 {
        match (self.tolerance, scene.method.tolerance) {
            (Some(tolerance), _) | (None, Tolerance::Fixed(tolerance)) => tolerance,
            (None, automatic) => automatic.at_an_instant(),
        }
    }

    /// In words, without the method.
    pub fn words(&self) -> String {
        let grid = match self.grid {
            Resolution::CellsPerRadius(cells) => format!("{cells} cells per radius"),
            Resolution::Spacing(spacing) => format!("spacing {spacing:.5}"),
            Resolution::Exactly(spacing) => format!("spacing exactly {spacing:.5}"),
        };
        let modes = has_modes(&self.method).then(|| self.modes.map_or("modes auto".into(), |modes| format!("{modes} modes")));
        let tolerance = self.tolerance.map(|tolerance| format!("tolerance {tolerance:.0e}"));
        let step = self.step.map(|step| match step {
            TimeStep::Step(step) => format!("step {step}"),
            TimeStep::Travel(travel) => format!("travel {travel}"),
        });
        [Some(grid), modes, tolerance, step].into_iter().flatten().collect::<Vec<_>>().join(", ")
    }

    /// Whether it differs from another in the grid alone.
    pub fn differs_in_grid_alone(&self, other: &CostSetting) -> bool {
        CostSetting { grid: other.grid, ..self.clone() } == *other
    }
}

impl Resolution {
    /// That of a scene.
    pub fn of(spacing: Spacing) -> Resolution {
        match spacing {
            Spacing::CellsPerRadius(cells) => Resolution::CellsPerRadius(cells),
            Spacing::Length(spacing) => Resolution::Spacing(spacing),
            Spacing::Exactly(spacing) => Resolution::Exactly(spacing),
        }
    }

    /// The spacing asked for beside bodies of a radius.
    pub fn spacing(self, radius: f64) -> f64 {
        match self {
            Resolution::CellsPerRadius(cells) => radius / cells,
            Resolution::Spacing(spacing) | Resolution::Exactly(spacing) => spacing,
        }
    }

    /// So many times finer.
    pub fn finer(self, factor: f64) -> Resolution {
        match self {
            Resolution::CellsPerRadius(cells) => Resolution::CellsPerRadius(cells * factor),
            Resolution::Spacing(spacing) => Resolution::Spacing(spacing / factor),
            Resolution::Exactly(spacing) => Resolution::Exactly(spacing / factor),
        }
    }
}

impl TimeStep {
    /// That of a scene; nothing at an instant.
    pub fn of(scene: &Scene) -> Option<TimeStep> {
        scene.time.as_ref().map(|time| match time.step {
            Step::Auto => TimeStep::Travel(time.travel),
            Step::Fixed(step) => TimeStep::Step(step),
        })
    }

    /// Whether steps are shorter on finer grids whatever stands here: automatic ones of a flow with inertia, in which it passes half a cell at most.
    pub fn follows_grid(self, scene: &Scene) -> bool {
        matches!(self, TimeStep::Travel(_)) && scene.flow.model == FlowModel::NavierStokes
    }

    /// The step, or what stands for it in proportion.
    pub fn length(self) -> f64 {
        match self {
            TimeStep::Step(length) | TimeStep::Travel(length) => length,
        }
    }

    /// So many times as long.
    pub fn times(self, factor: f64) -> TimeStep {
        match self {
            TimeStep::Step(step) => TimeStep::Step(step * factor),
            TimeStep::Travel(travel) => TimeStep::Travel(travel * factor),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use super::*;

    const SCENE: &str = "domain.size = [8, 8]\nresolution = { spacing = 0.1, modes = 9 }\ntime = { end = 2, step = 0.5 }\n";

    #[test]
    fn a_setting_makes_a_scene_as_it_says() {
        let scene = Scene::parse("scene", Path::new(""), SCENE, &[]).unwrap();
        let written = CostSetting::of_scene(&scene);
        assert_eq!((written.grid, written.modes, written.step), (Resolution::Spacing(0.1), Some(9), Some(TimeStep::Step(0.5))));
        let other = CostSetting {
            grid: Resolution::Spacing(0.05),
            modes: None,
            tolerance: Some(1e-9),
            step: Some(TimeStep::Travel(0.2)),
            ..written
        };
        let made = Scene::parse("scene", Path::new(""), SCENE, &other.overrides()).unwrap();
        assert_eq!(CostSetting { tolerance: Some(1e-9), ..CostSetting::of_scene(&made) }, other);
        assert_eq!(other.tolerance_in(&made), 1e-9);
        assert_eq!(other.words(), "spacing 0.05000, modes auto, tolerance 1e-9, travel 0.2");
    }

    /// What earlier studies left in `cost.json` is read again.
    #[test]
    fn settings_are_kept_by_the_words_of_the_command_line() {
        let kept = r#"{"method":"sharp","grid":{"cells_per_radius":8.0},"modes":null,"tolerance":null,"step":{"travel":0.2}}"#;
        let setting: CostSetting = serde_json::from_str(kept).unwrap();
        assert_eq!((setting.grid, setting.step), (Resolution::CellsPerRadius(8.0), Some(TimeStep::Travel(0.2))));
        assert_eq!(serde_json::to_string(&setting).unwrap(), kept);
    }

    #[test]
    fn work_counts_cells_and_steps() {
        let coarse = CostSetting {
            method: "sharp".into(),
            grid: Resolution::CellsPerRadius(4.0),
            modes: None,
            tolerance: None,
            step: Some(TimeStep::Step(0.1)),
        };
        let fine = CostSetting { grid: coarse.grid.finer(2.0), step: coarse.step.map(|step| step.times(0.5)), ..coarse.clone() };
        assert!((fine.work(3, 1.0) / coarse.work(3, 1.0) - 16.0).abs() < 1e-12);
        assert!(!fine.differs_in_grid_alone(&coarse) && CostSetting { step: coarse.step, ..fine }.differs_in_grid_alone(&coarse));
    }
}
