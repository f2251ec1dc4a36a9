//! Bodies that oscillate a little in unsteady Stokes flow, in periodic boxes: amplitude and phase of force and torque are known in closed form.
//!
//! A few lengths of decay from the surface the flow is a potential one. There the images of a body act by their dipoles alone: on the lattice of a
//! square or cubic box their field is uniform to a high order in the fraction, and what the mean velocity leaves, which is zero.

use std::f64::consts::{PI, TAU};

use rustfft::num_complex::Complex;

use super::follow::{ComparisonRow, follow};
use crate::{error::Result, petsc::Session, system::BodyState};

/// Length of decay from the surface, in radii.
const DECAY: f64 = 0.28;

/// Side of the box in 2D and 3D, in radii.
const SIDE: [f64; 2] = [6.0, 5.0];

/// Amplitude of the way, in radii, or of the angle: so little that the flow is linear.
const AMPLITUDE: f64 = 1e-4;

/// Periods, of which the last one is looked at, and steps of each.
const PERIODS: usize = 3;
const STEPS: usize = 128;

/// Whether a body moves along x or turns (about z).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Oscillation {
    /// Along x.
    Translation,
    /// About z.
    Rotation,
}

impl Oscillation {
    /// The keys of a given motion of this amplitude.
    fn keys<const D: usize>(self) -> String {
        match (self, D) {
            (Oscillation::Translation, _) => {
                format!("amplitude = {:?}", std::array::from_fn::<f64, D, _>(|axis| if axis == 0 { AMPLITUDE } else { 0.0 }))
            }
            (Oscillation::Rotation, 2) => format!("rotation = {AMPLITUDE}"),
            (Oscillation::Rotation, _) => format!("rotation = [0.0, 0.0, {AMPLITUDE}]"),
        }
    }

    fn verb(self) -> &'static str {
        match self {
            Oscillation::Translation => "moves",
            Oscillation::Rotation => "turns",
        }
    }

    /// The component of the load of a body that has this motion.
    fn load<const D: usize>(self, body: &BodyState<D>) -> f64 {
        match self {
            Oscillation::Translation => body.force[0],
            Oscillation::Rotation => body.torque[(1, 0)],
        }
    }
}

/// Amplitude and phase of a body of radius 1 in a fluid of density 1 at an angular frequency of 1.
pub fn oscillating<const D: usize>(session: &Session, cells: usize, oscillation: Oscillation) -> Result<(usize, Vec<ComparisonRow>)> {
    let viscosity = 0.5 * DECAY * DECAY;
    let modes = if D == 2 { cells } else { cells.min(4) };
    let (size, center) = (format!("{:?}", [SIDE[D - 2]; D]), format!("{:?}", [0.5 * SIDE[D - 2]; D]));
    let motion = oscillation.keys::<D>();
    // from rest: the way is a cosine
    let text = format!(
        "domain = {{ size = {size} }}\nflow = {{ model = \"navier-stokes\", viscosity = {viscosity}, density = 1.0 }}\n\
         resolution = {{ cells_per_radius = {cells}, modes = {modes} }}\n\
         bodies = [{{ radius = 1.0, centers = [{center}], motion = {{ {motion}, frequency = {}, phase = {} }} }}]\n\
         time = {{ end = {}, step = {} }}\n",
        1.0 / TAU,
        0.5 * PI,
        TAU * PERIODS as f64,
        TAU / STEPS as f64
    );
    let mut found = Complex::default();
    let steps = follow::<D>(session, &text, |simulation, observation| {
        let (state, Some(solution)) = (simulation.state(), &observation.solution) else { return Ok(()) };
        if state.steps > (PERIODS - 1) * STEPS {
            found += Complex::from_polar(2.0 / STEPS as f64 * oscillation.load(&solution.bodies[0]), -state.time);
        }
        Ok(())
    })?;
    // the way is AMPLITUDE cos t, or the angle: a velocity of i AMPLITUDE
    let exact = load::<D>(oscillation, viscosity) * Complex::new(0.0, AMPLITUDE);
    let name = format!("{} that {}", if D == 2 { "disk" } else { "sphere" }, oscillation.verb());
    let unit = viscosity * AMPLITUDE;
    let row = |what: &str, reference: f64, found: f64| ComparisonRow {
        case: format!("{name} to and fro: {what}"),
        resolution: format!("{cells} cells a radius, {modes} modes"),
        reference: Some(reference),
        found,
        source: "exact (unsteady Stokes flow)",
    };
    let phase = |load: Complex<f64>| (-load / Complex::i()).arg().to_degrees();
    let amplitude = row("amplitude of the load", exact.norm() / unit, found.norm() / unit);
    Ok((steps, vec![amplitude, row("its phase before the velocity, degrees", phase(exact), phase(found))]))
}

/// The force or torque of the fluid on a body with a unit velocity or spin `exp(i t)`.
fn load<const D: usize>(oscillation: Oscillation, viscosity: f64) -> Complex<f64> {
    let i = Complex::i();
    let x = (i / viscosity).sqrt();
    let fraction = if D == 2 { PI } else { 4.0 / 3.0 * PI } / SIDE[D - 2].powi(D as i32);
    // strength of the dipole, and force, over those of a potential flow around a body at a relative velocity
    let (dipole, force) = if D == 2 {
        let [k0, k1] = [0, 1].map(|order| decaying(order, x));
        let dipole = 1.0 + 2.0 * k1 / (x * k0);
        (dipole, -PI * i * (2.0 * dipole - 1.0))
    } else {
        (1.0 + 3.0 / x + 3.0 / (x * x), -6.0 * PI * viscosity * (1.0 + x + x * x / 9.0))
    };
    let relative = (1.0 - fraction * dipole).inv();
    match oscillation {
        Oscillation::Translation => {
            let volume = if D == 2 { PI } else { 4.0 / 3.0 * PI };
            force * relative + volume * i * (1.0 - relative)
        }
        Oscillation::Rotation if D == 2 => {
            let [k0, k1] = [0, 1].map(|order| decaying(order, x));
            -TAU * viscosity * (x * k0 / k1 + 2.0)
        }
        Oscillation::Rotation => -8.0 / 3.0 * PI * viscosity * (3.0 + 3.0 * x + x * x) / (1.0 + x),
    }
}

/// The modified Bessel function `K_n(x) = int_0^inf exp(-x cosh t) cosh(n t) dt`, by the trapezoidal rule, which is exact but for rounding.
fn decaying(order: usize, x: Complex<f64>) -> Complex<f64> {
    const STEP: f64 = 0.02;
    let value = |t: f64| (-x * t.cosh()).exp() * (order as f64 * t).cosh();
    let sum: Complex<f64> = (1..400).map(|node| value(STEP * node as f64)).sum();
    (sum + 0.5 * value(0.0)) * STEP
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bessel_functions_have_their_known_values() {
        // Abramowitz and Stegun, table 9.8, and the Kelvin functions ker 1, kei 1 of table 9.12
        assert!((decaying(0, 1.0.into()).re - 0.421_024_438_2).abs() < 1e-9);
        assert!((decaying(1, 2.0.into()).re - 0.139_865_881_8).abs() < 1e-9);
        let kelvin = decaying(0, Complex::from_polar(1.0, 0.25 * PI));
        assert!((kelvin.re - 0.286_706_208_7).abs() < 1e-9 && (kelvin.im + 0.494_994_636_5).abs() < 1e-9, "{kelvin}");
    }
}
