//! The block C: stencils that cross a surface, corrected for the jumps there.

use nalgebra::SVector;

use super::{jumps::Jumps, nodes::JumpNodes};
use crate::{
    constraint::{
        conservation::{AtOffsets, TERMS, Wanted, conserve_momentum},
        placed::Placed,
        rows::Rows,
    },
    grid::{
        Grid, dirichlet,
        stencil::{self, Site, Term},
    },
};

/// What the tractions of a body near a wall exert on it directly: the rows beside it do not have it.
pub struct OnWall {
    /// The axis across the wall.
    pub axis: usize,
    /// Whether it is the upper one.
    pub upper: bool,
    /// The component of the force.
    pub component: usize,
    /// For each mode.
    pub values: Vec<f64>,
}

/// The rows of C of one body, under way: first which jumps they take, then their values.
pub struct Spreading<'a, const D: usize> {
    grid: &'a Grid<D>,
    placed: &'a Placed<D>,
    nodes: &'a [JumpNodes<D>],
    /// Unknown of each row.
    unknowns: Vec<usize>,
    rows: Corrections<D>,
    /// What passes to points of walls.
    walls: Corrections<D>,
    /// The wall of each of these points: its axis, and whether it is the upper one.
    walls_of: Vec<(usize, bool)>,
}

/// The distance of the farthest node of a stencil: of a neighbour, or on oblique grids of one across a corner.
fn row_reach<const D: usize>(grid: &Grid<D>) -> f64 {
    let spacing = grid.spacing();
    if grid.slope() == 0.0 { spacing.max() } else { spacing.max().max((1.0 + grid.slope().abs()) * spacing[0].hypot(spacing[1])) }
}

/// Which jumps rows take, field by field.
#[derive(Default)]
struct Corrections<const D: usize> {
    /// Offset of each row from the centre.
    offsets: Vec<SVector<f64, D>>,
    /// For each field, where its rows end.
    field_ends: Vec<usize>,
    /// For each row, where its groups end.
    row_ends: Vec<usize>,
    /// Terms from one field: the field, and where they end.
    groups: Vec<(usize, usize)>,
    /// Row of the jumps, and factor.
    terms: Vec<(u32, f64)>,
}

impl<'a, const D: usize> Spreading<'a, D> {
    /// Finds the rows that reach across the surface and asks for the jumps that they take.
    pub fn new(grid: &'a Grid<D>, placed: &'a Placed<D>, nodes: &'a [JumpNodes<D>], jumps: &mut [Jumps]) -> Self {
        let (rows, walls) = (Corrections::default(), Corrections::default());
        let mut spreading = Spreading { grid, placed, nodes, unknowns: Vec::new(), rows, walls, walls_of: Vec::new() };
        for field in 0..nodes.len() {
            spreading.find_rows(field, jumps);
            spreading.rows.end_field();
            if field < D && nodes.len() > 1 {
                spreading.find_walls(field, jumps);
            }
            spreading.walls.end_field();
        }
        spreading
    }

    fn find_rows(&mut self, field: usize, jumps: &mut [Jumps]) {
        let near = self.near();
        let nodes = &self.nodes[field];
        nodes.runs(
            self.grid,
            |row| row,
            |first, length, unknown| {
                for along in (0..length).filter(|along| near.contains(&nodes.squares[first + along])) {
                    self.find_row(field, first + along, jumps);
                    if self.rows.end_row(|| nodes.position(first + along) - self.placed.center) {
                        self.unknowns.push(unknown + along);
                    }
                }
            },
        );
    }

    /// Squares of distances from the centre at which rows may reach across the surface.
    fn near(&self) -> std::ops::RangeInclusive<f64> {
        let ([inner, outer], reach) = (self.placed.surface.modes.bounds(), row_reach(self.grid));
        (inner - reach).max(0.0).powi(2)..=(outer + reach).powi(2)
    }

    /// Whether a stencil at a wall may reach the body.
    fn is_near_wall(&self) -> bool {
        let (domain, center) = (self.grid.domain(), &self.placed.center);
        let reach = self.placed.ball().radius + self.grid.spacing().max();
        (0..D).any(|axis| !domain.periodic(axis) && (center[axis] <= reach || center[axis] >= domain.size[axis] - reach))
    }

    /// Collects the corrections of a momentum row (along axis `field`), of a continuity row, or of the one row of a scalar.
    fn find_row(&mut self, field: usize, place: usize, jumps: &mut [Jumps]) {
        let Self { grid, nodes, rows, .. } = self;
        let (index, outside) = (nodes[field].indices.index(place), nodes[field].outside[place]);
        let side = if outside { 1.0 } else { -1.0 };
        if nodes.len() == 1 {
            let mut group = rows.group(&nodes[field], &mut jumps[field], outside, side);
            dirichlet::laplacian(grid, index, |index, weight| group.take(Term { site: Site::Lattice { field, index }, weight }));
            return;
        }
        if field == D {
            for axis in 0..D {
                let mut group = rows.group(&nodes[axis], &mut jumps[axis], outside, -side);
                stencil::divergence(grid, axis, index).for_each(|term| group.take(term));
            }
            return;
        }
        let mut group = rows.group(&nodes[field], &mut jumps[field], outside, side);
        stencil::laplacian(grid, field, index, |term| group.take(term));
        drop(group);
        let mut group = rows.group(&nodes[D], &mut jumps[D], outside, -side);
        stencil::gradient(grid, field, index).for_each(|term| group.take(term));
    }

