//! The forces that a scene gives by expressions, read for bodies of its radii.

use crate::error::Result;
use crate::interaction::{BodyForceLaw, Expression, ForceRange, PairForceLaw};
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
        let remedy = "acts on bodies, and there are none; add [[bodies]]";
        return Err(scene.refuse("interactions[0].name", format!("{:?}", first.name), remedy));
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
        match &section.force {
            ForceTexts::Pair { force, reach } => {
                let expression = self.expression(section, &key("pair_force"), force)?;
                let law = PairForceLaw::new(section.name.clone(), expression, *reach, radii);
                let remedy = "bound it, for example by max(gap, 1e-3) in place of gap";
                law.map(ForceLaw::Pair).map_err(|why| self.refuse(&key("pair_force"), shown([force]), &format!("{why}; {remedy}")))
            }
            ForceTexts::Body { force, torque } => {
                let range = self.force_range(radii);
                let [forces, torques] = [("body_force", force), ("torque", torque)].map(|(name, texts)| {
                    let of = |place| if texts.len() == 1 { key(name) } else { format!("{}[{place}]", key(name)) };
                    (0..).zip(texts).map(|(place, text)| self.expression(section, &of(place), text)).collect::<Result<Vec<_>>>()
                });
                let unbounded = |name: &str, texts: &[String], why: String| {
                    self.refuse(&key(name), shown(texts), &format!("{why}; bound it, for example by max or min"))
                };
                let law = BodyForceLaw::new(section.name.clone(), forces?, &range).map_err(|why| unbounded("body_force", force, why))?;
                law.with_torque(torques?, &range).map(ForceLaw::Body).map_err(|why| unbounded("torque", torque, why))
            }
        }
    }

    fn expression(&self, section: &InteractionSection, key: &str, text: &str) -> Result<Expression> {
        let expression = Expression::parse(text, &section.force.variables(self.dimension()), &section.constants);
        expression.map_err(|why| self.refuse(key, format!("{text:?}"), &why))
    }

    /// Where bodies of these radii may be, and how long.
    fn force_range(&self, radii: [f64; 2]) -> ForceRange {
        let ends = |(&size, axis): (&f64, &AxisSection)| {
            if *axis == AxisSection::Periodic { [0.0, size] } else { [radii[0], size - radii[0]] }
        };
        ForceRange { ends: self.domain.size.iter().zip(&self.domain.axes).map(ends).collect(), radii, end: self.end() }
    }
}

/// Expressions as a scene file writes them.
fn shown<'a>(texts: impl IntoIterator<Item = &'a String>) -> String {
    let texts: Vec<&String> = texts.into_iter().collect();
    if let [text] = texts[..] { format!("{text:?}") } else { format!("{texts:?}") }
}
