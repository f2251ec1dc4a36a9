//! What a scene must be for its balance of energy to be known.

use super::{AxisSection, ConstraintMethod, ContactModel, Drive, FlowModel, Motion, Scene};
use crate::error::Result;

/// Refuses `output.energy` where a term of the balance is not measured.
pub(super) fn check(scene: &Scene) -> Result<()> {
    if !scene.output.energy {
        return Ok(());
    }
    let expect = |right: bool, remedy: &str| if right { Ok(()) } else { Err(scene.refuse("output.energy", "true", remedy)) };
    let inertia = scene.flow.model == FlowModel::NavierStokes;
    expect(inertia && scene.time.is_some(), "is the balance of a flow with inertia; set flow.model = \"navier-stokes\", or remove it")?;
    let sharp = scene.method.constraint == ConstraintMethod::Sharp;
    expect(sharp, "needs the slopes of the flow at surfaces; set method.constraint = \"sharp\", or remove it")?;
    let bonds = scene.bodies.iter().any(|bodies| bodies.chain.is_some());
    expect(!bonds, "does not count what bonds store; remove it, or [[chains]] and [[cells]]")?;
    expect(scene.interactions.is_empty(), "does not count the work of forces by expressions; remove it, or [[interactions]]")?;
    let hard = matches!(scene.contact.model, ContactModel::None | ContactModel::Inelastic | ContactModel::Gluey { .. });
    expect(hard, "does not count what forces at a distance store; set contact.model = \"inelastic\", or remove it")?;
    let axes = &scene.domain.axes;
    expect(!axes.iter().any(|axis| matches!(axis, AxisSection::Open { .. })), "does not count what flows in and out; remove it")?;
    let moving = |axis: &&AxisSection| matches!(axis, AxisSection::Walls { lower, upper } if [lower, upper].iter().any(|wall| moves(wall)));
    let sliding: Vec<&AxisSection> = axes.iter().filter(moving).collect();
    let opposite = |axis: &&AxisSection| matches!(axis, AxisSection::Walls { lower, upper } if lower.iter().zip(upper).all(|(lower, upper)| *lower == -*upper));
    let walled = axes.iter().filter(|axis| matches!(axis, AxisSection::Walls { .. })).count();
    let known = sliding.is_empty() || walled == 1 && sliding.iter().all(opposite);
    expect(known, "counts the work of walls only if they move oppositely across the only axis with walls; move them so, or remove it")?;
    let sheared = !sliding.is_empty() || matches!(scene.flow.drive, Some(Drive::ShearRate(_) | Drive::ShearedBox(_)));
    let free = scene.bodies.iter().all(|bodies| bodies.motion == Motion::Free);
    expect(free || !sheared, "does not count the work on bodies with prescribed motion in shear; remove it, or bodies.motion")
}

fn moves(wall: &[f64]) -> bool {
    wall.iter().any(|component| *component != 0.0)
}
