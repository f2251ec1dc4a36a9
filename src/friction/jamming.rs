//! Whether contacts leave any way: motions with which none closes faster than it may, `A x + q` in the dual cones, `u_N >= mu |u_T|`.
//!
//! If there are some, the exact law has a solution (Acary, Cadoux, Lemarechal and Malick 2011). If there are none, forces in the cones balance each other on
//! all bodies while they hold against what drives them, of any size: bodies that are sheared at a fixed volume are jammed then.

use clarabel::{algebra::CscMatrix, solver::SupportedConeT};

use super::program::FrictionProgram;
use crate::contact::solver::clarabel::solve_in_cones;

impl<const D: usize, const W: usize> FrictionProgram<D, W> {
    /// Whether no motion of its bodies keeps all contacts, as a solver of convex programs finds it; nothing if it finds neither. Where couples resist, a motion
    /// must keep the sum of all bounds of a contact: one that keeps each alone says nothing.
    pub fn is_jammed(&self) -> Option<bool> {
        let rows: Vec<[f64; D]> = self.row_blocks.iter().flat_map(|row_block| cone_rows(row_block.friction)).collect();
        let per_block = if rows.is_empty() { return Some(false) } else { rows.len() / self.row_blocks.len() };
        let (mut places, mut entries, mut starts, mut offsets) = (Vec::new(), Vec::new(), vec![0], Vec::new());
        for (number, row) in rows.iter().enumerate() {
            let row_block = &self.row_blocks[number / per_block];
            let of = |values: &dyn Fn(usize) -> f64| (0..D).map(|axis| row[axis] * values(axis)).sum::<f64>();
            let mut sides: Vec<_> = row_block.sides().collect();
            sides.sort_unstable_by_key(|(body, _)| *body);
            for (body, rows) in sides {
                places.extend((0..W).map(|entry| body * W + entry));
                entries.extend((0..W).map(|entry| of(&|axis| rows[axis][entry])));
            }
            starts.push(places.len());
            offsets.push(of(&|axis| row_block.offset[axis] / self.unit));
        }
        let cone = |count: usize| match D {
            2 => SupportedConeT::NonnegativeConeT(count),
            _ => SupportedConeT::SecondOrderConeT(count),
        };
        let transposed = CscMatrix::new(W * self.bodies, offsets.len(), starts, places, entries);
        let answer = solve_in_cones(&transposed, &offsets, &vec![cone(per_block); self.row_blocks.len()])?;
        let says = answer.infeasible || answer.solved && (0..self.row_blocks.len()).all(|row_block| !self.follows(row_block));
        says.then_some(answer.infeasible)
    }
}

/// What a contact's velocity is multiplied by to be in a cone: two numbers that are not negative in two dimensions, a second-order cone in three.
fn cone_rows<const D: usize>(friction: f64) -> Vec<[f64; D]> {
    let row = |normal: f64, tangent: Option<(usize, f64)>| {
        let mut row = [0.0; D];
        row[0] = normal;
        tangent.into_iter().for_each(|(axis, entry)| row[axis] = entry);
        row
    };
    match D {
        2 => [friction, -friction].map(|slope| row(1.0, Some((1, slope)))).to_vec(),
        _ => std::iter::once(row(1.0, None)).chain((1..D).map(|axis| row(0.0, Some((axis, friction))))).collect(),
    }
}
