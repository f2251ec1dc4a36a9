//! Inverses of shifted Laplacians of the fields in a box between walls, exact but for rounding: along each axis a transform makes numbers of second differences.

use std::ops::Range;

use super::{
    along_axis::{AxisTransform, LineEnds},
    lines::{Lines, TILE},
    stages::separated,
};
use crate::{
    error::Result,
    flow::{Stokes, stokes_inverse::projection::FieldInverse},
    geometry::{Axis, Domain},
    grid::{Exchange, Grid, Redistribution},
    parallel::World,
    petsc::Vector,
};

/// Inverses of all fields.
pub struct SeparatedInverse<const D: usize> {
    fields: Vec<Field<D>>,
    /// Lines along the axes in the order in which they are whole.
    lines: Vec<Lines<D>>,
    order: [usize; D],
    /// To where each axis is whole.
    turns: Vec<Option<Redistribution>>,
    values: Vec<f64>,
    exchange: Exchange<f64>,
    tile: Vec<f64>,
}

struct Field<const D: usize> {
    /// Where its unknowns lie in this rank's values.
    places: Vec<Range<usize>>,
    shift: f64,
    transforms: [AxisTransform; D],
}

impl<const D: usize> SeparatedInverse<D> {
    /// Whether it serves a box: fluid must not flow in or out.
    pub fn fits(domain: &Domain<D>) -> bool {
        domain.axes.iter().all(|axis| !matches!(axis, Axis::Open(_) | Axis::Sheared(_)))
    }

    /// Plans the transforms.
    pub fn new(stokes: &Stokes<D>, grid: &Grid<D>) -> SeparatedInverse<D> {
        let rank = stokes.session().world().rank();
        let (layouts, order) = separated(grid);
        let turns: Vec<_> = layouts.windows(2).map(|pair| Redistribution::new(&pair[0], &pair[1], rank, 1)).collect();
        let lines: Vec<Lines<D>> = layouts[1..].iter().zip(order).map(|(layout, axis)| Lines::new(layout.0[rank], axis)).collect();
        let longest = lines.iter().map(Lines::points).max().unwrap_or(0);
        let most = layouts.iter().map(|layout| layout.0[rank].len()).max().unwrap_or(0);
        let cells = layouts[0].0[rank];
        let field = |field: usize| Field {
            places: cells.runs(grid.block(field)),
            shift: if field < D { stokes.shift() } else { 0.0 },
            transforms: std::array::from_fn(|axis| AxisTransform::new(ends(grid, field, axis), grid.cells()[axis], grid.spacing()[axis])),
        };
        SeparatedInverse {
            fields: (0..=D).map(field).collect(),
            lines,
            order,
            values: vec![0.0; most],
            exchange: Exchange::new(turns.iter().flatten(), 0.0),
            tile: vec![0.0; TILE * longest],
            turns,
        }
    }

    fn solve(&mut self, world: &World, field: usize) {
        for stage in 0..D {
            if let Some(turn) = &self.turns[stage] {
                turn.forward(world, &mut self.values, &mut self.exchange);
            }
            if stage + 1 < D {
                self.along(stage, field, AxisTransform::forward);
            }
        }
        self.along_last(field);
        for stage in (0..D).rev() {
            if stage + 1 < D {
                self.along(stage, field, AxisTransform::backward);
            }
            if let Some(turn) = &self.turns[stage] {
                turn.backward(world, &mut self.values, &mut self.exchange);
            }
        }
    }

    fn along(&mut self, stage: usize, field: usize, transform: fn(&mut AxisTransform, &mut [f64])) {
        let along = &mut self.fields[field].transforms[self.order[stage]];
        for tile in self.lines[stage].tiles() {
            let lines = &mut self.tile[..tile.lines * tile.points];
            tile.gather(&self.values, lines);
            transform(along, lines);
            tile.scatter(lines, &mut self.values);
        }
    }

    /// Solves for the waves along all axes but the last one, on which it goes there and back.
    fn along_last(&mut self, field: usize) {
        let Field { shift, transforms, .. } = &mut self.fields[field];
        let axis = self.order[D - 1];
        let growth: f64 = transforms.iter().map(|transform| transform.growth).product();
        for tile in self.lines[D - 1].tiles() {
            let lines = &mut self.tile[..tile.lines * tile.points];
            tile.gather(&self.values, lines);
            transforms[axis].forward(lines);
            for (number, line) in lines.chunks_exact_mut(tile.points).enumerate() {
                let wave = tile.line_start(number);
                let across = (0..D).filter(|&other| other != axis).map(|other| transforms[other].eigenvalues[wave[other]]);
                let others = across.sum::<f64>() + *shift;
                for (value, own) in line.iter_mut().zip(&transforms[axis].eigenvalues) {
                    // a field that may be any constant has no mean
                    let sum = others + own;
                    *value = if sum > 0.0 { *value / (sum * growth) } else { 0.0 };
                }
            }
            transforms[axis].backward(lines);
            tile.scatter(lines, &mut self.values);
        }
    }
}

impl<const D: usize> FieldInverse for SeparatedInverse<D> {
    fn apply(&mut self, world: &World, field: usize, given: &Vector, found: &mut Vector) -> Result<()> {
        self.values.fill(0.0);
        let given = given.local()?;
        let mut rest = &given[..];
        for place in &self.fields[field].places {
            let (here, after) = rest.split_at(place.len());
            self.values[place.clone()].copy_from_slice(here);
            rest = after;
        }
        self.solve(world, field);
        let mut found = found.local_mut()?;
        let mut rest = &mut found[..];
        for place in &self.fields[field].places {
            let (here, after) = rest.split_at_mut(place.len());
            here.copy_from_slice(&self.values[place.clone()]);
            rest = after;
        }
        Ok(())
    }
}

fn ends<const D: usize>(grid: &Grid<D>, field: usize, axis: usize) -> LineEnds {
    match () {
        () if grid.domain().periodic(axis) => LineEnds::Periodic,
        () if field == D => LineEnds::Flat,
        () if field == axis => LineEnds::OnWalls,
        () => LineEnds::Vanish,
    }
}
