//! The scenes of the study.

use std::f64::consts::PI;

use nalgebra::SVector;

use super::record::SuspensionSetting;
use crate::{
    body::equilibrium,
    error::Result,
    geometry::{Axis, Domain},
};

/// Cells per radius of runs in time, in 2D and 3D.
const SHEARED_CELLS: [f64; 2] = [5.0, 3.0];

/// Films thinner than this, in radii, count as so thin.
const ROUGHNESS: f64 = 1e-4;

/// Shear between images that slide.
const SLIDING: &str = "[flow]\ndrive = { shear_rate = 1.0, periodic = \"sheared\" }\n";

impl SuspensionSetting {
    /// The run in time that goes with an instant, on a coarser grid: contacts matter more there than the flow in gaps.
    pub fn sheared(&self, strain: f64) -> SuspensionSetting {
        let cells_per_radius = self.cells_per_radius.min(SHEARED_CELLS[self.dimension - 2]);
        SuspensionSetting { strain: Some(strain), cells_per_radius, gap: self.gap.max(0.05), ..self.clone() }
    }

    /// Its scene file, for bodies of radius 1 in a cube: at an instant in equilibrium, in time packed at random.
    ///
    /// # Errors
    /// The bodies do not fit.
    pub fn scene(&self) -> Result<String> {
        let volume = if self.dimension == 2 { PI } else { 4.0 * PI / 3.0 };
        let side = (self.bodies as f64 * volume / self.fraction).powf(1.0 / self.dimension as f64);
        let size = vec![format!("{side:?}"); self.dimension].join(", ");
        let SuspensionSetting { bodies, cells_per_radius, gap, seed, .. } = self;
        let (places, rest) = match self.strain {
            None => {
                let centers = if self.dimension == 2 { self.centers::<2>(side)? } else { self.centers::<3>(side)? };
                (format!("centers = {centers}"), "[flow]\ndrive = { shear_rate = 1.0 }\n[output]\n".to_owned())
            }
            Some(strain) => (
                format!("count = {bodies}\ngap = {gap:?}"),
                format!("{SLIDING}[contact]\nmodel = \"inelastic\"\n[time]\nend = {strain:?}\n[output]\nfields = false\n"),
            ),
        };
        Ok(format!(
            "seed = {seed}\n[domain]\nsize = [{size}]\n[resolution]\ncells_per_radius = {cells_per_radius:?}\n\
             [method]\ninverse = \"auto\"\n[lubrication]\nmodel = \"pairwise\"\nroughness = {ROUGHNESS:?}\n[[bodies]]\nradius = 1.0\n{places}\n{rest}picture = false\n"
        ))
    }

    fn centers<const D: usize>(&self, side: f64) -> Result<String> {
        let domain = Domain { size: SVector::repeat(side), axes: [Axis::Periodic; D] };
        let centers = equilibrium(&domain, &vec![1.0; self.bodies], self.gap, self.seed)?;
        Ok(format!("{:?}", centers.iter().map(|center| center.as_slice().to_vec()).collect::<Vec<_>>()))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::{plan::Plan, scene::Scene, setup::Setup};

    #[test]
    fn scenes_have_the_fraction_that_is_asked_for() {
        for (dimension, cells_per_radius) in [(2, 4.0), (3, 3.0)] {
            let setting = SuspensionSetting { dimension, fraction: 0.2, bodies: 8, cells_per_radius, gap: 0.02, seed: 3, strain: None };
            for setting in [setting.clone(), setting.sheared(2.0)] {
                let scene = Scene::parse("scene", Path::new(""), &setting.scene().unwrap(), &[]).unwrap();
                let fraction = match dimension {
                    2 => Setup::<2>::of(&scene).unwrap().fraction(),
                    _ => Setup::<3>::of(&scene).unwrap().fraction(),
                };
                assert!((fraction - 0.2).abs() < 1e-12, "{fraction}");
                assert_eq!(scene.end(), setting.strain.unwrap_or(0.0));
            }
            let scene = Scene::parse("scene", Path::new(""), &setting.sheared(2.0).scene().unwrap(), &[]).unwrap();
            let plan = if dimension == 2 {
                Plan::<2>::of(&scene).and_then(|plan| plan.report(1))
            } else {
                Plan::<3>::of(&scene).and_then(|plan| plan.report(1))
            };
            assert!(plan.unwrap().to_string().contains("built      contact"));
        }
    }
}
