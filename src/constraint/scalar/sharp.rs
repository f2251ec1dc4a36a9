//! The sharp method: flux multipliers on the surface, and stencils corrected for the jump of the slope.
//!
//! As in the method for velocities, a stencil takes values from across a surface as its own side would extend them, and values on a
//! surface are interpolated from its inner extension, which in the solution is a constant. A unit source outside counts as one mode more.

use nalgebra::DMatrix;

use super::inclusion::{Inclusion, InclusionBlocks};
use crate::{
    constraint::{
        conservation::TERMS,
        method::{Method, Size},
        placed::{Placed, Surrounded},
        rows::Rows,
        sharp::{AssembledBody, INTERPOLATION_REACH, JumpNodes, Sharp, Workspace, assemble},
    },
    grid::Grid,
};

impl<const D: usize> Method<D, InclusionBlocks<D>> for Sharp {
    fn description(&self) -> String {
        "with surface multipliers and corrected stencils (sharp)".into()
    }

    fn assemble(&self, grid: &Grid<D>, bodies: &[Surrounded<D>], _memory: Vec<Vec<f32>>) -> Vec<InclusionBlocks<D>> {
        let mut workspace = Workspace::new(self.precision, Vec::new());
        bodies.iter().map(|body| blocks(grid, body, &mut workspace)).collect()
    }

    fn bytes(&self, _grid: &Grid<D>, size: &Size<D>) -> f64 {
        bytes(size)
    }

    fn reach(&self) -> f64 {
        INTERPOLATION_REACH
    }
}

/// Rows, and blocks of an inclusion and of about four neighbours.
pub fn bytes<const D: usize>(size: &Size<D>) -> f64 {
    8.0 * 10.0 * (size.count as f64).powi(2)
}

fn blocks<const D: usize>(grid: &Grid<D>, surrounded: &Surrounded<D>, workspace: &mut Workspace) -> InclusionBlocks<D> {
    let placed = surrounded.placed;
    let mut assembled = assemble(grid, surrounded, workspace, |nodes| vec![vec![missing_source(grid, placed, &nodes[0])]]);
    let (by_source, values) = split_source(&mut assembled);
    let source = source(grid, &assembled.nodes[0], assembled.rows.unknowns().zip(values));
    InclusionBlocks { body: Box::new(assembled.kept(workspace)), inclusion: Inclusion::on_surface(placed, source, by_source) }
}

/// Takes the values of the source out of the blocks: what it adds to the values on the surface, and to the rows.
fn split_source<const D: usize>(assembled: &mut AssembledBody<D>) -> (Vec<f64>, Vec<f64>) {
    let count = assembled.body.surface.modes.count();
    let mut by_source = vec![0.0; count];
    for block in &mut assembled.local {
        let last = block.transposed.nrows() - 1;
        by_source.iter_mut().zip(block.transposed.row(last).iter()).for_each(|(sum, value)| *sum += value);
        block.transposed = std::mem::replace(&mut block.transposed, DMatrix::zeros(0, 0)).remove_row(last);
    }
    let rows = assembled.rows.values.chunks_exact(count + 1);
    let of_source = rows.clone().map(|row| row[count]).collect();
    assembled.rows.values = rows.flat_map(|row| &row[..count]).copied().collect();
    (by_source, of_source)
}

/// What a unit source outside differs from one everywhere, with the corrections of the rows that reach across the surface.
fn source<const D: usize>(grid: &Grid<D>, nodes: &JumpNodes<D>, corrected: impl Iterator<Item = (usize, f64)>) -> Rows {
    let (mut unknowns, mut parts) = (Vec::new(), Vec::new());
    let mut across = corrected.peekable();
    each_unknown(grid, nodes, |place, unknown| {
        let inside = if nodes.outside[place] { 0.0 } else { -1.0 };
        match across.next_if(|(row, _)| *row == unknown) {
            Some((_, value)) => parts.push(value + inside),
            None if inside < 0.0 => parts.push(inside),
            None => return,
        }
        unknowns.push(unknown);
    });
    Rows::new(unknowns, parts)
}

/// The sums over rows, and over rows times offsets over the radius, of the missing source inside.
///
/// Then every discrete flux out of a box around the inclusion is that of its multipliers and of the source outside of it.
fn missing_source<const D: usize>(grid: &Grid<D>, placed: &Placed<D>, nodes: &JumpNodes<D>) -> [f64; TERMS] {
    let ball = placed.ball();
    let mut moments = [0.0; TERMS];
    moments[0] = -ball.volume() / grid.spacing().product();
    each_unknown(grid, nodes, |place, _| {
        if !nodes.outside[place] {
            let offset = nodes.position(place) - ball.center;
            moments[0] += 1.0;
            (0..D).for_each(|axis| moments[axis + 1] += offset[axis] / ball.radius);
        }
    });
    moments
}

fn each_unknown<const D: usize>(grid: &Grid<D>, nodes: &JumpNodes<D>, mut visit: impl FnMut(usize, usize)) {
    let all = |row| row;
    nodes.runs(grid, all, |first, length, unknown| (0..length).for_each(|along| visit(first + along, unknown + along)));
}
