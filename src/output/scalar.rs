//! The numbers of a scalar around inclusions.

use nalgebra::SVector;
use serde::Serialize;

use crate::{
    mechanics::{InclusionState, ScalarSetup, SolvedScalar, Uzawa},
    surface::highest_order,
};

/// The scalar problem.
#[derive(Debug, Clone, Serialize)]
pub struct ScalarSummary {
    /// Source per volume outside the inclusions.
    pub source: f64,
    /// Least value of `1/2 integral |grad u|^2 - integral of source u` outside the inclusions.
    pub energy: f64,
    /// What the mean gradient of a periodic box brings about; absent without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub conduction: Option<ConductionSummary>,
    /// Uzawa's iteration, if it solved for the multipliers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uzawa: Option<UzawaSummary>,
    /// That a gap is thinner than modes resolve, and what would; absent where none is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub warning: Option<String>,
    /// The inclusions.
    pub inclusions: Vec<InclusionSummary>,
}

/// Conduction through a periodic box.
#[derive(Debug, Clone, Serialize)]
pub struct ConductionSummary {
    /// The mean gradient.
    pub mean_gradient: Vec<f64>,
    /// The mean flux up the gradient.
    pub mean_flux: Vec<f64>,
    /// Its part along the gradient over the gradient: the effective conductivity, that of what is around the inclusions being 1.
    pub conductivity: f64,
}

/// How Uzawa's iteration went.
#[derive(Debug, Clone, Serialize)]
pub struct UzawaSummary {
    /// The step.
    pub step: f64,
    /// Estimate of the step from which it diverges.
    pub bound: f64,
    /// Iterations of all solves of the box.
    pub box_iterations: usize,
}

/// One inclusion.
#[derive(Debug, Clone, Serialize)]
pub struct InclusionSummary {
    /// Its centre.
    pub center: Vec<f64>,
    /// Its radius.
    pub radius: f64,
    /// The scalar in it.
    pub value: f64,
    /// Net flux out of it.
    pub flux: f64,
}

impl ScalarSummary {
    pub(super) fn new<const D: usize>(solved: &SolvedScalar<D>) -> ScalarSummary {
        let SolvedScalar { setup, solution, .. } = *solved;
        ScalarSummary {
            source: setup.source,
            energy: solution.energy,
            conduction: setup.gradient.zip(solution.mean_flux).map(|(gradient, flux)| ConductionSummary::new(&gradient, &flux)),
            uzawa: solution.uzawa.map(|Uzawa { step, bound, box_iterations }| UzawaSummary { step, bound, box_iterations }),
            warning: warning(setup),
            inclusions: solution.inclusions.iter().map(InclusionSummary::new).collect(),
        }
    }
}

/// What is said of a gap that modes do not resolve.
fn warning<const D: usize>(setup: &ScalarSetup<D>) -> Option<String> {
    let thin = setup.thin_gap()?;
    let what = if setup.gradient.is_some() { "the conductivity" } else { "what flows there" };
    let (needed, most) = (thin.resolving_modes(), highest_order(D));
    let remedy = match needed <= most {
        true => format!("set resolution.modes = {needed}"),
        false => format!("that would take {needed} modes, and there are at most {most}: choose a wider gap"),
    };
    let text =
        format!("a gap of {:.1e} radii is thinner than {} modes resolve, and {what} may be off by 1 % or more", thin.gap, thin.modes);
    Some(format!("{text}; {remedy}"))
}

impl ConductionSummary {
    fn new<const D: usize>(gradient: &SVector<f64, D>, flux: &SVector<f64, D>) -> ConductionSummary {
        let list = |vector: &SVector<f64, D>| vector.as_slice().to_vec();
        let conductivity = gradient.dot(flux) / gradient.norm_squared();
        ConductionSummary { mean_gradient: list(gradient), mean_flux: list(flux), conductivity }
    }
}

impl InclusionSummary {
    fn new<const D: usize>(state: &InclusionState<D>) -> InclusionSummary {
        let InclusionState { center, radius, value, flux } = *state;
        InclusionSummary { center: center.as_slice().to_vec(), radius, value, flux }
    }
}
