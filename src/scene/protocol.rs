//! Which shears a box can have, and how their rates may change.

use super::{
    AxisSection, ConstraintMethod, ContactModel, Drive, FlowModel, Motion, Scene, Scheme, Step,
    demand::{expect, name, walled},
};
use crate::{
    error::Result,
    geometry::{Protocol, RateStep},
    linalg::ROUNDING,
};

/// Strain of a sheared box in a fixed step at most where bodies touch.
const MOST_STRAIN: f64 = 1.0;

/// The key that a shear is given by.
fn key(protocol: &Protocol) -> &'static str {
    if protocol.stresses().is_some() { "flow.drive.shear_stress" } else { "flow.drive.shear_rate" }
}

/// Refuses a shear of images that stay, or of walls, that cannot be.
pub(super) fn check_shear(scene: &Scene, protocol: &Protocol) -> Result<()> {
    check_protocol(scene, protocol)?;
    if walled(scene).next().is_some() {
        return check_walls(scene, protocol);
    }
    let remedy = "needs flow.drive.periodic = \"sheared\" in a run in time, so that images of the box move with the shear; set that, remove [time], or shear \
                  between walls (domain.y = \"walls\")";
    expect(scene, scene.time.is_none(), key(protocol), shown(protocol), remedy)
}

/// Refuses a shear of images that go along that cannot be.
pub(super) fn check_sheared_box(scene: &Scene, protocol: &Protocol) -> Result<()> {
    check_protocol(scene, protocol)?;
    if let Some(axis) = walled(scene).next() {
        let remedy = format!("needs a fully periodic box, but domain.{} has walls; remove them, or flow.drive.periodic", name(axis));
        return Err(scene.refuse(key(protocol), shown(protocol), &remedy));
    }
    let remedy = "makes no mesh of a box whose images slide; set method.constraint = \"sharp\" or remove flow.drive.periodic";
    expect(scene, scene.method.constraint != ConstraintMethod::Fitted, "method.constraint", "\"fitted\"", remedy)?;
    let remedy = "must not be 0: nothing would ever slide; remove flow.drive.periodic";
    expect(scene, scene.time.is_none() || protocol.fastest() != 0.0, key(protocol), shown(protocol), remedy)?;
    check_strain(scene, protocol)?;
    let inertia = scene.flow.model == FlowModel::NavierStokes && !protocol.steady();
    let remedy = "changes with time, and nothing in a fully periodic box would accelerate a fluid with inertia so; shear it between walls (domain.y = \"walls\")";
    expect(scene, !inertia, key(protocol), shown(protocol), remedy)
}

/// Refuses fixed steps in which images of bodies that touch slide past many others.
fn check_strain(scene: &Scene, protocol: &Protocol) -> Result<()> {
    let Some(Step::Fixed(step)) = scene.time.as_ref().map(|time| time.step) else { return Ok(()) };
    let strain = protocol.most_in(step);
    let bearable = scene.contact.model == ContactModel::None || protocol.stresses().is_some() || strain <= MOST_STRAIN * (1.0 + ROUNDING);
    let remedy = format!(
        "strains the box by {strain} in one step, on whose way contacts are looked for; with contact.model it may by {MOST_STRAIN} at most: set {:.3e}, a \
         shorter one or \"auto\"",
        MOST_STRAIN / protocol.fastest()
    );
    expect(scene, bearable, "time.step", step, &remedy)
}

/// A rate that changes is one of a run in time.
fn check_protocol(scene: &Scene, protocol: &Protocol) -> Result<()> {
    if protocol.steady() {
        return Ok(());
    }
    expect(scene, scene.time.is_some(), key(protocol), shown(protocol), "changes with time; add [time] end = .., or give one rate")?;
    let remedy = "solves for walls of one velocity; set method.constraint = \"sharp\" or give flow.drive.shear_rate one rate";
    expect(scene, scene.method.constraint != ConstraintMethod::Fitted, "method.constraint", "\"fitted\"", remedy)?;
    protocol.stresses().map_or(Ok(()), |stresses| check_stresses(scene, protocol, stresses))
}

/// Stresses decide the rate of free bodies in Stokes flow.
fn check_stresses(scene: &Scene, protocol: &Protocol, stresses: &[RateStep]) -> Result<()> {
    let refused = |right: bool, remedy: &str| expect(scene, right, key(protocol), shown(protocol), remedy);
    refused(stresses.iter().all(|step| step.rate != 0.0), "must not be 0: nothing would flow; remove it")?;
    refused(scene.flow.model == FlowModel::Stokes, "decides the rate in Stokes flow only; give flow.drive.shear_rate")?;
    let free = scene.bodies.iter().all(|bodies| bodies.motion == Motion::Free);
    refused(free, "is that of free bodies; remove bodies.motion or give flow.drive.shear_rate")?;
    let middle = scene.time.as_ref().is_some_and(|time| time.scheme == Scheme::Midpoint);
    refused(!middle, "is not known at middles of steps; remove time.scheme")
}

