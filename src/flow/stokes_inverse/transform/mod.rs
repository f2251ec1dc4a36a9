//! The exact inverse by Fourier transforms, for boxes periodic along all axes and for channels.
//!
//! One axis after the other is made whole on every rank and transformed; the last one, across the walls in a channel, is solved
//! for every wave along the others, and the same way leads back. Where images slide, the axis across the boundary comes last: for every
//! wave along x the displacement of the images is a phase.

mod along_axis;
mod channel;
mod fourier;
mod lees_edwards;
mod lines;
mod periodic;
mod separated;
mod stages;
mod symbols;
mod wall_to_wall;

use std::{ops::Range, time::Instant};

use rustfft::num_complex::Complex;

use self::{
    channel::ChannelLines,
    fourier::{ComplexTransform, RealTransform},
    lines::Lines,
    periodic::PeriodicLines,
    stages::{Stages, transforms_at_once},
    symbols::Symbols,
};
pub use self::{separated::SeparatedInverse, stages::Transposes};
use super::{Stokes, StokesInverse};
use crate::{
    error::{Error, Result},
    geometry::{Axis, Domain},
    grid::{Block, BlockLayout, Exchange, Grid, Pencils, Redistribution},
    parallel::World,
    petsc::Vector,
};

/// The inverse of the Stokes operator, exact but for rounding.
pub struct TransformInverse<const D: usize> {
    fields: Vec<Field>,
    /// To where the first axis is whole.
    start: Option<Redistribution>,
    first: RealTransform<D>,
    middle: Vec<ComplexTransform<D>>,
    /// To where each further axis is whole.
    turns: Vec<Option<Redistribution>>,
    last: LastAxis<D>,
    /// Values at points; nothing where the fields of a fluid vector lie as they do here, and are transformed in place.
    values: Option<Vec<f64>>,
    waves: Vec<Complex<f64>>,
    value_exchange: Exchange<f64>,
    wave_exchange: Exchange<Complex<f64>>,
    setup_seconds: f64,
}

/// How a field comes out of a fluid vector.
struct Field {
    /// In this rank's part of a fluid vector.
    range: Range<usize>,
    /// Where it goes in this rank's values.
    places: Vec<Range<usize>>,
    /// Undoes the balance of the rows, and the growth by a transform there and back.
    factor: f64,
}

/// The axis that is solved.
enum LastAxis<const D: usize> {
    Periodic(PeriodicLines<D>),
    Channel(ChannelLines<D>),
}

impl<const D: usize> TransformInverse<D> {
    /// Whether it serves a box: at most one axis may have walls.
    pub fn fits(domain: &Domain<D>) -> bool {
        transforms_at_once(domain)
    }

    /// Plans transforms and factors what is solved between walls.
    ///
    /// # Errors
    /// A box with walls across more than one axis.
    pub fn new(stokes: &Stokes<D>, grid: &Grid<D>) -> Result<TransformInverse<D>> {
        let setup = Instant::now();
        if !Self::fits(grid.domain()) {
            return Err(Error::refused("the exact inverse needs a box with walls across one axis at most; set one up by its method"));
        }
        let rank = stokes.session().world().rank();
        let Stages { own, whole, waves: stages, order } = Stages::new(grid);
        let start = Redistribution::new(&own, &whole, rank, D + 1);
        let turns: Vec<_> = stages.windows(2).map(|pair| Redistribution::new(&pair[0], &pair[1], rank, D + 1)).collect();
        let lines = |stage: usize| Lines::new(stages[stage].0[rank], order[stage]);
        let most = |layouts: &[&BlockLayout<D>]| (D + 1) * layouts.iter().map(|layout| layout.0[rank].len()).max().unwrap_or(0);
        let fields = fields(stokes, grid, own.0[rank]);
        let in_place = start.is_none() && fields.iter().all(|field| field.places == [field.range.clone()]);
        Ok(TransformInverse {
            fields,
            first: RealTransform::new(Lines::new(whole.0[rank], order[0]), lines(0)),
            middle: (1..D - 1).map(|stage| ComplexTransform::new(lines(stage))).collect(),
            last: LastAxis::new(lines(D - 1), order[D - 1], grid, stokes.shift()),
            values: (!in_place).then(|| vec![0.0; most(&[&own, &whole])]),
            waves: vec![Complex::default(); most(&stages.iter().collect::<Vec<_>>())],
            value_exchange: Exchange::new(&start, 0.0),
            wave_exchange: Exchange::new(turns.iter().flatten(), Complex::default()),
            start,
            turns,
            setup_seconds: setup.elapsed().as_secs_f64(),
        })
    }

