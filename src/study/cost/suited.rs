//! Which quantity suits a scene, and what is refused because it has no meaning there.

use super::{
    CostOptions,
    facts::Facts,
    quantity::{Kind, Quantity, WORDS},
};
use crate::{
    error::{Error, Result},
    scene::{Drive, Scene},
};

/// Points along each axis of a lattice for fields, in 2D and 3D.
const PROBE: [usize; 2] = [48, 16];

impl Facts {
    /// The quantity that is asked for, or the one that suits the scene.
    ///
    /// # Errors
    /// It has no meaning in this scene.
    pub fn quantity(&self, options: &CostOptions, scene: &Scene) -> Result<Quantity> {
        let kind = match &options.quantity {
            Some(word) => self.named(word, scene)?,
            None => self.suitable(scene),
        };
        let probe = kind.of_field().then(|| options.probe.unwrap_or(PROBE[self.dimension - 2]));
        match options.body {
            Some(body) if !kind.of_bodies() => {
                Err(Error::refused(format!("--body {body}: {} is not that of a body; leave the flag out", kind.word())))
            }
            Some(body) if body >= self.bodies => {
                Err(Error::refused(format!("--body {body}: must be below the number of bodies, {}", self.bodies)))
            }
            body => Ok(Quantity { kind, body, probe }),
        }
    }

    fn suitable(&self, scene: &Scene) -> Kind {
        match &scene.flow.drive {
            _ if scene.scalar() => Kind::Value,
            _ if self.bodies == 0 => Kind::Field,
            Some(Drive::ShearRate(_) | Drive::ShearedBox(_)) if !self.held.contains(&true) => Kind::Viscosity,
            _ if scene.time.is_some() => Kind::Position,
            _ if self.held.contains(&true) => Kind::Drag,
            _ => Kind::Velocity,
        }
    }

    fn named(&self, word: &str, scene: &Scene) -> Result<Kind> {
        let Some(&(_, kind)) = WORDS.iter().find(|(name, _)| *name == word) else {
            let names = WORDS.map(|(name, _)| name).join(", ");
            return Err(Error::refused(format!("--quantity {word}: must be one of {names}")));
        };
        let refuse = |reason: &str| Err(Error::refused(format!("--quantity {word}: {reason}")));
        match kind {
            Kind::Value | Kind::Energy if !scene.scalar() => refuse("belongs to scenes with flow.model = \"scalar\""),
            Kind::Drag | Kind::Viscosity | Kind::Velocity | Kind::Position if scene.scalar() => {
                refuse("a scalar has no flow; choose value, energy, field or gradient")
            }
            Kind::Drag if !self.held.contains(&true) => refuse("no body is held; choose velocity"),
            Kind::Position if scene.time.is_none() => refuse("nothing moves at an instant; add [time] to the scene or choose velocity"),
            _ if kind.of_bodies() && self.bodies == 0 => refuse("there are no bodies; choose field"),
            kind => Ok(kind),
        }
    }

    /// Refuses true values that cannot be those of the quantity.
    ///
    /// # Errors
    /// There are more or fewer than it has, or it has none that could be given.
    pub fn check_exact(&self, options: &CostOptions, quantity: &Quantity) -> Result<()> {
        let (given, word) = (options.exact.len(), quantity.kind.word());
        if given == 0 {
            let lonely = options.uncertainty > 0.0;
            let remedy = "says how far --exact may be off; give that too or leave the flag out";
            return if lonely { Err(Error::refused(format!("--uncertainty {}: {remedy}", options.uncertainty))) } else { Ok(()) };
        }
        if quantity.kind.of_field() {
            return Err(Error::refused(format!("--exact: a {word} has no values to give; leave the flag out")));
        }
        let wanted = self.count(quantity);
        match given == wanted {
            true => Ok(()),
            false => Err(Error::refused(format!("--exact: has {given} numbers, but the {word} has {wanted}; --body chooses one body"))),
        }
    }

    fn count(&self, quantity: &Quantity) -> usize {
        let bodies = if quantity.body.is_some() { 1 } else { self.bodies };
        match quantity.kind {
            Kind::Value => bodies,
            Kind::Position => bodies * self.dimension,
            Kind::Velocity => bodies * self.dimension * (self.dimension + 1) / 2,
            _ => 1,
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::study::cost::facts::tests::suits;

    fn chosen(extra: &str, options: &CostOptions) -> std::result::Result<Kind, String> {
        let (scene, facts) = suits(extra);
        facts.quantity(options, &scene).map(|quantity| quantity.kind).map_err(|error| error.to_string())
    }

    #[test]
    fn the_scene_chooses_the_quantity() {
        let default = CostOptions::default();
        assert_eq!(chosen("motion = \"fixed\"\n[flow]\ndrive = { mean_velocity = [1, 0] }\n", &default), Ok(Kind::Drag));
        assert_eq!(chosen("[flow]\ndrive = { shear_rate = 1 }\n", &default), Ok(Kind::Viscosity));
        assert_eq!(chosen("force = [1.0, 0.0]\n", &default), Ok(Kind::Velocity));
        assert_eq!(chosen("force = [1.0, 0.0]\n[time]\nend = 1\n", &default), Ok(Kind::Position));
    }

    #[test]
    fn a_quantity_without_a_meaning_is_refused() {
        let asked = |word: &str, body| CostOptions { quantity: Some(word.into()), body, ..CostOptions::default() };
        assert_eq!(chosen("", &asked("drag", None)), Err("--quantity drag: no body is held; choose velocity".into()));
        assert!(chosen("", &asked("weight", None)).unwrap_err().starts_with("--quantity weight: must be one of drag, viscosity"));
        assert!(chosen("", &asked("position", None)).unwrap_err().contains("nothing moves at an instant"));
        assert!(chosen("", &asked("value", None)).unwrap_err().contains("flow.model = \"scalar\""));
        assert_eq!(chosen("", &asked("velocity", Some(1))), Err("--body 1: must be below the number of bodies, 1".into()));
        assert!(chosen("", &asked("field", Some(0))).unwrap_err().contains("leave the flag out"));
    }
}