/// Refuses a pressure gradient or a body force that cannot change with time.
pub(super) fn check_factor(scene: &Scene) -> Result<()> {
    let factor = &scene.flow.drive_factor;
    if factor.steady() {
        return Ok(());
    }
    let (key, value) = ("flow.drive.factor", shown_factor(factor));
    expect(scene, scene.time.is_some(), key, &value, "changes with time; add [time] end = .., or give one number")?;
    let remedy = "solves for a drive that stays; set method.constraint = \"sharp\" or give flow.drive.factor one number";
    expect(scene, scene.method.constraint != ConstraintMethod::Fitted, "method.constraint", "\"fitted\"", remedy)?;
    let remedy = "is met in flows whose drive stays; give [resolution] instead, or flow.drive.factor one number";
    expect(scene, scene.accuracy.is_none(), "accuracy", scene.accuracy.unwrap_or_default(), remedy)
}

/// A factor as a scene file has it.
fn shown_factor(factor: &Protocol) -> String {
    match factor {
        Protocol::Oscillation { frequency, .. } => format!("{{ amplitude = {}, frequency = {frequency} }}", factor.fastest()),
        _ => shown(factor),
    }
}

/// Walls across y alone that have no velocity of their own can shear what is between them.
fn check_walls(scene: &Scene, protocol: &Protocol) -> Result<()> {
    let other = walled(scene).find(|&axis| axis != 1 || matches!(scene.domain.axes[axis], AxisSection::Open { .. }));
    if let Some(axis) = other {
        let remedy = format!("is that of a fully periodic box, or of walls across y alone; set domain.{} = \"periodic\"", name(axis));
        return Err(scene.refuse(key(protocol), shown(protocol), &remedy));
    }
    let AxisSection::Walls { lower, upper } = &scene.domain.axes[1] else { return Ok(()) };
    let still = [lower, upper].iter().all(|wall| wall.iter().all(|component| *component == 0.0));
    expect(
        scene,
        still,
        key(protocol),
        shown(protocol),
        "moves the walls across y; set domain.y = \"walls\", which gives them no other velocity",
    )
}

/// A rate as a scene file has it, or how it changes.
fn shown(protocol: &Protocol) -> String {
    match protocol {
        Protocol::Steady(rate) => rate.to_string(),
        Protocol::Stress { stresses: [one], .. } => one.rate.to_string(),
        Protocol::Oscillation { amplitude, frequency } => format!("{{ amplitude = {amplitude}, frequency = {frequency} }}"),
        Protocol::Steps { steps, .. } | Protocol::Stress { stresses: steps, .. } => format!("[{} steps]", steps.len()),
    }
}

impl Scene {
    /// Whether a shear that drives it, if one does, has one rate.
    pub fn steady_shear(&self) -> bool {
        self.shear_protocol().is_none_or(Protocol::steady) && self.domain.load.is_none()
    }

    /// Why nothing shears the free bodies of a scene that asks for a shear, or whose walls move, where that is so.
    pub fn why_nothing_shears(&self) -> Option<String> {
        let rests = self.shear_protocol().is_some_and(|protocol| protocol.fastest() == 0.0);
        let walls = || {
            self.domain
                .axes
                .iter()
                .filter_map(|axis| if let AxisSection::Walls { lower, upper } = axis { Some([lower, upper]) } else { None })
        };
        let alike = walls().all(|[lower, upper]| lower == upper) && walls().any(|[lower, _]| lower.iter().any(|speed| *speed != 0.0));
        let free = self.bodies.iter().all(|bodies| bodies.motion == Motion::Free);
        let why = if rests { "flow.drive.shear_rate is 0" } else { "opposite walls move alike" };
        (free && (rests || alike)).then(|| format!("nothing is sheared, as {why}"))
    }

    /// How the rate of the shear that drives it, or the stress that decides it, changes with time, if the scene says so.
    pub fn changing_shear(&self) -> Option<&Protocol> {
        let constant = |protocol: &Protocol| protocol.steady() || protocol.stresses().is_some_and(|stresses| stresses.len() == 1);
        self.shear_protocol().filter(|protocol| !constant(protocol))
    }

    /// The rate over time of the shear that drives it, or the stresses that decide it.
    pub fn shear_protocol(&self) -> Option<&Protocol> {
        match &self.flow.drive {
            Some(Drive::ShearRate(protocol) | Drive::ShearedBox(protocol)) => Some(protocol),
            _ => None,
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn free_bodies_in_a_shear_of_no_rate_or_between_walls_that_move_alike_are_not_sheared() {
        let why = |axis: &str, motion: &str, drive: &str| {
            let text = format!(
                "domain.size = [6.0, 6.0]\n{axis}resolution.cells_per_radius = 4\n{drive}bodies = [{{ radius = 1.0, count = 1{motion} }}]\n"
            );
            Scene::parse("scene", Path::new("."), &text, &[]).unwrap().why_nothing_shears()
        };
        let walls = |upper: f64| format!("domain.y = {{ lower = [1.0, 0.0], upper = [{upper}, 0.0] }}\n");
        assert_eq!(why("", "", "flow.drive.shear_rate = 0.0\n").unwrap(), "nothing is sheared, as flow.drive.shear_rate is 0");
        assert_eq!(why(&walls(1.0), "", "").unwrap(), "nothing is sheared, as opposite walls move alike");
        for scene in [
            why("", "", ""),
            why("", "", "flow.drive.shear_rate = 1.0\n"),
            why(&walls(-1.0), "", ""),
            why("domain.y = \"walls\"\n", "", ""),
            why(&walls(1.0), ", motion = \"fixed\"", ""),
        ] {
            assert_eq!(scene, None);
        }
    }
}
