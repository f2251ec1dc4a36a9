//! The number that a sweep reads from each run.

use std::{fs, path::Path};

use crate::{
    error::{Error, Result},
    experiment::summary::RunSummary,
    geometry::Protocol,
    output::{AXES, Columns, CurvePoint, MeanViscosity},
    run::columns,
    scene::{AxisSection, Drive, Motion, Scene},
    study::{
        cost::SceneProperties,
        sweep::reading::{Over, Reading, TimeMean},
    },
};

/// What is read.
#[derive(Debug, Clone, PartialEq)]
pub enum SweepQuantity {
    /// Relative viscosity: its mean over the steady part of a run in time.
    Viscosity,
    /// Magnitude of the mean force by the fluid on held bodies, at the end.
    Drag,
    /// Mean velocity of the bodies along gravity, or the force on them, in this direction.
    Settling(Vec<f64>),
    /// The mean of a column of `series.csv` over the second half of a run.
    Column(String),
    /// The last entry of a column of `series.csv`.
    Last(String),
    /// The number at a place of `summary.json`.
    Entry(String),
}

impl SweepQuantity {
    /// That of a word, or the one that the scene is about.
    ///
    /// # Errors
    /// [`Error::Refused`] if it has no meaning in the scene, or the scene is about none.
    pub fn of(word: Option<&str>, scene: &Scene) -> Result<SweepQuantity> {
        let free = scene.bodies.iter().all(|group| group.motion == Motion::Free);
        let Some(word) = word else {
            return match () {
                () if sheared(scene) && free => Ok(of_shear(scene)),
                () if !scene.dry() && !scene.scalar() && !free => Ok(SweepQuantity::Drag),
                () => settling(scene).map(SweepQuantity::Settling).ok_or_else(|| {
                    Error::refused(
                        "--quantity: the scene shears no suspension, holds no body and has no gravity; name a column of series.csv, as \
                         series.kinetic_energy, or a key of summary.json, as flow.mean_velocity.0",
                    )
                }),
            };
        };
        let refuse = |reason: &str| Err(Error::refused(format!("--quantity {word}: {reason}")));
        match word {
            "viscosity" if !(sheared(scene) && free) => refuse("belongs to free bodies in a shear; choose another"),
            "viscosity" if scene.changing_shear().is_some() => refuse(
                "has no mean where the rate of the shear changes; choose oscillation.complex_viscosity of one that oscillates, or last.viscosity",
            ),
            "viscosity" => Ok(SweepQuantity::Viscosity),
            "drag" if free || scene.dry() || scene.scalar() => refuse("no body is held in a flow; choose settling or another"),
            "drag" => Ok(SweepQuantity::Drag),
            "settling" => match settling(scene) {
                Some(direction) => Ok(SweepQuantity::Settling(direction)),
                None => refuse("belongs to free bodies under gravity or a force; choose another"),
            },
            _ => SweepQuantity::of_files(word, scene).or_else(refuse),
        }
    }

