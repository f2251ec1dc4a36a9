//! The forces that a scene gives by expressions, read for bodies of its radii.

use crate::error::Result;
use crate::interaction::{BodyForceLaw, Expression, PairForceLaw, Region};
use crate::scene::{AxisSection, ConstraintMethod, ForceTexts, InteractionSection, Scene};

/// A force that a scene gives by expressions.
#[derive(Debug, Clone, PartialEq)]
pub enum ForceLaw {
    /// Between two bodies.
    Pair(PairForceLaw),
    /// On single bodies.
    Body(BodyForceLaw),
}

/// Refuses expressions that cannot be read or evaluated, and forces where nothing follows them.
pub(super) fn check(scene: &Scene) -> Result<()> {
    let Some(first) = scene.interactions.first() else { return Ok(()) };
    if scene.method.constraint == ConstraintMethod::Fitted {
        let remedy = "supports no [[interactions]]; set method.constraint = \"sharp\"";
        return Err(scene.refuse("method.constraint", "\"fitted\"", remedy));
    }
    if scene.bodies.is_empty() {
        let key = format!("interactions[0].{}", first.force.key());
        return Err(scene.refuse(&key, first.force.shown(), "acts on bodies, and there are none; add [[bodies]]"));
    }
    let radii = scene.bodies.iter().map(|group| group.radius);
    scene.force_laws([radii.clone().fold(f64::INFINITY, f64::min), radii.fold(0.0, f64::max)]).map(drop)
}

impl Scene {
    /// The forces of `[[interactions]]` on bodies of which these are the smallest and the largest radius.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::error::Error::Refused) with the key of an expression that cannot be read, or is not finite where bodies may be.
    pub fn force_laws(&self, radii: [f64; 2]) -> Result<Vec<ForceLaw>> {
        (0..).zip(&self.interactions).map(|(number, section)| self.force_law(number, section, radii)).collect()
    }

    fn force_law(&self, number: usize, section: &InteractionSection, radii: [f64; 2]) -> Result<ForceLaw> {
        let key = |name: &str| format!("interactions[{number}].{name}");
        let unbounded =
            |why: String, remedy: &str| self.refuse(&key(section.force.key()), section.force.shown(), &format!("{why}; {remedy}"));
        let expression = |key: String, text: &String| self.expression(section, &key, text);
        match &section.force {
            ForceTexts::Pair { force, reach } => {
                let law = PairForceLaw::new(section.name.clone(), expression(key("pair_force"), force)?, *reach, radii);
                law.map(ForceLaw::Pair).map_err(|why| unbounded(why, "bound it, for example by max(gap, 1e-3) in place of gap"))
            }
            ForceTexts::Body { force, torque } => {
                let at = |name: &str, place: usize| format!("{}[{place}]", key(name));
                let force = (0..).zip(force).map(|(place, text)| expression(at("body_force", place), text)).collect::<Result<_>>()?;
                let of_torque = |place| if torque.len() == 1 { key("torque") } else { at("torque", place) };
                let torque = (0..).zip(torque).map(|(place, text)| expression(of_torque(place), text)).collect::<Result<_>>()?;
                let law = BodyForceLaw::new(section.name.clone(), [force, torque], &self.region(radii));
                law.map(ForceLaw::Body).map_err(|why| unbounded(why, "bound it, for example by max or min"))
            }
        }
    }

    fn expression(&self, section: &InteractionSection, key: &str, text: &str) -> Result<Expression> {
        let expression = Expression::parse(text, &section.force.variables(self.dimension()), &section.constants);
        expression.map_err(|why| self.refuse(key, format!("{text:?}"), &why))
    }

    /// Where bodies of these radii may be, and how long.
    fn region(&self, radii: [f64; 2]) -> Region {
        let ends = |(&size, axis): (&f64, &AxisSection)| {
            if *axis == AxisSection::Periodic { [0.0, size] } else { [radii[0], size - radii[0]] }
        };
        Region { ends: self.domain.size.iter().zip(&self.domain.axes).map(ends).collect(), radii, end: self.end() }
    }
}

impl ForceTexts {
    /// It as messages repeat it.
    fn shown(&self) -> String {
        match self {
            ForceTexts::Pair { force, .. } => format!("{force:?}"),
            ForceTexts::Body { force, .. } => format!("{force:?}"),
        }
    }
}