    /// Seconds spent setting it up.
    pub fn setup_seconds(&self) -> f64 {
        self.setup_seconds
    }

    /// Takes the rows of each field out of a fluid vector, no longer balanced.
    fn take(&self, rows: &[f64], values: &mut [f64]) {
        for Field { range, places, factor } in &self.fields {
            let mut rows = &rows[range.clone()];
            for place in places {
                let (here, rest) = rows.split_at(place.len());
                values[place.clone()].iter_mut().zip(here).for_each(|(value, row)| *value = row * factor);
                rows = rest;
            }
        }
    }

    fn put(&self, values: &[f64], output: &mut [f64]) {
        for Field { range, places, .. } in &self.fields {
            let mut start = range.start;
            for place in places {
                output[start..start + place.len()].copy_from_slice(&values[place.clone()]);
                start += place.len();
            }
        }
    }

    /// From rows at points to the solution at points.
    fn solve(&mut self, world: &World, values: &mut [f64]) {
        if let Some(start) = &self.start {
            start.forward(world, values, &mut self.value_exchange);
        }
        self.first.forward(values, &mut self.waves);
        for stage in 0..D - 1 {
            if let Some(turn) = &self.turns[stage] {
                turn.forward(world, &mut self.waves, &mut self.wave_exchange);
            }
            if let Some(transform) = self.middle.get_mut(stage) {
                transform.forward(&mut self.waves);
            }
        }
        self.last.solve(&mut self.waves);
        for stage in (0..D - 1).rev() {
            if let Some(transform) = self.middle.get_mut(stage) {
                transform.backward(&mut self.waves);
            }
            if let Some(turn) = &self.turns[stage] {
                turn.backward(world, &mut self.waves, &mut self.wave_exchange);
            }
        }
        self.first.backward(&mut self.waves, values);
        if let Some(start) = &self.start {
            start.backward(world, values, &mut self.value_exchange);
        }
    }
}

impl<const D: usize> StokesInverse<D> for TransformInverse<D> {
    fn precondition(&mut self, stokes: &Stokes<D>, rows: &Vector, output: &mut Vector) -> Result<()> {
        output.copy_from(rows)?;
        self.replace(stokes, output)
    }

    fn replace(&mut self, stokes: &Stokes<D>, fluid: &mut Vector) -> Result<()> {
        let (world, mut fluid) = (stokes.session().world(), fluid.local_mut()?);
        let Some(mut values) = self.values.take() else {
            for Field { range, factor, .. } in &self.fields {
                fluid[range.clone()].iter_mut().for_each(|value| *value *= factor);
            }
            self.solve(world, &mut fluid);
            return Ok(());
        };
        self.take(&fluid, &mut values);
        self.solve(world, &mut values);
        self.put(&values, &mut fluid);
        self.values = Some(values);
        Ok(())
    }

    fn exact(&self) -> bool {
        true
    }
}

impl<const D: usize> LastAxis<D> {
    fn new(lines: Lines<D>, axis: usize, grid: &Grid<D>, shift: f64) -> LastAxis<D> {
        let symbols = Symbols::new(grid);
        if grid.domain().periodic(axis) {
            LastAxis::Periodic(PeriodicLines::new(lines, axis, grid, shift, symbols))
        } else {
            LastAxis::Channel(ChannelLines::new(lines, axis, grid, shift, symbols))
        }
    }

    /// Replaces rows by the solution.
    fn solve(&mut self, waves: &mut [Complex<f64>]) {
        match self {
            LastAxis::Periodic(lines) => lines.solve(waves),
            LastAxis::Channel(lines) => lines.solve(waves),
        }
    }
}

fn fields<const D: usize>(stokes: &Stokes<D>, grid: &Grid<D>, cells: Block<D>) -> Vec<Field> {
    let periodic = (0..D).filter(|&axis| grid.domain().periodic(axis));
    let growth: f64 = periodic.map(|axis| grid.cells()[axis] as f64).product();
    let field = |(field, (range, balance)): (usize, (Range<usize>, f64))| {
        let places = cells.runs(grid.block(field)).into_iter();
        let places = places.map(|run| field * cells.len() + run.start..field * cells.len() + run.end).collect();
        Field { range, places, factor: 1.0 / (balance * growth) }
    };
    stokes.balanced_fields().into_iter().enumerate().map(field).collect()
}
