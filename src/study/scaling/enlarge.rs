//! Weak scaling: the same scene with N times the bodies in N times the volume.

use std::{
    fmt::Write,
    path::{Path, PathBuf},
};

use crate::{
    body::read_centers,
    error::{Error, Result},
    output::write_whole,
    scene::{AxisSection, Placement, Scene},
};

/// How many copies of a box stand along each axis when it grows `times`: longest factors along the shortest periodic sides.
///
/// # Errors
/// Walls bound every axis.
pub fn copies<const D: usize>(scene: &Scene, times: usize) -> Result<[usize; D]> {
    let mut copies = [1; D];
    for factor in prime_factors(times).into_iter().rev() {
        let periodic = (0..D).filter(|&axis| scene.domain.axes[axis] == AxisSection::Periodic);
        let length = |axis: usize| scene.domain.size[axis] * copies[axis] as f64;
        let shortest = periodic.min_by(|&one, &other| length(one).total_cmp(&length(other)));
        let Some(axis) = shortest else {
            return Err(Error::refused("no axis of the box is periodic, and walls cannot be moved without changing the flow"));
        };
        copies[axis] *= factor;
    }
    Ok(copies)
}

/// A scene so many times along each axis, written into a folder; bodies placed at random are placed anew, others repeated.
///
/// # Errors
/// A file cannot be read or written.
pub fn write_enlarged<const D: usize>(scene: &Scene, copies: [usize; D], folder: &Path) -> Result<PathBuf> {
    let size: Vec<f64> = scene.domain.size.iter().zip(copies).map(|(size, copies)| size * copies as f64).collect();
    let mut changes = vec![format!("domain.size={size:?}")];
    for (group, bodies) in scene.bodies.iter().enumerate() {
        changes.extend(region(scene, group, &copies, &size)?);
        let given = match &bodies.placement {
            Placement::Fraction(_) => continue,
            Placement::Count(count) => {
                changes.push(format!("bodies.{group}.count={}", count * copies.iter().product::<usize>()));
                continue;
            }
            Placement::Centers(centers) => centers.iter().map(|center| (center.clone(), bodies.radius)).collect(),
            Placement::File(path) => read_centers::<D>(path)?
                .into_iter()
                .map(|(center, radius)| (center.as_slice().to_vec(), radius.unwrap_or(bodies.radius)))
                .collect::<Vec<_>>(),
        };
        // beside the scene, from whose folder it is read
        let file = format!("bodies-{group}.csv");
        write_whole(&folder.join(&file), table(&given, &scene.domain.size, copies).as_bytes())?;
        changes.push(format!("bodies.{group}.file={file:?}"));
    }
    let text = Scene::parse(&scene.name, folder, &scene.movable_text()?, &changes)?.text;
    let path = folder.join(format!("{}.toml", scene.name));
    write_whole(&path, text.as_bytes())?;
    Ok(path)
}

/// The change of the region of a group, if it has one.
fn region(scene: &Scene, group: usize, copies: &[usize], size: &[f64]) -> Result<Option<String>> {
    let Some(region) = &scene.bodies[group].region else { return Ok(None) };
    let mut enlarged = region.clone();
    for axis in (0..copies.len()).filter(|&axis| copies[axis] > 1) {
        if !region.spans(axis, scene.domain.size[axis]) {
            let remedy = "ends within the box along an axis that grows for weak scaling; let it reach from end to end there";
            return Err(scene.refuse(&format!("{}.region", scene.group_key(group)), region.text(), remedy));
        }
        enlarged.upper[axis] = size[axis];
    }
    Ok(Some(format!("bodies.{group}.region={}", enlarged.text())))
}

/// Bodies and their copies, a line each.
fn table<const D: usize>(bodies: &[(Vec<f64>, f64)], size: &[f64], copies: [usize; D]) -> String {
    let mut text = String::new();
    for place in (crate::grid::Block { start: [0; D], end: copies }).indices() {
        for (center, radius) in bodies {
            for axis in 0..D {
                let _ = write!(text, "{:?},", center[axis] + place[axis] as f64 * size[axis]);
            }
            let _ = writeln!(text, "{radius:?}");
        }
    }
    text
}

/// In rising order.
fn prime_factors(mut number: usize) -> Vec<usize> {
    let (mut factors, mut factor) = (Vec::new(), 2);
    while number > 1 {
        while number.is_multiple_of(factor) {
            factors.push(factor);
            number /= factor;
        }
        factor += 1;
    }
    factors
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn scene(text: &str) -> Scene {
        Scene::parse("scene", Path::new(""), text, &[]).unwrap()
    }

    #[test]
    fn boxes_grow_along_their_shortest_periodic_sides() {
        let open = scene("[domain]\nsize = [4.0, 4.0, 4.0]\n[resolution]\nspacing = 0.5\n");
        assert_eq!(copies::<3>(&open, 8).unwrap(), [2, 2, 2]);
        assert_eq!(copies::<3>(&open, 12).unwrap(), [3, 2, 2]);
        let channel = scene("[domain]\nsize = [4.0, 4.0]\ny = \"walls\"\n[resolution]\nspacing = 0.5\n");
        assert_eq!(copies::<2>(&channel, 6).unwrap(), [6, 1]);
        let closed = scene("[domain]\nsize = [4.0, 4.0]\nx = \"walls\"\ny = \"walls\"\n[resolution]\nspacing = 0.5\n");
        assert!(copies::<2>(&closed, 2).is_err());
        assert_eq!(copies::<2>(&closed, 1).unwrap(), [1, 1]);
    }

    #[test]
    fn bodies_grow_with_the_box_in_a_relative_folder_too() {
        let folder = PathBuf::from(format!("target/turbid-enlarge-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let groups =
            ["centers = [[1.0, 1.0]]", "count = 3", "fraction = 0.1"].map(|placed| format!("[[bodies]]\nradius = 0.5\n{placed}\n"));
        let small = scene(&format!("[domain]\nsize = [8.0, 8.0]\n[resolution]\nspacing = 0.1\n{}", groups.concat()));
        let path = write_enlarged(&small, [2, 1], &folder).unwrap();
        let enlarged = Scene::read(&path, &[]).unwrap();
        assert_eq!(enlarged.domain.size, [16.0, 8.0]);
        assert_eq!(enlarged.bodies[1].placement, Placement::Count(6));
        assert_eq!(enlarged.bodies[2].placement, Placement::Fraction(0.1));
        let Placement::File(file) = &enlarged.bodies[0].placement else { panic!("no file") };
        let centers: Vec<_> = read_centers::<2>(file).unwrap().iter().map(|(center, radius)| (center[0], center[1], *radius)).collect();
        assert_eq!(centers, [(1.0, 1.0, Some(0.5)), (9.0, 1.0, Some(0.5))]);
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
