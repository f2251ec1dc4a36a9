//! Two disks that fall one behind the other until they meet: the box of Feng and Michaelides (2004), Journal of Computational Physics 195.

use super::follow::{ComparisonRow, follow};
use crate::{error::Result, petsc::Session};

/// The time at which they first press on each other. Nobody has published a number that others confirm.
pub fn kissing(session: &Session, cells: usize) -> Result<(usize, Vec<ComparisonRow>)> {
    let text = format!(
        "gravity = [0.0, -981.0]\ndomain = {{ size = [2.0, 8.0], x = \"walls\", y = \"walls\" }}\n\
         flow = {{ model = \"navier-stokes\", viscosity = 0.01, density = 1.0 }}\nresolution.cells_per_radius = {cells}\n\
         bodies = [{{ radius = 0.1, centers = [[1.0, 6.8], [0.999, 7.2]], density = 1.01 }}]\n\
         contact.model = \"inelastic\"\ntime.end = 1.4\n"
    );
    let mut met = f64::NAN;
    let steps = follow::<2>(session, &text, |simulation, observation| {
        if met.is_nan() && observation.contacts.iter().any(|contact| contact.force != 0.0) {
            met = simulation.state().time;
        }
        Ok(())
    })?;
    let row = ComparisonRow {
        case: "two disks draft and kiss: time of their first contact".into(),
        resolution: format!("{cells} cells a radius"),
        reference: None,
        found: met,
        source: "grids against each other; set-up of Feng and Michaelides (2004)",
    };
    Ok((steps, vec![row]))
}
