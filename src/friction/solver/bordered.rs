//! Newton's equations of the [interior point](super::interior_point) where few modes add to the mobility of contacts: each is one more unknown, an amplitude
//! `y = g (e . f)` by which velocities grow by `e y`, so that the matrix has a border.

use nalgebra::{DMatrix, DVector, Dyn, LU};

use super::pairs::Newton;
use crate::{
    contact::solver::block_lu::BlockLu,
    friction::{program::FrictionProgram, row_block::RowBlock, secant::dot},
};

/// The border, once the rest is factored.
pub struct Border<const W: usize> {
    /// What forces of the border move bodies by.
    moved: Vec<Vec<[f64; W]>>,
    complement: LU<f64, Dyn, Dyn>,
}

impl<const D: usize, const W: usize> FrictionProgram<D, W> {
    /// What impulses change by where velocities grow so: of a row block that turns a contact without the normal one.
    fn answers(&self, newton: &[Newton<D>], rates: &[[f64; D]]) -> Vec<[f64; D]> {
        let answer = |(place, (newton, rates)): (usize, (&Newton<D>, &[f64; D]))| {
            let first = usize::from(self.follows(place));
            let of_row = |row: &[f64; D]| row.iter().zip(rates).map(|(entry, rate)| entry * rate).sum::<f64>();
            std::array::from_fn(|axis| if axis < first { 0.0 } else { of_row(&newton.matrix[axis]) })
        };
        newton.iter().zip(rates).enumerate().map(answer).collect()
    }

    fn rates(&self, motion: &[[f64; W]]) -> Vec<[f64; D]> {
        self.row_blocks.iter().map(|row_block: &RowBlock<D, W>| row_block.rates(motion)).collect()
    }

    /// How forces move contacts without what corrects the mobility.
    pub fn rates_alone(&self, forces: &[[f64; D]]) -> Vec<[f64; D]> {
        self.rates(&self.motion(forces))
    }
}

impl<const W: usize> Border<W> {
    /// The border of a matrix that is factored; nothing without modes.
    pub fn new<const D: usize>(program: &FrictionProgram<D, W>, factors: &BlockLu, newton: &[Newton<D>]) -> Option<Border<W>> {
        let count = program.modes.len();
        if count == 0 {
            return None;
        }
        let mut complement = DMatrix::zeros(count, count);
        let mut moved = Vec::with_capacity(count);
        for (column, mode) in program.modes.iter().enumerate() {
            let answers = program.answers(newton, &mode.rates);
            let mut motion = program.pushes(&answers);
            factors.solve(motion.as_flattened_mut());
            let back = program.answers(newton, &program.rates(&motion));
            for (row, other) in program.modes.iter().enumerate() {
                complement[(row, column)] = dot(&other.rates, &answers) - dot(&other.rates, &back);
            }
            complement[(column, column)] += 1.0 / mode.gain;
            moved.push(motion);
        }
        Some(Border { moved, complement: complement.lu() })
    }

    /// The change of amplitudes, of which a change of motions without them is made one with them.
    pub fn amplitudes<const D: usize>(
        &self,
        program: &FrictionProgram<D, W>,
        newton: &[Newton<D>],
        wanted: &[f64],
        motion: &mut [[f64; W]],
    ) -> Vec<f64> {
        let back = program.answers(newton, &program.rates(motion));
        let side = wanted.iter().zip(&program.modes).map(|(wanted, mode)| wanted - dot(&mode.rates, &back));
        let side = DVector::from_iterator(wanted.len(), side);
        // of a singular border nothing is known
        let amplitudes = self.complement.solve(&side).unwrap_or_else(|| DVector::zeros(wanted.len()));
        for (moved, amplitude) in self.moved.iter().zip(&amplitudes) {
            motion.as_flattened_mut().iter_mut().zip(moved.as_flattened()).for_each(|(entry, moved)| *entry -= amplitude * moved);
        }
        amplitudes.as_slice().to_vec()
    }
}
