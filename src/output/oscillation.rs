//! What a shear that oscillates measures: storage and loss moduli, the complex viscosity, higher harmonics.

use std::f64::consts::TAU;

use serde::Serialize;

use super::Columns;
use crate::{
    geometry::Oscillation,
    observe::statistics::{Harmonics, harmonics},
};

/// The answer of the shear stress, that on the walls where there are walls, to a strain `amplitude sin(w t)`, with `w = 2 pi frequency`: it is `amplitude (G' sin(w t) + G'' cos(w t))` and higher harmonics.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OscillationSummary {
    /// Amplitude of the strain.
    pub amplitude: f64,
    /// Cycles a time.
    pub frequency: f64,
    /// Whole cycles over which the means are taken.
    pub cycles: usize,
    /// When the first of them begins: a first cycle is left out where there are others.
    pub from: f64,
    /// G', the part in phase with the strain over the amplitude.
    pub storage_modulus: Modulus,
    /// G'', the part in phase with the rate over the amplitude.
    pub loss_modulus: Modulus,
    /// Size of the complex viscosity over the viscosity of the fluid.
    pub complex_viscosity: f64,
    /// Phase by which the stress is ahead of the strain, in degrees: 90 for a viscous fluid.
    pub phase: f64,
    /// Sizes of the harmonics of the stress over the first.
    pub harmonics: Vec<f64>,
}

/// A modulus with the interval of its mean over more cycles.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Modulus {
    /// The mean.
    pub value: f64,
    /// Lowest and highest value that 95 % confidence leaves; nothing of a single cycle.
    pub interval: Option<[f64; 2]>,
}

/// The column of the shear stress that a rheometer measures: that on the walls where there are walls.
pub fn measured_stress(series: &Columns) -> &'static str {
    if series.column("wall_stress").is_some() { "wall_stress" } else { "shear_stress" }
}

impl OscillationSummary {
    /// That of the rows of a series, of a strain that oscillates so, in a fluid of a viscosity; nothing before a whole cycle.
    pub fn of(series: &Columns, strain: Oscillation, viscosity: f64) -> Option<OscillationSummary> {
        let Oscillation { amplitude, frequency } = strain;
        let Harmonics { parts, cycles, from } = harmonics(&series.curve("time", measured_stress(series)), frequency)?;
        let modulus = |(part, half_width): (f64, Option<f64>)| Modulus {
            value: part / amplitude,
            interval: half_width.map(|half| [(part - half) / amplitude, (part + half) / amplitude]),
        };
        let sizes: Vec<f64> = parts.iter().map(|[sine, cosine]| sine.0.hypot(cosine.0)).collect();
        let [in_phase, ahead] = parts[0];
        Some(OscillationSummary {
            amplitude,
            frequency,
            cycles,
            from,
            storage_modulus: modulus(in_phase),
            loss_modulus: modulus(ahead),
            complex_viscosity: sizes[0] / (amplitude * TAU * frequency * viscosity),
            phase: ahead.0.atan2(in_phase.0).to_degrees(),
            harmonics: sizes.iter().map(|size| size / sizes[0]).collect(),
        })
    }
}
