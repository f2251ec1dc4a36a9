//! The blocks of all inclusions, applied one after the other.

use std::ops::Range;

use nalgebra::DMatrix;

use super::coupling::{Coupling, Plans, Seen};
use crate::{
    constraint::{
        Layout,
        places::{Places, from},
        rows::Rows,
    },
    error::Result,
    petsc::{Scatter, Session, Vector},
};

/// What one inclusion adds.
pub struct InclusionBlocks {
    /// Its multipliers in this rank's part.
    pub range: Range<usize>,
    /// The values that a constant has when it is tested.
    pub constant: Vec<f64>,
    /// The values that the coordinates from the centre (columns) have when they are tested.
    pub positions: DMatrix<f64>,
    /// Flux of a multiplier that is constant over the inclusion: the area of its surface, or the volume of a cell, over what testing takes.
    pub measure: f64,
    /// Value that stands for a unit of the constant multiplier, whose row says that nothing flows net out.
    pub reaction: f64,
    /// What is added to rows by a unit source outside of it, besides one everywhere: each cell that it changes or touches, once.
    pub source: Rows,
    /// C, J and E.
    pub coupling: Coupling,
}

impl InclusionBlocks {
    /// The part of the constant in tested values or multipliers.
    fn constant_part(&self, tested: &[f64]) -> f64 {
        let square: f64 = self.constant.iter().map(|one| one * one).sum();
        self.constant.iter().zip(tested).map(|(one, value)| one * value).sum::<f64>() / square
    }

    fn add_constant(&self, factor: f64, tested: &mut [f64]) {
        tested.iter_mut().zip(&self.constant).for_each(|(value, one)| *value += factor * one);
    }

    /// Integrals over the inclusion of its multipliers times a function of the given tested values.
    fn integral(&self, tested: impl Iterator<Item = f64>, c: &[f64]) -> f64 {
        self.measure * tested.zip(c).map(|(value, c)| value * c).sum::<f64>()
    }
}

/// The blocks of all inclusions.
pub struct ScalarBlocks {
    inclusions: Vec<InclusionBlocks>,
    /// Entries of fields that interpolation takes from other ranks.
    sampled: Scatter,
    /// Entries of fields of other ranks to which rows belong.
    spread: Scatter,
    /// Multipliers of other ranks that E takes.
    multipliers: Scatter,
}

impl ScalarBlocks {
    /// Joins the blocks of this rank's inclusions; `field` is any vector of the scalar.
    pub fn new(session: &Session, field: &Vector, layout: &Layout, mut inclusions: Vec<InclusionBlocks>) -> Result<ScalarBlocks> {
        let multipliers = Vector::new(session, layout.local_unknowns())?;
        let mut plans = Plans { sampled: Places::new(field)?, spread: Places::new(field)?, multipliers: Places::new(&multipliers)? };
        for inclusion in &mut inclusions {
            inclusion.source.plan(&mut plans.spread);
            inclusion.coupling.plan(layout, &mut plans);
        }
        let (sampled, spread) = (plans.sampled.scatter(field)?, plans.spread.scatter(field)?);
        Ok(ScalarBlocks { inclusions, sampled, spread, multipliers: plans.multipliers.scatter(&multipliers)? })
    }

    /// `rows += factor * C c`, with this rank's multipliers `c`.
    pub fn spread(&mut self, factor: f64, c: &[f64], rows: &mut Vector) -> Result<()> {
        let (mut own, mut others) = (rows.local_mut()?, self.spread.places()?);
        for inclusion in &self.inclusions {
            inclusion.coupling.spread(factor, &c[inclusion.range.clone()], &mut own, &mut others);
        }
        drop((own, others));
        self.spread.add_back(rows)
    }

    /// Adds to rows that hold `source` everywhere what makes it a source outside the inclusions only.
    pub fn confine_source(&mut self, source: f64, rows: &mut Vector) -> Result<()> {
        let (mut own, mut others, mut scratch) = (rows.local_mut()?, self.spread.places()?, Vec::new());
        for inclusion in &self.inclusions {
            inclusion.source.add(source, &[1.0], &mut scratch, &mut own, &mut others);
        }
        drop((own, others));
        self.spread.add_back(rows)
    }

