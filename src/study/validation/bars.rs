//! Honest bars: scenes with known answers are solved to an accuracy, and the true error is held against the estimated one.

mod scenes;

use std::{path::Path, time::Instant};

use crate::{
    error::{Error, Result},
    petsc::Session,
    scene::Scene,
    study::{Answer, Calibration, Ladder},
};

pub use scenes::known_scenes;

/// Part of the bars that must hold the true error.
const HONEST: f64 = 11.0 / 12.0;

/// A scene and what it must answer.
pub struct KnownScene {
    /// What it is.
    pub name: String,
    /// Its text, without resolution and accuracy.
    pub text: String,
    /// All numbers of one quantity.
    pub answer: Answer,
}

/// A bar beside the truth.
pub struct Bar {
    /// Estimated relative error.
    pub estimated: f64,
    /// True relative error.
    pub error: f64,
    /// The setting.
    pub calibration: Calibration,
}

impl KnownScene {
    /// The dimension of its space.
    pub fn dimension(&self) -> Result<usize> {
        Ok(self.read(1e-2)?.dimension())
    }

    /// Solves it to an accuracy; collective.
    ///
    /// # Errors
    /// The accuracy cannot be met, or the scene does not answer what is known.
    pub fn solve(&self, session: &Session, accuracy: f64) -> Result<Bar> {
        let scene = self.read(accuracy)?;
        match scene.dimension() {
            2 => self.measure::<2>(session, &scene),
            _ => self.measure::<3>(session, &scene),
        }
    }

    fn read(&self, accuracy: f64) -> Result<Scene> {
        Scene::parse("known", Path::new("."), &self.text, &[format!("accuracy={accuracy}")])
    }

    fn measure<const D: usize>(&self, session: &Session, scene: &Scene) -> Result<Bar> {
        let (calibration, (suspension, solution)) = Ladder::<D>::begin(session, scene)?.climb()?;
        let quantity = self.answer.quantity;
        let found = Answer::all(&suspension, &solution)?.into_iter().find(|answer| answer.quantity == quantity);
        let missing = || Error::Diverged(format!("{} has no {}", self.name, quantity.word()));
        let (found, estimated) = found.zip(calibration.error(quantity)).ok_or_else(missing)?;
        Ok(Bar { estimated, error: self.answer.distance(&found), calibration })
    }
}

/// Solves all known scenes to each accuracy and prints bars beside true errors as a table in Markdown; tells whether enough bars are honest.
///
/// # Errors
/// A solve fails.
#[allow(clippy::print_stdout)]
pub fn bars(session: &Session, accuracies: &[f64]) -> Result<bool> {
    let say = |text: String| {
        if session.world().rank() == 0 {
            println!("{text}");
        }
    };
    say("| scene | accuracy | cells per radius | estimated error | true error | seconds |\n|-|-|-|-|-|-|".into());
    let (mut all, mut honest) = (Vec::new(), 0);
    for scene in known_scenes() {
        for &accuracy in accuracies {
            let start = Instant::now();
            let outcome = scene.solve(session, accuracy);
            let seconds = session.world().max(start.elapsed().as_secs_f64());
            let (name, what) = (&scene.name, scene.answer.quantity.word());
            match outcome {
                Ok(Bar { estimated, error, calibration }) => {
                    let grids: Vec<String> = calibration.rungs.iter().map(|rung| rung.cells_per_radius.to_string()).collect();
                    say(format!("| {what}, {name} | {accuracy} | {} | {estimated:.1e} | {error:.1e} | {seconds:.2} |", grids.join(", ")));
                    honest += usize::from(error <= estimated);
                    all.push(estimated / accuracy);
                }
                Err(Error::Refused(text)) => say(format!("| {what}, {name} | {accuracy} | refused: {text} | | | {seconds:.2} |")),
                Err(error) => return Err(error),
            }
        }
    }
    all.sort_by(f64::total_cmp);
    let median = all.get(all.len() / 2).copied().unwrap_or(f64::NAN);
    say(format!("\n{honest} of {} true errors lie inside their bars; the median bar is {median:.2} times the accuracy", all.len()));
    Ok(honest as f64 >= HONEST * all.len() as f64)
}
