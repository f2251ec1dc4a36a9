//! The blocks of all inclusions, applied one after the other.

use std::ops::Range;

use crate::{
    constraint::{
        Layout,
        dense::{LocalBlock, dot},
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
    /// Rows of C.
    pub rows: Rows,
    /// What is added to rows by a unit source outside of it, besides one everywhere: each cell in it or beside its surface, once.
    pub source: Rows,
    /// Rows of the transpose of J.
    pub sampled: Rows,
    /// Blocks of E in its rows.
    pub local: Vec<LocalBlock>,
    /// What a unit source adds to the values on its surface through the jumps.
    pub by_source: Vec<f64>,
}

/// The blocks of all inclusions.
pub struct ScalarBlocks {
    inclusions: Vec<InclusionBlocks>,
    /// For each of them, the places of the first multipliers of its blocks of E.
    multiplier_places: Vec<Vec<u32>>,
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
        let (mut sampled, mut spread, mut taken) = (Places::new(field)?, Places::new(field)?, Places::new(&multipliers)?);
        let mut multiplier_places = Vec::with_capacity(inclusions.len());
        for inclusion in &mut inclusions {
            inclusion.sampled.plan(&mut sampled);
            inclusion.rows.plan(&mut spread);
            inclusion.source.plan(&mut spread);
            let places = inclusion.local.iter().map(|block| taken.of(layout.global(block.body), block.transposed.nrows()));
            multiplier_places.push(places.collect());
        }
        let (sampled, spread, multipliers) = (sampled.scatter(field)?, spread.scatter(field)?, taken.scatter(&multipliers)?);
        Ok(ScalarBlocks { inclusions, multiplier_places, sampled, spread, multipliers })
    }

    /// `rows += factor * C c`, with this rank's multipliers `c`.
    pub fn spread(&mut self, factor: f64, c: &[f64], rows: &mut Vector) -> Result<()> {
        self.add_rows(rows, |inclusion| (&inclusion.rows, factor, &c[inclusion.range.clone()]))
    }

    /// Adds to rows that hold `source` everywhere what makes it a source outside the inclusions only.
    pub fn confine_source(&mut self, source: f64, rows: &mut Vector) -> Result<()> {
        self.add_rows(rows, |inclusion| (&inclusion.source, source, &[1.0]))
    }

    fn add_rows<'a>(&'a mut self, rows: &mut Vector, chosen: impl Fn(&'a InclusionBlocks) -> (&'a Rows, f64, &'a [f64])) -> Result<()> {
        let (mut own, mut others, mut scratch) = (rows.local_mut()?, self.spread.places()?, Vec::new());
        for (block, factor, c) in self.inclusions.iter().map(chosen) {
            block.add(factor, c, &mut scratch, &mut own, &mut others);
        }
        drop((own, others));
        self.spread.add_back(rows)
    }

    /// For each of this rank's inclusions, the sum of a field over the cells in it and beside its surface.
    pub fn sums(&mut self, field: &Vector) -> Result<Vec<f64>> {
        let (others, own) = (self.spread.fetch(field)?, field.local()?);
        let sum = |inclusion: &InclusionBlocks| inclusion.source.places.iter().map(|&place| from(&own, &others, place)[0]).sum();
        Ok(self.inclusions.iter().map(sum).collect())
    }

    /// `out = J u`, this rank's multipliers.
    pub fn sample(&mut self, field: &Vector, out: &mut [f64]) -> Result<()> {
        let (others, own) = (self.sampled.fetch(field)?, field.local()?);
        for inclusion in &self.inclusions {
            let out = &mut out[inclusion.range.clone()];
            out.fill(0.0);
            let Rows { places, values, .. } = &inclusion.sampled;
            for (&place, tests) in places.iter().zip(values.chunks_exact(out.len())) {
                let value = from(&own, &others, place)[0];
                out.iter_mut().zip(tests).for_each(|(out, test)| *out += value * test);
            }
        }
        Ok(())
    }

    /// `out += E c + source e`.
    pub fn add_local(&mut self, c: &Vector, source: f64, out: &mut [f64]) -> Result<()> {
        let (others, own) = (self.multipliers.fetch(c)?, c.local()?);
        for (inclusion, places) in self.inclusions.iter().zip(&self.multiplier_places) {
            let out = &mut out[inclusion.range.clone()];
            out.iter_mut().zip(&inclusion.by_source).for_each(|(out, value)| *out += source * value);
            for (LocalBlock { transposed, .. }, place) in inclusion.local.iter().zip(places) {
                let modes = transposed.nrows();
                let c = &from(&own, &others, *place)[..modes];
                out.iter_mut().zip(transposed.as_slice().chunks_exact(modes)).for_each(|(out, row)| *out += dot(row, c));
            }
        }
        Ok(())
    }
}