    /// For each of this rank's inclusions, the sum of a field over the cells that it changes or touches.
    pub fn sums(&mut self, field: &Vector) -> Result<Vec<f64>> {
        let (others, own) = (self.spread.fetch(field)?, field.local()?);
        let sum = |inclusion: &InclusionBlocks| inclusion.source.places.iter().map(|&place| from(&own, &others, place)[0]).sum();
        Ok(self.inclusions.iter().map(sum).collect())
    }

    /// The sum of a field over the cells of this rank's inclusions, by the parts of them that a unit source is kept out of.
    pub fn confined(&mut self, field: &Vector) -> Result<f64> {
        let (others, own) = (self.spread.fetch(field)?, field.local()?);
        let cells = self.inclusions.iter().flat_map(|inclusion| inclusion.source.places.iter().zip(&inclusion.source.values));
        Ok(cells.map(|(&place, value)| -value * from(&own, &others, place)[0]).sum())
    }

    /// `out = J u`, this rank's multipliers.
    pub fn sample(&mut self, field: &Vector, out: &mut [f64]) -> Result<()> {
        let (others, own) = (self.sampled.fetch(field)?, field.local()?);
        for inclusion in &self.inclusions {
            inclusion.coupling.sample(&own, &others, &mut out[inclusion.range.clone()]);
        }
        Ok(())
    }

    /// `out += E c + source e`.
    pub fn add_local(&mut self, c: &Vector, source: f64, out: &mut [f64]) -> Result<()> {
        let (others, own) = (self.multipliers.fetch(c)?, c.local()?);
        for inclusion in &self.inclusions {
            let range = inclusion.range.clone();
            let seen = Seen { own: &own, others: &others, inclusion: &own[range.clone()] };
            inclusion.coupling.add_local(seen, source, &mut out[range]);
        }
        Ok(())
    }

    /// `out += J (gradient . x)`, with the position `x` from the centre of each inclusion.
    pub fn add_positions(&self, gradient: &[f64], out: &mut [f64]) {
        for inclusion in &self.inclusions {
            for (column, factor) in inclusion.positions.column_iter().zip(gradient) {
                out[inclusion.range.clone()].iter_mut().zip(column.iter()).for_each(|(out, position)| *out += factor * position);
            }
        }
    }

    /// Takes the constant out of tested values, which it may be, and puts the net flux of the multipliers in its place, which is zero.
    pub fn free_constants(&self, c: &[f64], out: &mut [f64]) {
        for inclusion in &self.inclusions {
            let (c, out) = (&c[inclusion.range.clone()], &mut out[inclusion.range.clone()]);
            let factor = inclusion.reaction * inclusion.constant_part(c) - inclusion.constant_part(out);
            inclusion.add_constant(factor, out);
        }
    }

    /// Multipliers that would bring about the `wanted` values, each inclusion as if it were alone, where the scalar has those in `out`.
    pub fn alone(&self, wanted: &[f64], out: &mut [f64]) {
        for inclusion in &self.inclusions {
            let (wanted, out) = (&wanted[inclusion.range.clone()], &mut out[inclusion.range.clone()]);
            let net = inclusion.constant_part(wanted) / inclusion.reaction;
            let mut missing: Vec<f64> = wanted.iter().zip(out.iter()).map(|(wanted, value)| wanted - value).collect();
            inclusion.add_constant(-inclusion.constant_part(&missing), &mut missing);
            inclusion.coupling.invert(&missing, out);
            inclusion.add_constant(net - inclusion.constant_part(out), out);
        }
    }

    /// The constants in tested values, one for each of this rank's inclusions.
    pub fn constants(&self, tested: &[f64]) -> Vec<f64> {
        self.inclusions.iter().map(|inclusion| inclusion.constant_part(&tested[inclusion.range.clone()])).collect()
    }

    /// Net fluxes of multipliers, one for each of this rank's inclusions.
    pub fn fluxes(&self, c: &[f64]) -> Vec<f64> {
        let flux = |inclusion: &InclusionBlocks| inclusion.integral(inclusion.constant.iter().copied(), &c[inclusion.range.clone()]);
        self.inclusions.iter().map(flux).collect()
    }

    /// Integral over this rank's inclusions of the multipliers times the position along an axis.
    pub fn dipole(&self, axis: usize, c: &[f64]) -> f64 {
        let dipole =
            |inclusion: &InclusionBlocks| inclusion.integral(inclusion.positions.column(axis).iter().copied(), &c[inclusion.range.clone()]);
        self.inclusions.iter().map(dipole).sum()
    }
}
