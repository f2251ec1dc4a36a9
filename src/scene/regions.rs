//! What the regions in which bodies are placed demand of the box.

use super::{
    AxisSection, Drive, Region, Scene,
    demand::{expect, name},
};
use crate::error::Result;

/// Refuses regions that are no part of their box, or across which images slide.
pub(in crate::scene) fn check(scene: &Scene) -> Result<()> {
    for (group, bodies) in scene.bodies.iter().enumerate() {
        let Some(region) = &bodies.region else { continue };
        let key = format!("{}.region", scene.group_key(group));
        let size = &scene.domain.size;
        for (axis, &length) in size.iter().enumerate() {
            check_axis(scene, region, &key, axis, length)?;
        }
        let torn = matches!(scene.flow.drive, Some(Drive::ShearedBox(_))) && region.spans(1, size[1]) && !region.spans(0, size[0]);
        let remedy = format!(
            "ends within the box along x and not along y, across which images slide along x; let it reach from 0 to {} along x, or end within the box along y",
            size[0]
        );
        expect(scene, !torn, &key, region.text(), &remedy)?;
    }
    Ok(())
}

fn check_axis(scene: &Scene, region: &Region, key: &str, axis: usize, length: f64) -> Result<()> {
    let inside = region.lower[axis] >= 0.0 && region.upper[axis] <= length;
    let remedy = format!("leaves the box along {}, which goes from 0 to {length}", name(axis));
    expect(scene, inside, key, region.text(), &remedy)?;
    let open = matches!(scene.domain.axes[axis], AxisSection::Open { .. });
    let remedy = format!(
        "ends within the box along {}, along which fluid flows in and out; bodies keep clear of both: let it reach from 0 to {length}",
        name(axis)
    );
    expect(scene, !open || region.spans(axis, length), key, region.text(), &remedy)
}