    /// A column of the series or a key of the summary of a scene's runs, or why there is none.
    fn of_files(word: &str, scene: &Scene) -> std::result::Result<SweepQuantity, &'static str> {
        match word.split_once('.') {
            Some(("series" | "last", _)) if scene.time.is_none() => Err("an instant has no series; choose a key of summary.json"),
            Some(("series", column)) => Ok(SweepQuantity::Column(column.to_owned())),
            Some(("last", column)) => Ok(SweepQuantity::Last(column.to_owned())),
            Some(_) => Ok(SweepQuantity::Entry(word.to_owned())),
            None if columns().iter().any(|column| column.name == word) && scene.time.is_some() => {
                Ok(SweepQuantity::Column(word.to_owned()))
            }
            None => Err(
                "must be viscosity, drag, settling, a column as series.kinetic_energy, its last entry as last.kinetic_energy, or a key of \
                 summary.json as flow.mean_velocity.0",
            ),
        }
    }

    /// Those of words, or the one that the scene is about.
    ///
    /// # Errors
    /// As [`of`](Self::of), or one stands there twice.
    pub fn all(words: &[String], scene: &Scene) -> Result<Vec<SweepQuantity>> {
        if words.is_empty() {
            return Ok(vec![SweepQuantity::of(None, scene)?]);
        }
        let all: Vec<SweepQuantity> = words.iter().map(|word| SweepQuantity::of(Some(word), scene)).collect::<Result<_>>()?;
        match (1..all.len()).find(|&place| all[..place].contains(&all[place])) {
            Some(place) => Err(Error::refused(format!("--quantity {}: stands there twice; name each quantity once", words[place]))),
            None => Ok(all),
        }
    }

    /// Its name: the word for it.
    pub fn name(&self) -> String {
        match self {
            SweepQuantity::Viscosity => "viscosity".into(),
            SweepQuantity::Drag => "drag".into(),
            SweepQuantity::Settling(_) => "settling".into(),
            SweepQuantity::Column(name) => format!("series.{name}"),
            SweepQuantity::Last(name) => format!("last.{name}"),
            SweepQuantity::Entry(name) => name.clone(),
        }
    }

    /// What it is, in words.
    pub fn words(&self, in_time: bool) -> String {
        match self {
            SweepQuantity::Viscosity if in_time => {
                "relative viscosity, its mean over the steady part of each run, or over the second half of all runs of a point where one is not steady"
                    .into()
            }
            SweepQuantity::Viscosity => "relative viscosity".into(),
            SweepQuantity::Drag if in_time => "magnitude of the mean force on bodies with prescribed motion at the end".into(),
            SweepQuantity::Drag => "magnitude of the mean force on bodies with prescribed motion".into(),
            SweepQuantity::Settling(_) if in_time => {
                "mean velocity of the bodies along the force on them, over the second half of each run".into()
            }
            SweepQuantity::Settling(_) => "mean velocity of the bodies along the force on them".into(),
            SweepQuantity::Column(name) => format!("{name} of series.csv, its mean over the second half of each run"),
            SweepQuantity::Last(name) => format!("{name} of series.csv at the end of each run"),
            SweepQuantity::Entry(name) => format!("{name} of summary.json"),
        }
    }

    /// Its value in a run that left this summary; nothing where the run has none, as the part of an effect that is off in it.
    ///
    /// # Errors
    /// A file cannot be read.
    pub fn read(&self, path: &Path, scene: &Scene) -> Result<Option<Reading>> {
        let summary = RunSummary::read(path)?;
        let series = path.with_file_name("series.csv");
        let last = if summary.in_time() { Over::End } else { Over::Instant };
        let found = match self {
            SweepQuantity::Viscosity => viscosity(&summary, &series)?,
            SweepQuantity::Drag => drag(&summary, &SceneProperties::of(scene)?.held).map(|value| Reading::of(value, last)),
            SweepQuantity::Settling(direction) if summary.in_time() => settled(direction, &Columns::read(&series)?),
            SweepQuantity::Settling(direction) => settling_now(&summary, direction).map(|value| Reading::of(value, last)),
            SweepQuantity::Column(name) => TimeMean::of_second_half(&Columns::read(&series)?.curve("time", name)).map(Reading::second_half),
            SweepQuantity::Last(name) => {
                Columns::read(&series)?.curve("time", name).last().map(|(_, value)| Reading::of(*value, Over::End))
            }
            SweepQuantity::Entry(name) => {
                summary.get(&format!("/{}", name.replace('.', "/"))).map(|value| Reading::of(value, Over::Summary))
            }
        };
        Ok(found.filter(|reading| reading.value.is_finite()))
    }
}

fn read(path: &Path) -> Result<String> {
    fs::read_to_string(path).map_err(|source| Error::File { path: path.to_owned(), source })
}

/// What a shear is about: where its rate changes, the answer to an oscillation, or the viscosity at the end.
fn of_shear(scene: &Scene) -> SweepQuantity {
    match scene.changing_shear() {
        None => SweepQuantity::Viscosity,
        Some(Protocol::Oscillation { .. }) => SweepQuantity::Entry("oscillation.complex_viscosity".to_owned()),
        Some(_) => SweepQuantity::Last("viscosity".to_owned()),
    }
}

