//! Honest bars: scenes with known answers are solved to an accuracy, and the true error is held against the estimated one.

mod random;

use std::{ops::Range, time::Instant};

pub use self::random::random_scene;
use self::random::random_scene_in_space;
use super::{
    known::{ErrorBar, KnownScene},
    scenes::known_scenes,
};
use crate::{
    error::{Error, Refusal, Result},
    output::say,
    petsc::Session,
};

/// Part of the bars that must hold the true error.
const HONEST: f64 = 11.0 / 12.0;

/// Scenes drawn at random.
#[derive(Debug, Clone)]
pub struct RandomScenes {
    /// Their seeds.
    pub seeds: Range<u64>,
    /// Whether all are in 3D.
    pub space: bool,
}

/// Solves all known scenes, or some drawn at random, to each accuracy and prints bars beside true errors as a table in Markdown; tells whether
/// enough bars are honest.
///
/// # Errors
/// No scene can be solved to an accuracy like these, or a solve fails.
pub fn bars(session: &Session, accuracies: &[f64], random: Option<RandomScenes>) -> Result<bool> {
    check(&known_scenes(), accuracies)?;
    let scenes: Box<dyn Iterator<Item = Result<KnownScene>>> = match random {
        None => Box::new(known_scenes().into_iter().map(Ok)),
        Some(RandomScenes { seeds, space }) => {
            let draw = if space { random_scene_in_space } else { random_scene };
            Box::new(seeds.map(move |seed| draw(session, seed)))
        }
    };
    let say = |text: &str| session.world().on_first_rank(|| say(text));
    say("| scene | accuracy | cells per radius | estimated error | true error | seconds |\n|-|-|-|-|-|-|")?;
    let (mut all, mut honest, mut refused) = (Vec::new(), 0, 0);
    for scene in scenes {
        let scene = scene?;
        for &accuracy in accuracies {
            let start = Instant::now();
            let outcome = scene.solve(session, accuracy);
            let seconds = session.world().max(start.elapsed().as_secs_f64());
            let (name, what) = (&scene.name, scene.answer.quantity.word());
            match outcome {
                Ok(ErrorBar { estimated, error, calibration }) => {
                    let grids: Vec<String> = calibration.levels.iter().map(|level| level.cells_per_radius.to_string()).collect();
                    say(&format!("| {what}, {name} | {accuracy} | {} | {estimated:.1e} | {error:.1e} | {seconds:.2} |", grids.join(", ")))?;
                    honest += usize::from(error <= estimated);
                    all.push(estimated / accuracy);
                }
                Err(Error::Refused(text)) => {
                    refused += 1;
                    say(&format!("| {what}, {name} | {accuracy} | refused: {text} | | | {seconds:.2} |"))?;
                }
                Err(error) => return Err(error),
            }
        }
    }
    say(&format!("\n{}", verdict(honest, refused, &mut all)))?;
    Ok(enough(honest, refused + all.len()))
}

/// Refuses accuracies that no scene can be solved to.
fn check(scenes: &[KnownScene], accuracies: &[f64]) -> Result<()> {
    for accuracy in accuracies {
        if let Some(Err(Error::Refused(reason))) = scenes.first().map(|scene| scene.read(*accuracy)) {
            return Err(Error::refused(format!("--bars {accuracy}: {}", Refusal { place: None, ..*reason })));
        }
    }
    Ok(())
}

/// How many of the bars, of which the parts of the accuracy are given, hold the true error.
fn verdict(honest: usize, refused: usize, bars: &mut [f64]) -> String {
    bars.sort_by(f64::total_cmp);
    let median = bars.get(bars.len() / 2).map_or(String::new(), |median| format!("; the median bar is {median:.2} times the accuracy"));
    let refusals = if refused > 0 { format!(", {refused} scenes are refused and hold nothing") } else { String::new() };
    format!("{honest} of {} true errors lie inside their bars{refusals}{median}", bars.len())
}

/// Whether enough of all scenes have a bar that holds the true error; a scene that was refused has none.
fn enough(honest: usize, all: usize) -> bool {
    all > 0 && honest as f64 >= HONEST * all as f64
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn scenes_that_are_refused_are_counted_as_missed() {
        assert!(enough(11, 12) && !enough(10, 12) && !enough(0, 3) && !enough(0, 0));
        assert_eq!(verdict(0, 3, &mut []), "0 of 0 true errors lie inside their bars, 3 scenes are refused and hold nothing");
        let words = verdict(2, 0, &mut [0.5, 0.25]);
        assert_eq!(words, "2 of 2 true errors lie inside their bars; the median bar is 0.50 times the accuracy");
    }

    #[test]
    fn accuracies_that_cannot_be_asked_for_are_refused() {
        for accuracy in [0.0, -1.0, f64::NAN, 1e-9, 3.0] {
            let error = check(&known_scenes(), &[1e-2, accuracy]).unwrap_err().to_string();
            assert!(error.starts_with(&format!("--bars {accuracy}: ")), "{error}");
        }
        check(&known_scenes(), &[1e-2, 1e-3]).unwrap();
    }
}
