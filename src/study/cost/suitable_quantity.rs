//! Which quantity suits a scene, and what is refused because it has no meaning there.

use super::{
    metric::Metric,
    options::CostStudy,
    properties::SceneProperties,
    quantity::{CostQuantity, QuantityKind, WORDS},
};
use crate::{
    error::{Error, Result},
    scene::{Drive, FlowModel, Scene},
};

/// Points along each axis of a lattice for fields, in 2D and 3D.
const PROBE: [usize; 2] = [48, 16];

impl Metric {
    /// The quantity that is asked for, or the one that suits the scene.
    ///
    /// # Errors
    /// It has no meaning in this scene, or the true values that are given cannot be its own.
    pub fn of(options: &CostStudy, scene: &Scene) -> Result<Metric> {
        let properties = SceneProperties::of(scene)?;
        let metric = Metric { quantity: properties.quantity(options, scene)?, properties };
        metric.check_exact(options)?;
        Ok(metric)
    }
}

impl SceneProperties {
    fn quantity(&self, options: &CostStudy, scene: &Scene) -> Result<CostQuantity> {
        let kind = match &options.quantity {
            Some(word) => self.named(word, scene)?,
            None => self.suitable(scene),
        };
        let probe = kind.of_field().then(|| options.probe.unwrap_or(PROBE[self.dimension - 2]));
        match options.body {
            Some(body) if !kind.of_bodies() => {
                Err(Error::refused(format!("--body {body}: {} is not that of a body; leave the flag out", kind.word())))
            }
            Some(body) if body >= self.held.len() => {
                Err(Error::refused(format!("--body {body}: must be below the number of bodies, {}", self.held.len())))
            }
            body => Ok(CostQuantity { kind, body, probe }),
        }
    }

    fn suitable(&self, scene: &Scene) -> QuantityKind {
        match &scene.flow.drive {
            _ if scene.scalar() => QuantityKind::Value,
            _ if self.held.is_empty() => QuantityKind::Field,
            Some(Drive::ShearRate(_) | Drive::ShearedBox(_)) if !self.held.contains(&true) => QuantityKind::Viscosity,
            drive if self.steady && has_resistance(drive.as_ref()) => QuantityKind::Resistance,
            _ if scene.time.is_some() && !self.all_held() => QuantityKind::Position,
            _ if self.held.contains(&true) => QuantityKind::Drag,
            _ => QuantityKind::Velocity,
        }
    }

    fn named(&self, word: &str, scene: &Scene) -> Result<QuantityKind> {
        let Some(&(_, kind)) = WORDS.iter().find(|(name, _)| *name == word) else {
            let names = WORDS.map(|(name, _)| name).join(", ");
            return Err(Error::refused(format!("--quantity {word}: must be one of {names}")));
        };
        let refuse = |reason: &str| Err(Error::refused(format!("--quantity {word}: {reason}")));
        let drive = scene.flow.drive.as_ref();
        match kind {
            QuantityKind::Value | QuantityKind::Energy if !scene.scalar() => refuse("belongs to scenes with flow.model = \"scalar\""),
            kind if scene.scalar() && kind.of_flow() => refuse("a scalar has no flow; choose value, energy, field or gradient"),
            QuantityKind::Resistance if !has_resistance(drive) => refuse(
                "is that of a flow with flow.drive = { mean_velocity = [..] } or { pressure_gradient = [..] } other than zero; choose drag",
            ),
            QuantityKind::MeanVelocity if !matches!(drive, Some(Drive::PressureGradient(_) | Drive::BodyForce(_))) => {
                refuse("answers to flow.drive = { pressure_gradient = [..] } or { body_force = [..] }; choose resistance, drag or velocity")
            }
            QuantityKind::Reynolds if scene.flow.model != FlowModel::NavierStokes => {
                refuse("belongs to scenes with flow.model = \"navier-stokes\"; choose velocity")
            }
            QuantityKind::Drag if !self.held.contains(&true) => refuse("no body is held; choose velocity"),
            QuantityKind::Position if scene.time.is_none() => {
                refuse("nothing moves at an instant; add [time] to the scene or choose velocity")
            }
            QuantityKind::Reynolds | QuantityKind::Velocity | QuantityKind::Position if self.all_held() => {
                refuse("no body is free; choose drag")
            }
            _ if (kind.of_bodies() || kind == QuantityKind::Reynolds) && self.held.is_empty() => {
                refuse("there are no bodies; choose field")
            }
            kind => Ok(kind),
        }
    }
}