fn sheared(scene: &Scene) -> bool {
    matches!(scene.flow.drive, Some(Drive::ShearRate(_) | Drive::ShearedBox(_))) || scene.domain.axes.iter().any(sliding)
}

/// Whether an axis ends at walls that move past each other.
fn sliding(axis: &AxisSection) -> bool {
    matches!(axis, AxisSection::Walls { lower, upper } if lower != upper)
}

/// The direction in which free bodies are pulled.
fn settling(scene: &Scene) -> Option<Vec<f64>> {
    if scene.scalar() || scene.bodies.is_empty() || scene.bodies.iter().any(|group| group.motion != Motion::Free) {
        return None;
    }
    let pull = scene.gravity.clone().or_else(|| scene.bodies.iter().find_map(|group| group.force.clone()))?;
    let size = pull.iter().map(|part| part * part).sum::<f64>().sqrt();
    (size > 0.0).then(|| pull.iter().map(|part| part / size).collect())
}

fn viscosity(summary: &RunSummary, series: &Path) -> Result<Option<Reading>> {
    let Some(relative) = summary.get("/viscosity/relative") else { return Ok(None) };
    if !summary.in_time() {
        return Ok(Some(Reading::of(relative, Over::Instant)));
    }
    // a negative rate shears as well
    let curve: Vec<(f64, f64)> = CurvePoint::read(&read(series)?).iter().map(|point| (point.strain.abs(), point.relative())).collect();
    let half = TimeMean::of_second_half(&curve).unwrap_or(TimeMean { value: relative, spread: None });
    Ok(Some(match summary.get::<MeanViscosity>("/viscosity/mean") {
        Some(mean) => Reading::steady(mean.relative, (mean.half_width(), mean.blocks), half),
        None => Reading::second_half(half),
    }))
}

fn drag(summary: &RunSummary, held: &[bool]) -> Option<f64> {
    let mean = summary.mean_of_bodies("force", (0..held.len()).filter(|&body| held[body]))?;
    Some(mean.iter().map(|part| part * part).sum::<f64>().sqrt())
}

fn settling_now(summary: &RunSummary, direction: &[f64]) -> Option<f64> {
    Some(along(direction, &summary.mean_of_bodies("velocity", 0..summary.0["bodies"].as_array()?.len())?))
}

fn settled(direction: &[f64], series: &Columns) -> Option<Reading> {
    let names = AXES.iter().map(|axis| format!("body_velocity_{axis}"));
    let components: Vec<_> = names.take(direction.len()).map(|name| series.curve("time", &name)).collect();
    let rows = 0..components.iter().map(Vec::len).min()?;
    let settled = |row: usize| along(direction, &components.iter().map(|component| component[row].1).collect::<Vec<_>>());
    let curve: Vec<(f64, f64)> = rows.map(|row| (components[0][row].0, settled(row))).collect();
    TimeMean::of_second_half(&curve).map(Reading::second_half)
}

