//! A scene with a known answer, and the bar that an accuracy puts around ours.

use std::path::Path;

use crate::{
    error::{Error, Result},
    petsc::Session,
    scene::Scene,
    study::calibration::{Answer, Calibration, RefinementSequence},
};

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

    /// It with an accuracy.
    ///
    /// # Errors
    /// No scene can have this one.
    pub fn read(&self, accuracy: f64) -> Result<Scene> {
        Scene::parse("known", Path::new("."), &self.text, &[format!("accuracy={accuracy}")])
    }

    fn measure<const D: usize>(&self, session: &Session, scene: &Scene) -> Result<Bar> {
        let (calibration, (suspension, solution)) = RefinementSequence::<D>::begin(session, scene)?.refine_until_met()?;
        let quantity = self.answer.quantity;
        let found = Answer::all(&suspension, &solution)?.into_iter().find(|answer| answer.quantity == quantity);
        let missing = || Error::Diverged(format!("{} has no {}", self.name, quantity.word()));
        let (found, estimated) = found.zip(calibration.error(quantity)).ok_or_else(missing)?;
        Ok(Bar { estimated, error: self.answer.distance(&found), calibration })
    }
}
