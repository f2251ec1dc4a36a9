//! Which settings a sweep goes through: what the command line lists, or else what suits the scene.

use super::{
    options::CostStudy,
    setting::{CostSetting, Resolution, TimeStep, has_modes},
};
use crate::{
    error::{Error, Result},
    scene::{ConstraintMethod, Scene, Spacing},
};

/// Cells per radius of scenes that count them, in 2D and 3D.
const CELLS_PER_RADIUS: [&[f64]; 2] = [&[3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0], &[3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0]];

/// Spacings of scenes that give one, over theirs: whole numbers of cells stay whole as far as can be.
const SPACINGS: [f64; 15] =
    [16.0, 32.0 / 3.0, 8.0, 16.0 / 3.0, 4.0, 8.0 / 3.0, 2.0, 4.0 / 3.0, 1.0, 2.0 / 3.0, 0.5, 1.0 / 3.0, 0.25, 1.0 / 6.0, 0.125];

/// Steps of scenes in time, over theirs, unless they follow the grid.
const STEPS: [f64; 3] = [2.0, 1.0, 0.5];

/// What is swept; every method goes through all combinations.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterRanges {
    /// Words of methods.
    pub methods: Vec<String>,
    grids: Vec<Resolution>,
    modes: Vec<Option<usize>>,
    tolerances: Vec<Option<f64>>,
    steps: Vec<Option<TimeStep>>,
}

impl ParameterRanges {
    /// Those of the command line for a scene whose smallest body has this radius.
    ///
    /// # Errors
    /// A list holds what cannot be used.
    pub fn of(options: &CostStudy, scene: &Scene, radius: Option<f64>) -> Result<ParameterRanges> {
        Ok(ParameterRanges {
            methods: methods(options, scene)?,
            grids: grids(options, scene, radius)?,
            modes: modes(options, scene)?,
            tolerances: listed("--tolerances", &options.tolerances, "must lie above 0 and not above 0.1", |value| value <= 0.1)?,
            steps: steps(options, scene)?,
        })
    }

    /// All settings of a method and, if it is its own, that of the scene as written, by rising work.
    pub fn settings(&self, method: &str, scene: &Scene, radius: f64) -> Vec<CostSetting> {
        let modes = if has_modes(method) { self.modes.as_slice() } else { &[None] };
        let mut settings = Vec::new();
        for &grid in &self.grids {
            for &modes in modes {
                for &tolerance in &self.tolerances {
                    settings.extend(self.steps.iter().map(|&step| CostSetting { method: method.to_owned(), grid, modes, tolerance, step }));
                }
            }
        }
        let written = CostSetting::of_scene(scene);
        if written.method == method && !settings.contains(&written) {
            settings.push(written);
        }
        settings.sort_by(|one, two| one.work(scene.dimension(), radius).total_cmp(&two.work(scene.dimension(), radius)));
        settings
    }
}

fn methods(options: &CostStudy, scene: &Scene) -> Result<Vec<String>> {
    let suits = |word: &&str| *word != "fitted" || scene.dimension() == 2;
    let known: Vec<&str> = ConstraintMethod::WORDS.into_iter().filter(suits).collect();
    if options.methods.is_empty() {
        return Ok(known.into_iter().map(str::to_owned).collect());
    }
    match options.methods.iter().find(|word| !known.contains(&word.as_str())) {
        Some(stranger) => Err(Error::refused(format!("--methods {stranger}: must be some of {}", known.join(",")))),
        None => Ok(options.methods.clone()),
    }
}

fn grids(options: &CostStudy, scene: &Scene, radius: Option<f64>) -> Result<Vec<Resolution>> {
    let positive = |flag, list: &[f64]| listed(flag, list, "must be positive", |_| true);
    if !options.spacings.is_empty() {
        return Ok(positive("--spacings", &options.spacings)?.into_iter().flatten().map(Resolution::Spacing).collect());
    }
    if !options.resolutions.is_empty() {
        if radius.is_none() {
            let remedy = "cells per radius, but there are no bodies to measure by; give --spacings instead";
            return Err(Error::refused(format!("--resolutions: {remedy}")));
        }
        return Ok(positive("--resolutions", &options.resolutions)?.into_iter().flatten().map(Resolution::CellsPerRadius).collect());
    }
    let cells = CELLS_PER_RADIUS[scene.dimension() - 2];
    let (fewest, most) = (cells[0] * (1.0 - 1e-9), cells[cells.len() - 1]);
    Ok(match scene.resolution.as_ref().map(|resolution| resolution.spacing) {
        Some(given @ (Spacing::Length(own) | Spacing::Exactly(own))) => {
            let suits = |spacing: &f64| radius.map_or(own / spacing <= 4.0, |radius| (fewest..=most).contains(&(radius / spacing)));
            let made = if matches!(given, Spacing::Exactly(_)) { Resolution::Exactly } else { Resolution::Spacing };
            SPACINGS.iter().map(|factor| own * factor).filter(suits).map(made).collect()
        }
        _ => cells.iter().map(|&cells| Resolution::CellsPerRadius(cells)).collect(),
    })
}

fn modes(options: &CostStudy, scene: &Scene) -> Result<Vec<Option<usize>>> {
    let least = if scene.scalar() { 1 } else { 2 };
    if let Some(few) = options.modes.iter().find(|modes| **modes < least) {
        let why = if *few == 1 { ": a single one lets surfaces of bodies strain with the flow" } else { "" };
        return Err(Error::refused(format!("--modes {few}: must be at least {least}{why}")));
    }
    Ok(if options.modes.is_empty() { vec![None] } else { options.modes.iter().copied().map(Some).collect() })
}

