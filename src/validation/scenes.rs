//! Scenes with known answers, as files: a name, what is known, and the scene without its resolution.
//!
//! ```text
//! # NAME
//! #= QUANTITY NUMBERS..                    all numbers of a quantity, against which error bars are held
//! #* ROW | GRID | SPACING MODES | NUMBER FACTOR OFFSET | REFERENCE TOLERANCE | SOURCE
//! ```
//!
//! Lines `#*` are rows of the table of known answers: solved with that spacing and order of the modes, a number of the answer (`drag.0`, `viscosity.from_walls`),
//! times a factor and with an offset, differs from its reference by the tolerance at most, relatively.

use std::path::Path;

use super::{
    case::Case,
    known::{KnownScene, quantity_of},
    solve::{solve, viscosity},
};
use crate::{
    error::{Error, Result},
    mechanics::{Inclusions, ScalarSetup},
    petsc::Session,
    run::CalibrationAnswer,
    scene::Scene,
};

/// Texts of files in the folder of scenes.
macro_rules! files {
    ($($name:literal)*) => { [$(include_str!(concat!("scenes/", $name, ".toml"))),*] };
}

/// The scenes.
#[rustfmt::skip]
const FILES: [&str; 46] = files!(
    "square-array-0.1" "square-array-0.3" "square-array-0.5" "square-lattice-0.01" "square-lattice-0.1" "square-lattice-0.3" "square-lattice-0.5"
    "square-lattice-0.7" "couette-viscosity-1-0.1" "couette-viscosity-1-0.2" "couette-viscosity-1-0.3" "couette-viscosity-4-0.4" "couette-spin-1-0.2"
    "couette-spin-1-0.3" "couette-spin-4-0.2" "couette-spin-1-0.125" "couette-spin-8-0.125" "two-disks-in-a-couette-cell"
    "two-disks-in-a-periodic-box" "two-disks-that-sink" "random-cell-of-30-disks" "disk-of-0.1-pulled-along-a-channel"
    "disk-of-0.125-pulled-along-a-channel" "disk-of-0.25-pulled-along-a-channel" "fixed-disk-of-0.1-in-a-channel" "fixed-disk-of-0.125-in-a-channel"
    "fixed-disk-of-0.25-in-a-channel" "disk-of-0.1-in-a-closed-box" "disk-of-0.2-in-a-closed-box" "disk-of-0.3-in-a-closed-box" "cubic-array-0.064"
    "cubic-array-0.125" "cubic-array-0.216" "cubic-lattice-0.01" "cubic-lattice-0.027" "cubic-lattice-0.216" "cubic-lattice-0.343"
    "sphere-in-a-closed-box" "cubic-array-0.125-films" "cubic-array-0.216-films" "body-centred-cubic-array-0.200-films"
    "face-centred-cubic-array-0.200-films" "scalar-disk" "conduction-square-0.3" "conduction-square-0.5" "conduction-cubic-0.3"
);

/// All scenes whose answers are known as a whole.
pub fn known_scenes() -> Vec<KnownScene> {
    FILES.into_iter().filter_map(KnownScene::parse).collect()
}

/// The rows of the table of known answers.
pub fn cases() -> Vec<Case> {
    let rows = |text: &'static str| text.lines().filter_map(move |line| Some(case(text, line.strip_prefix("#* ")?)));
    FILES.into_iter().flat_map(rows).collect()
}

/// A row of a scene.
fn case(text: &'static str, line: &'static str) -> Case {
    let parts: Vec<&'static str> = line.split(" | ").collect();
    let [name, label, grid, number, known, source] = parts[..] else { panic!("a row of a scene has six parts: {line}") };
    let words = |part: &'static str| part.split(' ').collect::<Vec<_>>();
    let real = |word: &str| word.parse::<f64>().unwrap_or_else(|_| panic!("{word} is no number: {line}"));
    let ([spacing, modes], [number, factor, offset], [reference, tolerance]) = (&words(grid)[..], &words(number)[..], &words(known)[..])
    else {
        panic!("a row of a scene lacks a number: {line}")
    };
    let overrides = overrides(text, spacing, modes);
    let (number, factor, offset) = (*number, real(factor), real(offset));
    let solve = move |session: &Session| Ok(factor * number_of(session, text, &overrides, number)? + offset);
    Case { name, source, resolution: label.to_owned(), reference: real(reference), tolerance: real(tolerance), solve: Box::new(solve) }
}

/// What makes a scene so, solved far below the errors that are measured.
fn overrides(text: &str, spacing: &str, modes: &str) -> Vec<String> {
    let grid = match scalar(text) {
        true => vec![format!("resolution.spacing={{ exactly = {spacing} }}")],
        false => vec![format!("resolution.spacing={spacing}"), "method.inverse=hypre".into()],
    };
    [grid, vec![format!("resolution.modes={modes}"), "method.tolerance=1e-8".into()]].concat()
}

/// Whether a scene is that of a scalar.
fn scalar(text: &str) -> bool {
    text.contains("model = \"scalar\"")
}

/// A number that a scene answers; collective.
fn number_of(session: &Session, text: &str, overrides: &[String], number: &str) -> Result<f64> {
    let dimension = Scene::parse("known", Path::new("."), text, overrides)?.dimension();
    let found = match (scalar(text), dimension) {
        (true, 2) => number_of_scalar::<2>(session, text, overrides, number),
        (true, _) => number_of_scalar::<3>(session, text, overrides, number),
        (false, 2) => number_of_flow::<2>(session, text, overrides, number),
        (false, _) => number_of_flow::<3>(session, text, overrides, number),
    };
    found?.ok_or_else(|| Error::Diverged(format!("a scene of the validation does not answer {number}")))
}

fn number_of_scalar<const D: usize>(session: &Session, text: &str, overrides: &[String], number: &str) -> Result<Option<f64>> {
    let setup =
        session.world().agree(Scene::parse("known", Path::new("."), text, overrides).and_then(|scene| ScalarSetup::<D>::of(&scene)))?;
    let solution = Inclusions::new(session, setup)?.solve(&mut |_, _| {})?;
    Ok(match number {
        "scalar.value" => Some(solution.inclusions[0].value),
        "scalar.energy" => Some(solution.energy),
        "scalar.flux" => solution.mean_flux.map(|flux| flux[0]),
        _ => None,
    })
}

fn number_of_flow<const D: usize>(session: &Session, text: &str, overrides: &[String], number: &str) -> Result<Option<f64>> {
    let (suspension, solution) = solve::<D>(session, text, overrides)?;
    Ok(match number.split_once('.') {
        Some(("viscosity", "from_walls")) => viscosity(&suspension, &solution)?.from_walls,
        Some(("viscosity", "first_normal_difference")) => Some(viscosity(&suspension, &solution)?.normal.first),
        Some((word, place)) => {
            let (quantity, place) = (quantity_of(word), place.parse::<usize>().ok());
            let answers = CalibrationAnswer::all(&suspension, &solution)?;
            let answer = answers.into_iter().find(|answer| Some(answer.quantity) == quantity);
            answer.zip(place).and_then(|(answer, place)| answer.values.get(place).copied())
        }
        None => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_has_an_answer_or_a_row_and_is_one_that_can_be_read() {
        for text in FILES {
            let known = KnownScene::parse(text);
            let rows = text.lines().filter(|line| line.starts_with("#* ")).count();
            assert!(known.is_some() || rows > 0, "{text}");
            assert!(known.is_none_or(|scene| scene.read(1e-2).is_ok()), "{text}");
        }
        assert_eq!((known_scenes().len(), cases().len()), (38, 34));
    }
}
