//! What the study found, as files: numbers and charts.

use serde::Serialize;

use super::{
    fluid::Fluid,
    growth::{Growth, of},
    laplacian::{LaplacianSolve, WANTED},
    multipliers::{Constrained, MultiplierGrowth},
    preconditioning::Preconditioning,
    rigidity::Rigidity,
};
use crate::picture::{Chart, Scale, Series};

/// Names of the numbers of a row in `conditioning.csv`; what does not belong to its part is left empty.
const COLUMNS: &str = "part,dimension,preconditioner,cells,unknowns,smallest_eigenvalue,largest_eigenvalue,condition,exact_condition,\
    iterations,promised_iterations,setup_seconds,solve_seconds,preconditioner_bytes,matrix_bytes,bound_taken,bodies,modes,\
    preconditioned_condition,epsilon";

/// All that the study found.
#[derive(Serialize)]
pub struct ConditioningReport {
    /// Ranks.
    pub ranks: usize,
    /// Error in the energy norm at which iterations and seconds of the Laplacian are counted.
    pub wanted_error: f64,
    /// The Laplacian.
    pub laplacian: Vec<LaplacianSolve>,
    /// How it grows.
    pub growth: Vec<Growth>,
    /// Multipliers of disks.
    pub multipliers: Vec<Constrained>,
    /// How they grow.
    pub multiplier_growth: Vec<MultiplierGrowth>,
    /// Other constraint methods.
    pub rigidity: Vec<Rigidity>,
    /// The fluid without bodies.
    pub fluid: Vec<Fluid>,
}

impl ConditioningReport {
    /// Names and contents of the files.
    pub fn files(&self) -> [(&'static str, String); 4] {
        let json = serde_json::to_string(self).expect("a report is plain numbers and text");
        [
            ("conditioning.json", json + "\n"),
            ("conditioning.csv", self.csv()),
            ("conditioning.svg", self.chart(2).svg()),
            ("conditioning-3d.svg", self.chart(3).svg()),
        ]
    }

    fn csv(&self) -> String {
        let mut text = format!("{COLUMNS}\n");
        for solve in &self.laplacian {
            text += &laplacian_line(solve);
        }
        for Constrained { bodies, cells, modes, unknowns, condition, preconditioned, .. } in &self.multipliers {
            text += &format!("multipliers,2,,{cells},{unknowns},,,{condition},,,,,,,,,{bodies},{modes},{preconditioned},\n");
        }
        for Rigidity { method, epsilon, cells, unknowns, condition, preconditioned } in &self.rigidity {
            let epsilon = epsilon.map_or(String::new(), |epsilon| epsilon.to_string());
            text += &format!("{method},2,,{cells},{unknowns},,,{condition},,,,,,,,,1,,{preconditioned},{epsilon}\n");
        }
        for Fluid { dimension, name, cells, hypre, setup_seconds, solve_seconds, plain } in &self.fluid {
            text += &format!("fluid {name},{dimension},hypre,{cells},,,,,,{hypre},,{setup_seconds},{solve_seconds},,,,,,,\n");
            text += &format!(
                "fluid {name},{dimension},none,{cells},,,,,,{},,,,,,,,,,\n",
                plain.map_or(String::new(), |plain| plain.to_string())
            );
        }
        text
    }

    /// Iterations against `1/h`, and the predicted slopes, dashed.
    fn chart(&self, dimension: usize) -> Chart {
        let mut series: Vec<Series> = Preconditioning::ALL.iter().map(|&method| self.line(dimension, method)).collect();
        let first = |line: &Series, factor: f64| line.points.first().map(|&(x, y)| (x, factor * y));
        let last = series[0].points.last().map_or(1.0, |point| point.0);
        for (name, exponent, start) in [
            ("predicted: 1/h", 1.0, first(&series[0], 1.35)),
            ("predicted: flat", 0.0, first(&series[Preconditioning::ALL.len() - 1], 1.9)),
        ] {
            series.extend(start.map(|start| Series { name: name.into(), points: dashes(start, last, exponent) }));
        }
        Chart {
            title: format!("Iterations of conjugate gradients on the Laplacian, {dimension}D, energy error {WANTED:.0e}"),
            x: "cells per side, 1/h".into(),
            y: "iterations".into(),
            scale: Scale::Logarithmic,
            series,
        }
    }

    fn line(&self, dimension: usize, method: Preconditioning) -> Series {
        let points = of(&self.laplacian, dimension, method).map(|solve| (solve.cells as f64, solve.iterations as f64)).collect();
        Series { name: method.name().into(), points }
    }
}

/// A dashed power law from a point to another abscissa: its line breaks where a value is not finite.
fn dashes(start: (f64, f64), last: f64, exponent: f64) -> Vec<(f64, f64)> {
    const DASHES: usize = 24;
    let point = |part: f64| {
        let stretch = (last / start.0).powf(part);
        (start.0 * stretch, start.1 * stretch.powf(exponent))
    };
    let dash = |k: usize| [point(k as f64 / DASHES as f64), point((k as f64 + 0.6) / DASHES as f64), (f64::NAN, f64::NAN)];
    (0..DASHES).flat_map(dash).chain([point(1.0)]).collect()
}

fn laplacian_line(solve: &LaplacianSolve) -> String {
    let LaplacianSolve { dimension, cells, unknowns, smallest, largest, condition, iterations, promised_iterations, .. } = solve;
    let LaplacianSolve { setup_seconds, solve_seconds, bytes, matrix_bytes, bound_taken, .. } = solve;
    let (name, exact) = (solve.method.name().replace(',', ""), solve.exact_condition.map_or(String::new(), |exact| exact.to_string()));
    format!(
        "laplacian,{dimension},{name},{cells},{unknowns},{smallest},{largest},{condition},{exact},{iterations},{promised_iterations},\
         {setup_seconds},{solve_seconds},{bytes},{matrix_bytes},{bound_taken},,,,\n"
    )
}