fn steps(options: &CostStudy, scene: &Scene) -> Result<Vec<Option<TimeStep>>> {
    let Some(own) = TimeStep::of(scene) else {
        return match options.steps.is_empty() && options.travels.is_empty() {
            true => Ok(vec![None]),
            false => Err(Error::refused("--steps: the scene is one instant and takes no steps; add [time] to it or leave the flag out")),
        };
    };
    let end = scene.end();
    if !options.steps.is_empty() {
        let steps =
            listed("--steps", &options.steps, &format!("must be positive and not longer than the {end} of the run"), |step| step <= end)?;
        return Ok(steps.into_iter().map(|step| step.map(TimeStep::Step)).collect());
    }
    if !options.travels.is_empty() {
        let travels = listed("--travels", &options.travels, "must lie above 0 and not above 1", |travel| travel <= 1.0)?;
        return Ok(travels.into_iter().map(|travel| travel.map(TimeStep::Travel)).collect());
    }
    if own.follows_grid(scene) {
        return Ok(vec![Some(own)]);
    }
    let longest = if matches!(own, TimeStep::Step(_)) { end } else { 1.0 };
    Ok(STEPS.iter().map(|&factor| own.times(factor)).filter(|step| step.length() <= longest).map(Some).collect())
}

/// The numbers of a flag, or the one absent number if it is not there.
fn listed(flag: &str, numbers: &[f64], remedy: &str, right: impl Fn(f64) -> bool) -> Result<Vec<Option<f64>>> {
    if let Some(wrong) = numbers.iter().find(|&&number| !(number.is_finite() && number > 0.0 && right(number))) {
        return Err(Error::refused(format!("{flag} {wrong}: {remedy}")));
    }
    Ok(if numbers.is_empty() { vec![None] } else { numbers.iter().copied().map(Some).collect() })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use super::*;

    fn scene(text: &str) -> Scene {
        Scene::parse("scene", Path::new(""), text, &[]).unwrap()
    }

    const ARRAY: &str = "domain.size = [1, 1]\nresolution.spacing = 0.03125\n[[bodies]]\nradius = 0.309\ncount = 1\n";

    #[test]
    fn spacings_halve_and_keep_whole_cells() {
        let scene = scene(ARRAY);
        let ranges = ParameterRanges::of(&CostStudy::default(), &scene, Some(0.309)).unwrap();
        let cells: Vec<f64> = ranges.grids.iter().map(|grid| 1.0 / grid.spacing(0.309)).map(|cells| (1e6 * cells).round() / 1e6).collect();
        assert_eq!(cells, [12.0, 16.0, 24.0, 32.0, 48.0, 64.0, 96.0]);
        let settings = ranges.settings("sharp", &scene, 0.309);
        assert_eq!(settings.len(), 7, "the scene as it is written is among them");
        assert!(settings.windows(2).all(|pair| pair[0].work(2, 0.309) <= pair[1].work(2, 0.309)));
        assert_eq!(ranges.methods, ConstraintMethod::WORDS);
    }

    #[test]
    fn methods_without_modes_have_no_list_of_modes() {
        let scene = scene(ARRAY);
        let options = CostStudy { modes: vec![4, 8], resolutions: vec![6.0], tolerances: vec![1e-4, 1e-6], ..CostStudy::default() };
        let ranges = ParameterRanges::of(&options, &scene, Some(0.309)).unwrap();
        assert_eq!(ranges.settings("distributed", &scene, 0.309).len(), 2);
        assert_eq!(ranges.settings("sharp", &scene, 0.309).len(), 5, "four, and the scene as it is written");
    }

    #[test]
    fn steps_are_those_of_the_scene_unless_told() {
        let scene = scene(&format!("{ARRAY}[time]\nend = 1\nstep = 0.75\n"));
        let steps = |options: &CostStudy| ParameterRanges::of(options, &scene, Some(0.309)).map(|ranges| ranges.steps);
        assert_eq!(steps(&CostStudy::default()).unwrap(), [Some(TimeStep::Step(0.75)), Some(TimeStep::Step(0.375))]);
        let travels = CostStudy { travels: vec![0.1], ..CostStudy::default() };
        assert_eq!(steps(&travels).unwrap(), [Some(TimeStep::Travel(0.1))]);
    }

    #[test]
    fn automatic_steps_of_a_flow_with_inertia_follow_the_grid_and_are_not_swept() {
        let with = |time: &str| {
            let text = format!("flow = {{ model = \"navier-stokes\", density = 1 }}\n{ARRAY}[time]\nend = 1\n{time}");
            ParameterRanges::of(&CostStudy::default(), &scene(&text), Some(0.309)).unwrap().steps
        };
        assert_eq!(with(""), [Some(TimeStep::Travel(0.1))]);
        assert_eq!(with("step = 0.25\n"), [0.5, 0.25, 0.125].map(|step| Some(TimeStep::Step(step))));
    }

    #[test]
    fn lists_that_cannot_be_used_are_refused_with_their_flag() {
        let with = |options: CostStudy| ParameterRanges::of(&options, &scene(ARRAY), Some(0.309)).unwrap_err().to_string();
        let options = CostStudy::default;
        assert_eq!(with(CostStudy { resolutions: vec![4.0, -1.0], ..options() }), "--resolutions -1: must be positive");
        assert_eq!(with(CostStudy { tolerances: vec![0.5], ..options() }), "--tolerances 0.5: must lie above 0 and not above 0.1");
        assert_eq!(with(CostStudy { modes: vec![0], ..options() }), "--modes 0: must be at least 2");
        assert!(with(CostStudy { steps: vec![0.1], ..options() }).starts_with("--steps: the scene is one instant"));
        let strange = with(CostStudy { methods: vec!["blunt".into()], ..options() });
        assert_eq!(strange, "--methods blunt: must be some of sharp,mean-value,distributed,penalty,fitted");
    }
}
