//! Scenes with inertia whose errors a study of single runs does not tell.

use crate::{
    error::Result,
    scene::{BodyGroup, ContactModel, FlowModel, Motion, Scene},
};

/// Refuses flows with inertia whose runs end at times of their own, or whose bodies touch each other and then go ways that no grid resolves.
///
/// # Errors
/// The scene is one of these.
pub fn check(scene: &Scene) -> Result<()> {
    if scene.flow.model != FlowModel::NavierStokes {
        return Ok(());
    }
    if scene.time.as_ref().is_some_and(|time| time.until.is_some()) {
        let remedy = "ends each run at a time of its own, and errors are those of one time; remove it, so that runs go to time.end";
        return Err(scene.refuse("time.until", "given", remedy));
    }
    let several = scene.bodies.iter().filter(|group| group.motion == Motion::Free).map(BodyGroup::at_least).sum::<usize>() > 1;
    if several && scene.contact.model != ContactModel::None {
        let remedy = "free bodies that touch go ways which differ from grid to grid by more than any error; write \"none\", with which runs end where \
                      they touch, and end them before (--until), or compare means of runs with turbid sweep";
        return Err(scene.refuse("contact.model", format!("{:?}", scene.contact.model.word()), remedy));
    }
    Ok(())
}
