//! Shears whose rate changes, on a grid: images slide by whole cells in every step.

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
    check(scene, slide.protocol, (cell, unit), scheme)?;
    let mut domain = domain;
    domain.axes[1] = Axis::Sheared(LeesEdwards { protocol: slide.protocol.rounded(unit), ..slide });
    Ok(domain)
}

fn check(scene: &Scene, protocol: Protocol, (cell, unit): (f64, f64), scheme: Scheme) -> Result<()> {
    let key = "flow.drive.shear_rate";
    match protocol {
        Protocol::Steady(_) => {}
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
