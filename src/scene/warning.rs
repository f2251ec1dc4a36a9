//! What can be run, and is seldom meant.

use super::{AxisSection, BodyGroup, ContactModel, ForceTexts, Motion, Scene};

impl Scene {
    /// What a user should know before a run of it.
    pub fn warning(&self) -> Option<&'static str> {
        let walled = self.domain.axes.iter().any(|axis| matches!(axis, AxisSection::Walls { .. }));
        let untouched = self.dry() && walled && self.contact.model == ContactModel::None;
        let held = self.interactions.iter().any(|interaction| matches!(interaction.force, ForceTexts::Body { .. }));
        let driven = self.bodies.iter().any(|bodies| self.drives(bodies));
        (untouched && driven && !held)
            .then_some("bodies pass through walls without contact.model; set contact.model = \"inelastic\" to keep them inside")
    }

    /// Whether free bodies of a group have a weight, a force or a velocity.
    fn drives(&self, bodies: &BodyGroup) -> bool {
        let vectors = [&self.gravity, &bodies.force, &bodies.velocity];
        let acts = vectors.into_iter().flatten().flatten().any(|&component| component != 0.0);
        bodies.motion == Motion::Free && acts
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use super::*;

    const DRY: &str = "gravity = [0.0, -1.0]\n[domain]\nsize = [8.0, 8.0]\ny = \"walls\"\n[flow]\nmodel = \"none\"\n[time]\nend = 1.0\n\
        [[bodies]]\nradius = 1.0\ndensity = 1.0\ncount = 2\n";

    fn warns(overrides: &[&str]) -> bool {
        let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
        Scene::parse("scene", Path::new(""), DRY, &overrides).unwrap().warning().is_some()
    }

    #[test]
    fn bodies_that_fall_into_walls_without_contact_are_warned_of() {
        assert!(warns(&[]) && warns(&["gravity=[0, 0]", "bodies.0.velocity=[0, 1]"]));
        for quiet in ["contact.model=inelastic", "domain.y=periodic", "gravity=[0, 0]", "bodies.0.motion=fixed"] {
            assert!(!warns(&[quiet]), "{quiet}");
        }
        assert!(!warns(&["interactions=[{ body_force = [\"0\", \"1 - y\"] }]"]));
    }
}
