//! Rigid rods of touching spheres: how they turn in shear, and what they resist.

use std::f64::consts::{FRAC_PI_2, PI};

use super::Case;
use crate::{error::Result, petsc::Session, validation::solve::solve};

/// Mean velocity that images in a cubic lattice take from what a force moves, times viscosity and period over force (Hasimoto 1959).
const HASIMOTO: f64 = 2.837297 / (6.0 * PI);

/// Cases of two spheres and of more, in an infinite fluid by fundamental solutions; along the line of centres by the closed form
/// `1/3 integral of 1 - 2 (sinh^2 x - x^2)/(sinh 2x + 2x)`, x from zero on (Faxen's limit of Stimson and Jeffery's series).
pub fn cases() -> Vec<Case> {
    let period = |balls: usize, reference: f64, (side, cells): (f64, f64), tolerance: f64, [name, source]: [&'static str; 2]| Case {
        name,
        source,
        resolution: format!("a/h = {cells}, box of {side} radii"),
        reference,
        tolerance,
        solve: Box::new(move |session: &Session| orbit_period(session, balls, side, cells)),
    };
    let drag = |name: &'static str, source: &'static str, angle: f64, reference: f64| Case {
        name,
        source,
        resolution: "a/h = 4, box of 20 radii".into(),
        reference,
        tolerance: 1e-2,
        solve: Box::new(move |session: &Session| doublet_drag(session, angle, 20.0)),
    };
    const RODS: &str = "method of fundamental solutions, six digits";
    vec![
        period(2, 15.62, (16.0, 4.0), 1e-2, ["period times rate, two touching spheres in shear", "Wakiya 1971, Nir & Acrivos 1973"]),
        period(3, 20.1579, (16.0, 4.0), 1e-2, ["period times rate, rod of 3 spheres in shear", RODS]),
        period(5, 29.6170, (24.0, 4.0), 1e-2, ["period times rate, rod of 5 spheres in shear", RODS]),
        period(10, 52.8449, (40.0, 3.0), 1e-2, ["period times rate, rod of 10 spheres in shear", RODS]),
        drag("drag of two touching spheres over twice Stokes', along", "Stimson & Jeffery 1926, Faxen 1927, recomputed", 0.0, 0.645141),
        drag("drag of two touching spheres over twice Stokes', across", "method of fundamental solutions, six digits", FRAC_PI_2, 0.724661),
    ]
}

/// A rod of touching spheres of radius 1 in a periodic box, turned by an angle from lying along x.
fn scene(balls: usize, side: f64, cells: f64, angle: f64, driven: [&str; 2]) -> String {
    let [flow, load] = driven;
    let middle = 0.5 * side + 0.1;
    format!(
        "domain = {{ size = [{side:?}, {side:?}, {side:?}] }}\nflow = {{ model = \"stokes\", viscosity = 1.0{flow} }}\n\
         resolution = {{ cells_per_radius = {cells:?} }}\nmethod = {{ inverse = \"transform\", tolerance = 1e-7 }}\n\
         clusters = [{{ shape = \"rod\", beads = {balls}, radius = 1.0, centers = [[{middle}, {middle}, {middle}]], \
         rotation = [0.0, 0.0, {angle:?}]{load} }}]\n"
    )
}

/// By Jeffery's orbit: an axisymmetric body turns at rates between those along the flow and across it, of which the period is made.
fn orbit_period(session: &Session, balls: usize, side: f64, cells: f64) -> Result<f64> {
    let rate = |angle: f64| -> Result<f64> {
        let (_, solution) = solve::<3>(session, &scene(balls, side, cells, angle, [", drive = { shear_rate = 1.0 }", ""]), &[])?;
        Ok(-solution.bodies[0].twist.spin[(1, 0)])
    };
    Ok(2.0 * PI / (rate(0.0)? * rate(FRAC_PI_2)?).sqrt())
}

/// In a lattice of images, without what they do.
fn doublet_drag(session: &Session, angle: f64, side: f64) -> Result<f64> {
    let (_, solution) = solve::<3>(session, &scene(2, side, 4.0, angle, ["", ", force = [1.0, 0.0, 0.0]"]), &[])?;
    let velocity = 0.5 * (solution.bodies[0].twist.velocity[0] + solution.bodies[1].twist.velocity[0]);
    Ok(1.0 / (12.0 * PI * (velocity + HASIMOTO / side)))
}
