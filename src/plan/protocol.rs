//! Shears whose rate changes, on a grid that may not be oblique: images slide by whole cells in every step.

use crate::{
    error::Result,
    geometry::{Axis, Domain, LeesEdwards, Protocol},
    grid::cells_along,
    motion::ShiftPeriod,
    scene::{Scene, Scheme},
};

/// Fewest cells by which images of an oscillating shear slide from the middle to either side.
const FEWEST_CELLS: f64 = 4.0;

/// The box of a scene whose rate jumps where images have slid by whole cells on a grid of this spacing.
///
/// # Errors
/// They would slide by too few cells.
pub fn whole<const D: usize>(scene: &Scene, domain: Domain<D>, spacing: f64) -> Result<Domain<D>> {
    let Some(slide) = domain.slide().filter(|slide| !slide.protocol.steady()) else { return Ok(domain) };
    let cell = domain.size[0] / cells_along(&domain.size, spacing)[0];
    let scheme = scene.time.as_ref().map_or(Scheme::TwoStep, |time| time.scheme);
    let unit = cell * ShiftPeriod::multiple(scheme, 0.0);
    check(scene, slide.protocol, cell, unit, scheme)?;
    let mut domain = domain;
    domain.axes[1] = Axis::Sheared(LeesEdwards { protocol: slide.protocol.rounded(unit), ..slide });
    Ok(domain)
}

fn check(scene: &Scene, protocol: Protocol, cell: f64, unit: f64, scheme: Scheme) -> Result<()> {
    let key = "flow.drive.shear_rate";
    match protocol {
        Protocol::Stress { stresses: [_, _, ..], .. } => {
            let remedy = "changes at times at which images of the sheared box have not slid by whole cells; set method.constraint = \"sharp\", give one stress \
                          or shear between walls (domain.y = \"walls\")";
            return Err(scene.refuse("flow.drive.shear_stress", "[{ .. }, ..]", remedy));
        }
        Protocol::Steady(_) | Protocol::Stress { .. } => {}
        Protocol::Oscillation { amplitude, .. } => {
            let refuse = |remedy: String| Err(scene.refuse(&format!("{key}.amplitude"), amplitude / scene.domain.size[1], &remedy));
            if scheme == Scheme::Midpoint {
                return refuse("has no middles of steps at which images of a sheared box have slid by whole cells; remove time.scheme, or shear between walls".into());
            }
            let cells = amplitude / cell;
            if cells < FEWEST_CELLS {
                return refuse(format!(
                    "slides the images of the sheared box by {cells:.2} cells to either side, and takes {FEWEST_CELLS}; raise it, refine [resolution], make \
                     the box higher or shear between walls (domain.y = \"walls\")"
                ));
            }
        }
        Protocol::Steps { steps, factor } => {
            let short = steps.iter().position(|step| step.rate != 0.0 && (factor * step.rate * step.length()).abs() < 0.5 * unit);
            if let Some(step) = short {
                let remedy = format!(
                    "slides the images of the sheared box by {:.2} cells, and takes {} at least; lengthen it, refine [resolution] or shear between walls \
                     (domain.y = \"walls\")",
                    (factor * steps[step].rate * steps[step].length() / cell).abs(),
                    unit / cell
                );
                return Err(scene.refuse(&format!("{key}[{step}].until"), steps[step].until, &remedy));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::setup::Setup;

    fn domain(rate: &str, time: &str) -> Result<Domain<2>> {
        let text = format!(
            "domain.size = [4.0, 4.0]\nresolution.spacing = 0.25\nmethod.constraint = \"penalty\"\nflow.drive = {{ shear_rate = {rate}, periodic = \"sheared\" }}\n\
             bodies = [{{ radius = 1.0, count = 1 }}]\ntime = {{ end = 2.0{time} }}\n"
        );
        Ok(Setup::of(&Scene::parse("scene", Path::new("."), &text, &[])?)?.domain)
    }

    #[test]
    fn rates_jump_where_images_have_slid_by_whole_cells() {
        let slid = |time: &str| {
            let slide =
                domain("[{ until = 0.17, rate = 1.0 }, { until = 0.3, rate = 0.0 }, { rate = -1.0 }]", time).unwrap().slide().unwrap();
            let jump = slide.protocol.next_jump(0.0);
            [jump, slide.protocol.next_jump(jump) - jump, slide.protocol.passed(jump) / 0.25].map(|number| (number * 1e9).round() / 1e9)
        };
        // a first step slides them by two cells
        assert_eq!(slid(""), [0.125, 0.13, 2.0]);
        assert_eq!(slid(", scheme = \"euler\""), [0.1875, 0.13, 3.0]);
    }

    #[test]
    fn rates_jump_when_they_are_to_on_a_grid_that_may_be_oblique() {
        let protocol = |rate: &str| {
            let text = format!(
                "domain.size = [4.0, 4.0]\nresolution.spacing = 0.25\nflow.drive = {{ shear_rate = {rate}, periodic = \"sheared\" }}\n\
                 bodies = [{{ radius = 1.0, count = 1 }}]\ntime.end = 2.0\n"
            );
            Setup::<2>::of(&Scene::parse("scene", Path::new("."), &text, &[]).unwrap()).unwrap().domain.slide().unwrap().protocol
        };
        assert_eq!(protocol("[{ until = 0.05, rate = 1.0 }, { rate = -1.0 }]").next_jump(0.0), 0.05);
        assert_eq!(
            protocol("{ amplitude = 1e-3, frequency = 1.0 }").scaled(0.25),
            Protocol::Oscillation { amplitude: 1e-3, frequency: 1.0 }
        );
    }

    #[test]
    fn stresses_that_jump_need_a_grid_that_may_be_oblique() {
        let refusal = |constraint: &str, stress: &str| {
            let text = format!(
                "domain.size = [4.0, 4.0]\nresolution.spacing = 0.25\nmethod.constraint = \"{constraint}\"\n\
                 flow.drive = {{ shear_stress = {stress}, periodic = \"sheared\" }}\nbodies = [{{ radius = 1.0, count = 1 }}]\ntime.end = 2.0\n"
            );
            Setup::<2>::of(&Scene::parse("scene", Path::new("."), &text, &[]).unwrap()).err().map(|error| error.to_string())
        };
        let jumps = "[{ until = 1.0, stress = 1.0 }, { stress = 2.0 }]";
        assert!(refusal("penalty", jumps).unwrap().contains("shear between walls"));
        assert_eq!([refusal("penalty", "1.0"), refusal("sharp", jumps)], [None, None]);
    }

    #[test]
    fn images_that_slide_by_too_few_cells_are_refused_with_a_remedy() {
        let refusal = |rate: &str, time: &str| domain(rate, time).unwrap_err().to_string();
        let few = refusal("[{ until = 0.05, rate = 1.0 }, { rate = -1.0 }]", "");
        assert!(few.contains("flow.drive.shear_rate[0].until = 0.05: slides") && few.contains("0.80 cells, and takes 2 at least"), "{few}");
        let few = refusal("{ amplitude = 0.1, frequency = 1.0 }", "");
        assert!(few.contains("flow.drive.shear_rate.amplitude = 0.1: slides") && few.contains("1.60 cells to either side"), "{few}");
        let middle = refusal("{ amplitude = 0.5, frequency = 1.0 }", ", scheme = \"midpoint\"");
        assert!(middle.contains("remove time.scheme"), "{middle}");
    }
}