    /// Collects what passes to the points of walls where a velocity component is known.
    fn find_walls(&mut self, field: usize, jumps: &mut [Jumps]) {
        if !self.is_near_wall() {
            return;
        }
        let near = self.near();
        let nodes = &self.nodes[field];
        for place in (0..nodes.indices.len()).filter(|&place| near.contains(&nodes.squares[place])) {
            let index = nodes.indices.index(place);
            let Some(wall) = stencil::wall_at(self.grid, field, index) else { continue };
            let (mut velocities, mut pressures) = (Vec::new(), Vec::new());
            stencil::wall_row(self.grid, field, index, wall, |term| velocities.push(term), |term| pressures.push(term));
            for (from, side, terms) in [(field, 1.0, velocities), (D, -1.0, pressures)] {
                let mut group = self.walls.group(&self.nodes[from], &mut jumps[from], true, side);
                terms.into_iter().for_each(|term| group.take(term));
            }
            if self.walls.end_row(|| nodes.position(place) - self.placed.center) {
                self.walls_of.push((wall.axis, wall.inward < 0));
            }
        }
    }

    /// All rows, from evaluated jumps, and what passes to walls; `values` is memory to use again. Behind the modes are values of sources,
    /// which have these moments in each component.
    pub fn rows(self, jumps: &[Jumps], sources: &[Vec<[f64; TERMS]>], mut values: Vec<f64>) -> (Rows, Vec<OnWall>) {
        let (count, components) = (self.placed.surface.modes.jump_count(), self.placed.surface.modes.components());
        let cell_volume = self.grid.spacing().product();
        self.rows.evaluate(jumps, count, &mut values);
        let mut to_walls = Vec::new();
        self.walls.evaluate(jumps, count, &mut to_walls);
        for (component, sources) in sources.iter().enumerate().take(components) {
            let (rows, walls) = (self.rows.field(component), self.walls.field(component));
            let passed =
                AtOffsets { offsets: &self.walls.offsets[walls.clone()], values: &to_walls[walls.start * count..walls.end * count] };
            let corrected =
                AtOffsets { offsets: &self.rows.offsets[rows.clone()], values: &mut values[rows.start * count..rows.end * count] };
            let wanted = Wanted { surface: &self.placed.surface, component, sources, cell_volume };
            conserve_momentum(&wanted, passed, corrected);
        }
        to_walls.iter_mut().for_each(|value| *value *= cell_volume);
        let on_walls = self.sum_on_walls(&to_walls, count);
        (Rows::new(self.unknowns, values), on_walls)
    }

    /// Where the rows of each field end.
    pub fn field_ends(&self) -> Vec<usize> {
        self.rows.field_ends.clone()
    }

    fn sum_on_walls(&self, to_walls: &[f64], count: usize) -> Vec<OnWall> {
        let mut found: Vec<OnWall> = Vec::new();
        for component in 0..self.placed.surface.modes.components() {
            for point in self.walls.field(component) {
                let (axis, upper) = self.walls_of[point];
                let values = &to_walls[point * count..][..count];
                match found.iter_mut().find(|wall| (wall.axis, wall.upper, wall.component) == (axis, upper, component)) {
                    Some(wall) => wall.values.iter_mut().zip(values).for_each(|(sum, value)| *sum += value),
                    None => found.push(OnWall { axis, upper, component, values: values.to_vec() }),
                }
            }
        }
        found
    }
}

impl<const D: usize> Corrections<D> {
    /// Starts terms, all of one field, of a row whose centre lies `outside` or not.
    fn group<'a>(&'a mut self, nodes: &'a JumpNodes<D>, jumps: &'a mut Jumps, outside: bool, factor: f64) -> Group<'a, D> {
        Group { before: self.terms.len(), corrections: self, nodes, jumps, outside, factor }
    }

    /// Ends a row, if it has any term; whether it has.
    fn end_row(&mut self, offset: impl Fn() -> SVector<f64, D>) -> bool {
        let any = self.groups.len() > self.row_ends.last().map_or(0, |&end| end);
        if any {
            self.row_ends.push(self.groups.len());
            self.offsets.push(offset());
        }
        any
    }

    fn end_field(&mut self) {
        self.field_ends.push(self.offsets.len());
    }

    /// The rows of a field.
    fn field(&self, field: usize) -> std::ops::Range<usize> {
        let start = if field == 0 { 0 } else { self.field_ends[field - 1] };
        start..self.field_ends[field]
    }

    /// Values of all rows, `count` modes each, from evaluated jumps.
    fn evaluate(&self, jumps: &[Jumps], count: usize, values: &mut Vec<f64>) {
        values.clear();
        values.reserve(self.offsets.len() * count);
        let mut row = vec![0.0; jumps[0].stride()];
        let (mut group, mut term) = (0, 0);
        for &row_end in &self.row_ends {
            row.fill(0.0);
            for &(field, end) in &self.groups[group..row_end] {
                jumps[field].add(&self.terms[term..end], &mut row);
                term = end;
            }
            values.extend_from_slice(&row[..count]);
            group = row_end;
        }
    }
}

/// Terms of a row from one field, which end when it is dropped.
struct Group<'a, const D: usize> {
    corrections: &'a mut Corrections<D>,
    nodes: &'a JumpNodes<D>,
    jumps: &'a mut Jumps,
    outside: bool,
    factor: f64,
    before: usize,
}

impl<const D: usize> Group<'_, D> {
    /// Takes a term if it reaches across the surface.
    fn take(&mut self, term: Term<D>) {
        let (Site::Lattice { index, .. } | Site::Wall { index, .. }) = term.site;
        let place = self.nodes.indices.place(index);
        if self.nodes.outside[place] != self.outside {
            self.corrections.terms.push((self.jumps.choose(place), self.factor * term.weight));
        }
    }
}

impl<const D: usize> Drop for Group<'_, D> {
    fn drop(&mut self) {
        if self.corrections.terms.len() > self.before {
            self.corrections.groups.push((self.nodes.field, self.corrections.terms.len()));
        }
    }
}
