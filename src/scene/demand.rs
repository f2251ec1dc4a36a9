//! How a scene is refused unless it is right, and what its axes are called.

use std::fmt::Display;

use super::{AxisSection, Scene};
use crate::error::Result;

/// Refuses a key's value unless it is right.
pub(super) fn expect(scene: &Scene, right: bool, key: &str, value: impl Display, remedy: &str) -> Result<()> {
    if right { Ok(()) } else { Err(scene.refuse(key, value, remedy)) }
}

/// The axes that are not periodic.
pub(super) fn walled(scene: &Scene) -> impl Iterator<Item = usize> {
    let axes = scene.domain.axes.iter().enumerate();
    axes.filter(|(_, axis)| **axis != AxisSection::Periodic).map(|(axis, _)| axis)
}

/// The name of an axis.
pub(super) fn name(axis: usize) -> &'static str {
    ["x", "y", "z"][axis]
}
