//! The blocks of all inclusions: those of bodies in a fluid, and what keeps the source out and the constants free.

use std::ops::Range;

use nalgebra::SVector;

use super::inclusion::{Inclusion, InclusionBlocks};
use crate::{
    constraint::{
        blocks::Blocks,
        layout::MultiplierLayout,
        places::{Entries, EntriesMut, Places},
    },
    error::Result,
    petsc::{Scatter, Session, Vector},
};

/// The blocks of this rank's inclusions.
pub struct ScalarBlocks<const D: usize> {
    /// C, J and E.
    pub bodies: Blocks<D>,
    /// The inclusions, with their multipliers in this rank's part.
    inclusions: Vec<(Inclusion, Range<usize>)>,
    /// Entries of fields of other ranks that sources change.
    sources: Scatter,
}

impl<const D: usize> ScalarBlocks<D> {
    /// Joins the blocks of this rank's inclusions; `field` is any vector of the scalar.
    pub fn new(
        session: &Session,
        field: &Vector,
        layout: &MultiplierLayout,
        inclusions: Vec<InclusionBlocks<D>>,
    ) -> Result<ScalarBlocks<D>> {
        let (bodies, mut inclusions): (Vec<_>, Vec<_>) = inclusions.into_iter().map(|blocks| (blocks.body, blocks.inclusion)).unzip();
        let bodies = Blocks::new(session, field, layout, bodies)?;
        let mut places = Places::new(field)?;
        inclusions.iter_mut().for_each(|inclusion| inclusion.source.plan(&mut places));
        let ranges: Vec<Range<usize>> = bodies.each().map(|(_, range)| range).collect();
        Ok(ScalarBlocks { bodies, inclusions: inclusions.into_iter().zip(ranges).collect(), sources: places.scatter(field)? })
    }

    /// Adds to rows that hold `source` everywhere what makes it a source outside the inclusions only.
    pub fn confine_source(&mut self, source: f64, rows: &mut Vector) -> Result<()> {
        {
            let (mut own, others, mut scratch) = (rows.local_mut()?, self.sources.places(), Vec::new());
            let mut rows = EntriesMut { own: &mut own, others };
            self.inclusions.iter().for_each(|(inclusion, _)| inclusion.source.add(source, &[1.0], &mut scratch, &mut rows));
        }
        self.sources.add_back(rows)
    }

    /// For each of this rank's inclusions, the sum of a field over the cells that it changes or touches.
    pub fn sums(&mut self, field: &Vector) -> Result<Vec<f64>> {
        let (others, own) = (self.sources.fetch(field)?, field.local()?);
        let field = Entries { own: &own, others };
        let sum = |(inclusion, _): &(Inclusion, _)| inclusion.source.places.iter().map(|&place| field.from(place)[0]).sum();
        Ok(self.inclusions.iter().map(sum).collect())
    }

    /// The sum of a field over the cells of this rank's inclusions, by the parts of them that a unit source is kept out of.
    pub fn confined(&mut self, field: &Vector) -> Result<f64> {
        let (others, own) = (self.sources.fetch(field)?, field.local()?);
        let field = Entries { own: &own, others };
        let cells = self.inclusions.iter().flat_map(|(inclusion, _)| inclusion.source.places.iter().zip(&inclusion.source.values));
        Ok(cells.map(|(&place, value)| -value * field.from(place)[0]).sum())
    }

    /// `out += E c + source e`.
    pub fn add_local(&mut self, c: &Vector, source: f64, out: &mut [f64]) -> Result<()> {
        for (inclusion, range) in &self.inclusions {
            out[range.clone()].iter_mut().zip(&inclusion.by_source).for_each(|(out, value)| *out += source * value);
        }
        self.bodies.add_local(c, out)
    }

    /// `out += J (gradient . x)`, with the position `x` from the centre of each inclusion, away from walls.
    pub fn add_positions(&self, gradient: &SVector<f64, D>, out: &mut [f64]) {
        for (body, range) in self.bodies.each() {
            let values = body.coefficients(&|offset| SVector::repeat(gradient.dot(offset)));
            out[range].iter_mut().zip(values).for_each(|(out, value)| *out += value);
        }
    }

    /// Takes the constant out of tested values, which it may be, and puts the net flux of the multipliers in its place, which is zero.
    pub fn free_constants(&self, c: &[f64], out: &mut [f64]) {
        for (inclusion, range) in &self.inclusions {
            let (c, out) = (&c[range.clone()], &mut out[range.clone()]);
            let factor = inclusion.reaction * inclusion.constant_part(c) - inclusion.constant_part(out);
            inclusion.add_constant(factor, out);
        }
    }

    /// Multipliers that would bring about the `wanted` values, each inclusion as if it were alone, where the scalar has those in `out`.
    pub fn alone(&self, wanted: &[f64], out: &mut [f64]) {
        for (inclusion, range) in &self.inclusions {
            let (wanted, out) = (&wanted[range.clone()], &mut out[range.clone()]);
            let net = inclusion.constant_part(wanted) / inclusion.reaction;
            let mut missing: Vec<f64> = wanted.iter().zip(out.iter()).map(|(wanted, value)| wanted - value).collect();
            inclusion.add_constant(-inclusion.constant_part(&missing), &mut missing);
            inclusion.alone.apply(&missing, out);
            inclusion.add_constant(net - inclusion.constant_part(out), out);
        }
    }

    /// The constants in tested values, one for each of this rank's inclusions.
    pub fn constants(&self, tested: &[f64]) -> Vec<f64> {
        self.inclusions.iter().map(|(inclusion, range)| inclusion.constant_part(&tested[range.clone()])).collect()
    }

    /// Net fluxes of multipliers, one for each of this rank's inclusions.
    pub fn fluxes(&self, c: &[f64]) -> Vec<f64> {
        self.inclusions.iter().map(|(inclusion, range)| inclusion.flux(&c[range.clone()])).collect()
    }

    /// Integral over this rank's inclusions of the multipliers times the position.
    pub fn dipole(&self, c: &[f64]) -> SVector<f64, D> {
        self.bodies.each().map(|(body, range)| body.first_moment(&c[range]).row(0).transpose()).sum()
    }
}