/// Whether a drive makes a flow whose pressure gradient and mean velocity are not zero.
fn has_resistance(drive: Option<&Drive>) -> bool {
    match drive {
        Some(Drive::MeanVelocity(vector) | Drive::PressureGradient(vector)) => vector.iter().any(|component| *component != 0.0),
        _ => false,
    }
}

impl Metric {
    /// Refuses true values that cannot be those of the quantity: there are more or fewer than it has, or it has none that could be given.
    fn check_exact(&self, options: &CostStudy) -> Result<()> {
        let (given, word) = (options.exact.len(), self.quantity.kind.word());
        if given == 0 {
            let lonely = options.uncertainty > 0.0;
            let remedy = "says how far --exact may be off; give that too or leave the flag out";
            return if lonely { Err(Error::refused(format!("--uncertainty {}: {remedy}", options.uncertainty))) } else { Ok(()) };
        }
        if self.quantity.kind.of_field() {
            return Err(Error::refused(format!("--exact: a {word} has no values to give; leave the flag out")));
        }
        let wanted = self.count();
        match given == wanted {
            true => Ok(()),
            false => Err(Error::refused(format!("--exact: has {given} numbers, but the {word} has {wanted}; --body chooses one body"))),
        }
    }

    /// Numbers that the quantity has.
    fn count(&self) -> usize {
        let (dimension, bodies) = (self.properties.dimension, if self.quantity.body.is_some() { 1 } else { self.properties.held.len() });
        match self.quantity.kind {
            QuantityKind::Value => bodies,
            QuantityKind::Position => bodies * dimension,
            QuantityKind::Velocity => bodies * dimension * (dimension + 1) / 2,
            _ => 1,
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::study::cost::properties::tests::suits;

    fn chosen(extra: &str, options: &CostStudy) -> std::result::Result<QuantityKind, String> {
        let (scene, properties) = suits(extra);
        properties.quantity(options, &scene).map(|quantity| quantity.kind).map_err(|error| error.to_string())
    }

    #[test]
    fn the_scene_chooses_the_quantity() {
        let default = CostStudy::default();
        assert_eq!(chosen("motion = \"fixed\"\n[flow]\ndrive = { mean_velocity = [1, 0] }\n", &default), Ok(QuantityKind::Drag));
        assert_eq!(chosen("[flow]\ndrive = { shear_rate = 1 }\n", &default), Ok(QuantityKind::Viscosity));
        assert_eq!(chosen("force = [1.0, 0.0]\n", &default), Ok(QuantityKind::Velocity));
        assert_eq!(chosen("force = [1.0, 0.0]\n[time]\nend = 1\n", &default), Ok(QuantityKind::Position));
        let inertia = |drive: &str| format!("motion = \"fixed\"\n[flow]\nmodel = \"navier-stokes\"\ndensity = 1\n{drive}[time]\nend = 1\n");
        assert_eq!(chosen(&inertia("drive = { mean_velocity = [1, 0] }\n"), &default), Ok(QuantityKind::Resistance));
        assert_eq!(chosen(&inertia("drive = { mean_velocity = [0, 0] }\n"), &default), Ok(QuantityKind::Drag));
    }

    #[test]
    fn a_quantity_without_a_meaning_is_refused() {
        let asked = |word: &str, body| CostStudy { quantity: Some(word.into()), body, ..CostStudy::default() };
        assert_eq!(chosen("", &asked("drag", None)), Err("--quantity drag: no body is held; choose velocity".into()));
        assert!(chosen("", &asked("weight", None)).unwrap_err().starts_with("--quantity weight: must be one of drag, viscosity"));
        assert!(chosen("", &asked("position", None)).unwrap_err().contains("nothing moves at an instant"));
        assert!(chosen("", &asked("value", None)).unwrap_err().contains("flow.model = \"scalar\""));
        assert!(chosen("", &asked("resistance", None)).unwrap_err().contains("other than zero; choose drag"));
        assert!(chosen("", &asked("mean-velocity", None)).unwrap_err().contains("answers to flow.drive"));
        assert!(chosen("", &asked("reynolds", None)).unwrap_err().contains("flow.model = \"navier-stokes\"; choose velocity"));
        let held = chosen("motion = \"fixed\"\n", &asked("velocity", None));
        assert_eq!(held, Err("--quantity velocity: no body is free; choose drag".into()));
        assert_eq!(chosen("", &asked("velocity", Some(1))), Err("--body 1: must be below the number of bodies, 1".into()));
        assert!(chosen("", &asked("field", Some(0))).unwrap_err().contains("leave the flag out"));
    }
}
