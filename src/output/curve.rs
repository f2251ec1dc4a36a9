//! The viscosity of a run over the strain, as `series.csv` holds it, and its mean.

use serde::{Deserialize, Serialize};

use super::{Columns, TooShort};
use crate::observe::{
    Part, Parts, Viscosity,
    statistics::{Interval, Shortage, Steady, mean_from, steady},
};

/// Least strain of the steady part of a mean: viscosities forget themselves over a strain of one or so, structures over ten at times, and a shorter part does not
/// tell how far they stray.
pub const LEAST_STRAIN: f64 = 20.0;

/// The viscosity at a step of a run, over that of the fluid, and the normal stresses that go with it, over viscosity and rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// Strain so far.
    pub strain: f64,
    /// Its parts; that of contacts if a contact model acts.
    pub parts: Parts<f64>,
    /// First normal stress difference.
    pub first_normal_difference: f64,
    /// Second normal stress difference, in three dimensions.
    pub second_normal_difference: Option<f64>,
    /// Pressure that bodies bear, where it is known.
    pub particle_pressure: Option<f64>,
}

/// Means over the steady part of a run, each step with its strain.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MeanViscosity {
    /// Total.
    pub relative: f64,
    /// Its parts; that of contacts if a contact model acts.
    #[serde(flatten)]
    pub parts: Parts<f64>,
    /// First normal stress difference over viscosity and rate.
    pub first_normal_difference: f64,
    /// Second normal stress difference over viscosity and rate, in three dimensions.
    pub second_normal_difference: Option<f64>,
    /// Pressure that bodies bear over viscosity and rate, where it is known.
    pub particle_pressure: Option<f64>,
    /// Lowest and highest value of `relative` that 95 % confidence leaves, for the time average of this run's bodies.
    pub interval: [f64; 2],
    /// Strains where the steady part begins, what is before it is left out, and where it ends.
    pub strains: [f64; 2],
    /// Blocks of the steady part whose scatter gives the interval.
    pub blocks: usize,
}

impl CurvePoint {
    /// Of a viscosity at a strain.
    pub fn of(viscosity: &Viscosity, strain: f64) -> CurvePoint {
        CurvePoint {
            strain,
            parts: viscosity.parts,
            first_normal_difference: viscosity.normal.first,
            second_normal_difference: viscosity.normal.second,
            particle_pressure: viscosity.normal.pressure,
        }
    }

    /// The total.
    pub fn relative(&self) -> f64 {
        self.parts.total()
    }

    /// The points in the rows of a text, if it has them.
    pub fn read(text: &str) -> Vec<CurvePoint> {
        let table = Columns::parse(text);
        if table.column("viscosity_hydrodynamic").is_none() {
            return Vec::new();
        }
        let number = |row: usize, name: &str| table.column(name).map(|column| column[row]);
        let point = |row: usize| CurvePoint {
            strain: number(row, "strain").unwrap_or(f64::NAN),
            parts: Parts::of(|part| number(row, &column(part))),
            first_normal_difference: number(row, "first_normal_difference").unwrap_or(f64::NAN),
            second_normal_difference: number(row, "second_normal_difference"),
            particle_pressure: number(row, "particle_pressure"),
        };
        (0..table.rows()).map(point).collect()
    }
}

/// Why a viscosity over the strain has no mean; nothing if it has one.
pub fn viscosity_too_short(curve: &[CurvePoint]) -> Option<TooShort> {
    steady_viscosity(curve).err().map(|shortage| TooShort::of("strain", shortage))
}

fn steady_viscosity(curve: &[CurvePoint]) -> Result<Steady, Shortage> {
    steady(&over_strain(curve, CurvePoint::relative), LEAST_STRAIN)
}

/// Values over the strain; a negative rate shears as well.
fn over_strain(curve: &[CurvePoint], value: impl Fn(&CurvePoint) -> f64) -> Vec<(f64, f64)> {
    curve.iter().map(|point| (point.strain.abs(), value(point))).collect()
}

impl MeanViscosity {
    /// Over the steady part of a curve; nothing while it is too short or has not become steady.
    pub fn of(curve: &[CurvePoint]) -> Option<MeanViscosity> {
        let Steady { from, to, interval: Interval { mean, half_width, blocks } } = steady_viscosity(curve).ok()?;
        let over = |value: &dyn Fn(&CurvePoint) -> f64| mean_from(&over_strain(curve, value), from);
        let over_known = |value: &dyn Fn(&CurvePoint) -> Option<f64>| {
            curve.iter().all(|point| value(point).is_some()).then(|| over(&|point| value(point).unwrap_or(f64::NAN)))
        };
        Some(MeanViscosity {
            relative: mean,
            parts: Parts::of(|part| over_known(&|point| point.parts.get(part))),
            first_normal_difference: over(&|point| point.first_normal_difference),
            second_normal_difference: over_known(&|point| point.second_normal_difference),
            particle_pressure: over_known(&|point| point.particle_pressure),
            interval: [mean - half_width, mean + half_width],
            strains: [from, to],
            blocks,
        })
    }

    /// Half the width of the interval.
    pub fn half_width(&self) -> f64 {
        0.5 * (self.interval[1] - self.interval[0])
    }
}

/// The column of a part of the viscosity.
fn column(part: Part) -> String {
    format!("viscosity_{}", part.name())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_the_mean_make_up_the_whole() {
        let point = |step: i32| {
            let strain = 0.1 * f64::from(step);
            CurvePoint {
                strain: -strain,
                parts: Parts::of(|part| match part {
                    Part::Hydrodynamic => Some(2.0 + strain.sin()),
                    Part::Contact => Some(0.5 + 0.1 * (3.0 * strain).cos()),
                    _ => None,
                }),
                first_normal_difference: -0.5,
                second_normal_difference: None,
                particle_pressure: Some(0.25),
            }
        };
        let mean = MeanViscosity::of(&(0..800).map(point).collect::<Vec<_>>()).unwrap();
        assert!((mean.relative - mean.parts.total()).abs() < 1e-12, "{mean:?}");
        assert!((mean.relative - 2.5).abs() < mean.half_width() && mean.half_width() < 0.3, "{mean:?}");
        assert!((mean.first_normal_difference + 0.5).abs() < 1e-12 && mean.parts.get(Part::Lubrication).is_none());
        assert_eq!(MeanViscosity::of(&[]), None);
    }
}