fn along(direction: &[f64], vector: &[f64]) -> f64 {
    direction.iter().zip(vector).map(|(one, other)| one * other).sum()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const BOX: &str = "domain.size = [4, 4]\nresolution.spacing = 0.125\n";
    const DISK: &str = "[[bodies]]\nradius = 0.5\ncenters = [[1, 1]]\n";

    fn scene(before: &str, after: &str) -> Scene {
        Scene::parse("scene", Path::new(""), &format!("{before}{BOX}{DISK}{after}"), &[]).unwrap()
    }

    #[test]
    fn the_scene_chooses_the_quantity_and_words_without_a_meaning_are_refused() {
        let shear = scene("", "[flow]\ndrive = { shear_rate = 1 }\n");
        let held = scene("", "motion = \"fixed\"\n[flow]\ndrive = { mean_velocity = [1, 0] }\n");
        let falling = scene("gravity = [0, -2]\n", "density = 2\n");
        assert_eq!(SweepQuantity::of(None, &shear).unwrap(), SweepQuantity::Viscosity);
        assert_eq!(SweepQuantity::of(None, &held).unwrap(), SweepQuantity::Drag);
        assert_eq!(SweepQuantity::of(None, &falling).unwrap(), SweepQuantity::Settling(vec![0.0, -1.0]));
        let protocol = |rate: &str| scene("domain.y = \"walls\"\ntime.end = 1\n", &format!("[flow]\ndrive = {{ shear_rate = {rate} }}\n"));
        let oscillating = protocol("{ amplitude = 0.1, frequency = 1 }");
        assert_eq!(SweepQuantity::of(None, &oscillating).unwrap(), SweepQuantity::Entry("oscillation.complex_viscosity".into()));
        assert_eq!(
            SweepQuantity::of(None, &protocol("[{ until = 1, rate = 1 }, { rate = -1 }]")).unwrap(),
            SweepQuantity::Last("viscosity".into())
        );
        assert!(
            SweepQuantity::of(Some("viscosity"), &oscillating).unwrap_err().to_string().contains("choose oscillation.complex_viscosity")
        );
        assert_eq!(SweepQuantity::of(Some("flow.mean_velocity.0"), &shear).unwrap(), SweepQuantity::Entry("flow.mean_velocity.0".into()));
        assert_eq!(SweepQuantity::of(Some("first_normal_difference"), &oscillating).unwrap().name(), "series.first_normal_difference");
        let twice = ["contacts", "series.contacts"].map(str::to_owned);
        assert!(SweepQuantity::all(&twice, &oscillating).unwrap_err().to_string().contains("series.contacts: stands there twice"));
        for (word, scene) in
            [("contacts", &shear), ("drag", &shear), ("settling", &shear), ("viscosity", &held), ("weight", &held), ("series.time", &held)]
        {
            let refusal = SweepQuantity::of(Some(word), scene).unwrap_err().to_string();
            assert!(refusal.starts_with(&format!("--quantity {word}: ")), "{refusal}");
        }
        assert!(SweepQuantity::of(None, &scene("", "")).unwrap_err().to_string().contains("name a column"));
    }

    #[test]
    fn a_column_is_averaged_over_the_second_half_by_time() {
        let series = Columns::parse("step,time,a\n0,0.0,9\n1,1.0,1\n2,1.5,1\n3,2.0,3\n");
        let mean = |name: &str| TimeMean::of_second_half(&series.curve("time", name));
        assert_eq!(mean("a"), Some(TimeMean { value: 1.5, spread: None }));
        assert_eq!(mean("b"), None);
    }

    #[test]
    fn a_viscosity_without_a_steady_part_is_that_of_the_second_half_and_says_so() {
        let path = std::env::temp_dir().join(format!("turbid-quantity-{}.csv", std::process::id()));
        for sign in [1.0, -1.0] {
            let rows: String = [0.0, 1.0, 1.5, 2.0]
                .iter()
                .zip([9.0, 1.0, 1.0, 3.0])
                .map(|(strain, value)| format!("{},{value}\n", sign * strain))
                .collect();
            fs::write(&path, format!("strain,viscosity_hydrodynamic\n{rows}")).unwrap();
            let summary = RunSummary(serde_json::json!({"time": 2.0, "motion": {}, "viscosity": {"relative": 3.0}}));
            let reading = viscosity(&summary, &path).unwrap().unwrap();
            assert_eq!(reading, Reading::second_half(TimeMean { value: 1.5, spread: None }));
        }
        fs::remove_file(path).unwrap();
    }

    #[test]
    fn drag_is_of_held_bodies_and_settling_along_the_force() {
        let body = |force: f64| serde_json::json!({"force": [force, 4.0], "velocity": [1.0, -2.0]});
        let summary = RunSummary(serde_json::json!({"bodies": [body(2.0), body(100.0), body(4.0)]}));
        assert_eq!(drag(&summary, &[true, false, true]), Some(5.0));
        assert_eq!(settling_now(&summary, &[0.0, -1.0]), Some(2.0));
    }
}
