//! What a pressure on a wall demands of a scene.

use super::{
    AxisSection, ContactModel, FlowModel, Motion, NormalLoad, Scene,
    demand::{expect, name, walled},
};
use crate::error::Result;

const KEY: &str = "domain.normal_stress";

/// Refuses a pressure on a wall that cannot be, and bodies that are fixed to a wall that no pressure moves.
pub(super) fn check(scene: &Scene) -> Result<()> {
    let Some(NormalLoad { stress, wall_mass }) = scene.domain.load else { return check_no_wall(scene) };
    let refused = |right: bool, remedy: &str| expect(scene, right, KEY, stress, remedy);
    let remedy = "moves a wall, and the volume of a fluid between impermeable walls cannot change; remove it, or set flow.model = \"none\"";
    refused(!scene.flow.model.fluid(), remedy)?;
    refused(scene.flow.model == FlowModel::None, "presses dry bodies; set flow.model = \"none\" or remove it")?;
    let walls: Vec<usize> = walled(scene).filter(|&axis| matches!(scene.domain.axes[axis], AxisSection::Walls { .. })).collect();
    if walls.len() != 1 {
        let names: Vec<&str> = walls.iter().map(|&axis| name(axis)).collect();
        let found = if names.is_empty() { "none has".to_owned() } else { format!("{} have", names.join(" and ")) };
        return refused(
            false,
            &format!("presses the upper wall across the one axis that has walls, and {found}; set domain.y = \"walls\" alone"),
        );
    }
    refused(scene.contact.model == ContactModel::Inelastic, "presses bodies where they touch; set contact.model = \"inelastic\"")?;
    let tied = scene.bodies.iter().find(|group| group.together());
    let remedy = tied.map_or(String::new(), |group| format!("presses bodies that are alone; remove {} or it", group.section()));
    refused(tied.is_none(), &remedy)?;
    refused(scene.interactions.is_empty(), "does not know forces at a distance on what is fixed to the wall; remove interactions or it")?;
    let free = scene.bodies.iter().any(|group| group.motion == Motion::Free);
    refused(
        free || wall_mass.is_some(),
        "presses a wall with the mass of a layer of free bodies, and there are none; give domain.wall_mass",
    )
}

/// Refuses bodies that are fixed to a wall that no pressure moves.
fn check_no_wall(scene: &Scene) -> Result<()> {
    let Some(group) = scene.bodies.iter().position(|group| group.motion == Motion::Wall) else { return Ok(()) };
    let remedy = "is that of the wall that domain.normal_stress presses; give that, or write \"fixed\" or { velocity = [..] }";
    Err(scene.refuse(&format!("{}.motion", scene.group_key(group)), "\"wall\"", remedy))
}
