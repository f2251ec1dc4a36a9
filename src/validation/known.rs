//! A scene with a known answer, and the bar that an accuracy puts around ours.

use std::path::Path;

use super::solve::solve;
use crate::{
    error::{Error, Result},
    petsc::Session,
    run::{Calibration, CalibrationAnswer, EstimatedQuantity, RefinementSequence},
    scene::Scene,
};

/// A scene and what it must answer.
pub struct KnownScene {
    /// What it is.
    pub name: String,
    /// Its text, without resolution and accuracy.
    pub text: String,
    /// All numbers of one quantity.
    pub answer: CalibrationAnswer,
}

/// A bar beside the truth.
pub struct ErrorBar {
    /// Estimated relative error.
    pub estimated: f64,
    /// True relative error.
    pub error: f64,
    /// The setting.
    pub calibration: Calibration,
}

/// The quantity of a word.
pub fn quantity_of(word: &str) -> Option<EstimatedQuantity> {
    serde_json::from_value(word.into()).ok()
}

impl KnownScene {
    /// That of a file which begins with its name and has a line `#= QUANTITY NUMBERS..`; nothing without such a line.
    pub fn parse(text: &str) -> Option<KnownScene> {
        let name = text.lines().next()?.strip_prefix("# ")?.to_owned();
        let mut words = text.lines().find_map(|line| line.strip_prefix("#= "))?.split(' ');
        let quantity = quantity_of(words.next()?)?;
        let values = words.map(str::parse).collect::<std::result::Result<_, _>>().ok()?;
        Some(KnownScene { name, text: text.to_owned(), answer: CalibrationAnswer { quantity, values } })
    }

    /// The dimension of its space.
    pub fn dimension(&self) -> Result<usize> {
        Ok(self.read(1e-2)?.dimension())
    }

    /// Solves it to an accuracy; collective.
    ///
    /// # Errors
    /// The accuracy cannot be met, or the scene does not answer what is known.
    pub fn solve(&self, session: &Session, accuracy: f64) -> Result<ErrorBar> {
        let scene = self.read(accuracy)?;
        match scene.dimension() {
            2 => self.measure::<2>(session, &scene),
            _ => self.measure::<3>(session, &scene),
        }
    }

    /// It with an accuracy.
    ///
    /// # Errors
    /// No scene can have this one.
    pub fn read(&self, accuracy: f64) -> Result<Scene> {
        Scene::parse("known", Path::new("."), &self.text, &[format!("accuracy={accuracy}")])
    }

    /// What is known of it, solved with overrides; collective.
    ///
    /// # Errors
    /// It cannot be solved, or does not answer what is known.
    pub fn answered(&self, session: &Session, overrides: &[String]) -> Result<CalibrationAnswer> {
        let scene = Scene::parse("known", Path::new("."), &self.text, overrides)?;
        let answers = if scene.dimension() == 2 {
            answers::<2>(session, &self.text, overrides)
        } else {
            answers::<3>(session, &self.text, overrides)
        };
        self.find(answers?)
    }

    fn find(&self, answers: Vec<CalibrationAnswer>) -> Result<CalibrationAnswer> {
        let quantity = self.answer.quantity;
        let missing = || Error::Diverged(format!("{} has no {}", self.name, quantity.word()));
        answers.into_iter().find(|answer| answer.quantity == quantity).ok_or_else(missing)
    }

    fn measure<const D: usize>(&self, session: &Session, scene: &Scene) -> Result<ErrorBar> {
        let (calibration, (suspension, solution)) = RefinementSequence::<D>::begin(session, scene)?.refine_until_met()?;
        let found = self.find(CalibrationAnswer::all(&suspension, &solution)?)?;
        let missing = || Error::Diverged(format!("{} has no bar", self.name));
        let estimated = calibration.error(found.quantity).ok_or_else(missing)?;
        Ok(ErrorBar { estimated, error: self.answer.distance(&found), calibration })
    }
}

fn answers<const D: usize>(session: &Session, text: &str, overrides: &[String]) -> Result<Vec<CalibrationAnswer>> {
    let (suspension, solution) = solve::<D>(session, text, overrides)?;
    CalibrationAnswer::all(&suspension, &solution)
}
