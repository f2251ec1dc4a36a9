//! What speeds in pictures are measured by.

use crate::scene::{AxisSection, Drive, Motion, Scene};

/// Speeds below this part of what moves bodies and fluid are those of a system at rest.
const REST: f64 = 1e-5;

/// A speed that a scene sets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedScale {
    /// The speed by which others are divided; 1 where the scene sets none.
    pub unit: f64,
    /// What it is.
    pub words: &'static str,
    /// A rate by which vorticities are divided, and what it is.
    pub rate: (f64, &'static str),
    /// The least speed, in the same unit, that colours show: what is slower is at rest.
    pub least: f64,
}

/// Where the scene sets no speed.
const PLAIN: &str = "units of the scene";

impl SpeedScale {
    /// That of a scene.
    pub fn of(scene: &Scene) -> SpeedScale {
        let set = set_by_walls(scene).or_else(|| set_by_drive(scene)).or_else(|| set_by_bodies(scene));
        // what slides along walls without a fluid has no rate
        let (unit, words) = set.filter(|(_, words)| !(scene.dry() && *words == SHEARED)).unwrap_or((1.0, PLAIN));
        let sheared = words == SHEARED;
        let height = scene.domain.size[if scene.dimension() == 3 { scene.plane_of_pictures()[1] } else { 1 }];
        let rate = if sheared { (unit / height, "rate") } else { (1.0, PLAIN) };
        let fastest = set.map_or_else(|| driven_by_forces(scene), |(speed, _)| speed);
        SpeedScale { unit, words, rate, least: REST * fastest / unit }
    }

    /// The name of a quantity that is divided by a unit.
    pub fn name(quantity: &str, words: &str) -> String {
        if words == PLAIN { format!("{quantity} ({PLAIN})") } else { format!("{quantity} / {words}") }
    }
}

const SHEARED: &str = "(rate \u{d7} height)";

/// The difference of the velocities of two walls, if they differ.
fn set_by_walls(scene: &Scene) -> Option<(f64, &'static str)> {
    let difference = |section: &AxisSection| match section {
        AxisSection::Walls { lower, upper } => lower.iter().zip(upper).map(|(one, other)| (one - other).powi(2)).sum::<f64>().sqrt(),
        _ => 0.0,
    };
    let largest = scene.domain.axes.iter().map(difference).fold(0.0, f64::max);
    let open = scene.domain.axes.iter().find_map(|section| match section {
        AxisSection::Open { inflow, .. } => Some((*inflow, "largest speed of the inflow")),
        _ => None,
    });
    if largest > 0.0 { Some((largest, SHEARED)) } else { open }
}

fn set_by_drive(scene: &Scene) -> Option<(f64, &'static str)> {
    let set = match scene.flow.drive.as_ref()? {
        Drive::ShearRate(protocol) | Drive::ShearedBox(protocol) => (protocol.fastest() * scene.domain.size[1], SHEARED),
        Drive::MeanVelocity(velocity) => (length(velocity), "mean velocity"),
        _ => return None,
    };
    (set.0 > 0.0).then_some(set)
}

/// The fastest body whose motion is given.
fn set_by_bodies(scene: &Scene) -> Option<(f64, &'static str)> {
    let speed = |motion: &Motion| if let Motion::Prescribed { velocity, .. } = motion { length(velocity) } else { 0.0 };
    let fastest = scene.bodies.iter().map(|group| speed(&group.motion)).fold(0.0, f64::max);
    (fastest > 0.0).then_some((fastest, "speed of the fastest body"))
}

/// About how fast forces drive bodies and fluid.
fn driven_by_forces(scene: &Scene) -> f64 {
    let (gravity, viscosity) = (scene.gravity.as_deref().map_or(0.0, length), scene.flow.viscosity);
    let longest = scene.domain.size.iter().copied().fold(0.0, f64::max);
    if scene.dry() {
        return (gravity * longest).sqrt();
    }
    let sinking = scene.bodies.iter().map(|group| {
        let weight = gravity * (group.density - scene.flow.density).abs() * group.radius * group.radius;
        weight.max(group.force.as_deref().map_or(0.0, length) / group.radius) / viscosity
    });
    let driven = match scene.flow.drive.as_ref() {
        Some(Drive::PressureGradient(vector) | Drive::BodyForce(vector)) => {
            scene.flow.drive_factor.fastest() * length(vector) * longest * longest / viscosity
        }
        _ => 0.0,
    };
    sinking.fold(driven, f64::max)
}

fn length(vector: impl AsRef<[f64]>) -> f64 {
    vector.as_ref().iter().map(|component| component * component).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheared_scene_measures_by_rate_and_height() {
        let mut scene = Scene::new("sheared", &[4.0, 3.0]);
        scene.flow.drive = Some(Drive::ShearRate(crate::geometry::Protocol::Steady(-2.0)));
        let scale = SpeedScale::of(&scene);
        assert_eq!((scale.unit, scale.words, scale.rate.0), (6.0, SHEARED, 2.0));
        assert_eq!(SpeedScale::name("speed |u|", scale.words), "speed |u| / (rate \u{d7} height)");
    }

    #[test]
    fn a_dry_scene_between_walls_that_slide_has_no_rate() {
        let mut scene = Scene::new("dry", &[4.0, 3.0]);
        scene.flow.model = crate::scene::FlowModel::None;
        scene.domain.axes[1] = AxisSection::Walls { lower: vec![0.0, 0.0], upper: vec![2.0, 0.0] };
        let scale = SpeedScale::of(&scene);
        assert_eq!((scale.unit, scale.words, scale.least), (1.0, PLAIN, 2.0 * REST));
    }

    #[test]
    fn a_scene_that_nothing_moves_is_in_its_own_units() {
        let scale = SpeedScale::of(&Scene::new("rest", &[4.0, 3.0]));
        assert_eq!((scale.unit, scale.least), (1.0, 0.0));
        assert_eq!(SpeedScale::name("speed |u|", scale.words), "speed |u| (units of the scene)");
    }
}
