//! Box with walls across one axis: for every wave along the other axes, a line from wall to wall by itself.

use rustfft::num_complex::Complex;

use super::{
    lines::{Lines, TILE},
    symbols::Symbols,
    wall_to_wall::{Fields, LineWorkspace, WallToWall},
};
use crate::grid::{Block, Grid};

/// The solution of all lines between the walls, a tile at a time.
pub struct ChannelLines<const D: usize> {
    lines: Lines<D>,
    walled: usize,
    symbols: Symbols<D>,
    /// The solvers that differ, and which one each line has.
    solvers: Vec<WallToWall>,
    solver_of: Vec<usize>,
    tile: Vec<Complex<f64>>,
    work: LineWorkspace,
}

impl<const D: usize> ChannelLines<D> {
    /// The lines of a block between the walls of the axis `walled`, already transformed along all other axes.
    pub fn new(lines: Lines<D>, walled: usize, (grid, shift): (&Grid<D>, f64), symbols: Symbols<D>) -> ChannelLines<D> {
        let (points, spacing) = (lines.points(), grid.spacing()[walled]);
        let (mut solvers, mut solver_of) = (Vec::new(), Vec::new());
        // waves that run in opposite directions have the same solver
        let folded = Block { start: [0; D], end: grid.cells().map(|cells| cells / 2 + 1) }.flattened(walled);
        let mut known = vec![None; folded.len()];
        for wave in lines.block().flattened(walled).indices() {
            let wave = std::array::from_fn(|axis| wave[axis].min(grid.cells()[axis] - wave[axis]));
            let solver = known[folded.offset(wave)].get_or_insert_with(|| {
                solvers.push(WallToWall::new((points, spacing), number(&factors(&symbols, walled, wave)), shift));
                solvers.len() - 1
            });
            solver_of.push(*solver);
        }
        let tile = vec![Complex::default(); (D + 1) * TILE * points];
        ChannelLines { lines, walled, symbols, solvers, solver_of, tile, work: LineWorkspace::new(points) }
    }

    /// Replaces rows by the solution.
    pub fn solve(&mut self, values: &mut [Complex<f64>]) {
        let (extent, points) = (self.lines.block().len(), self.lines.points());
        let waves = self.lines.block().flattened(self.walled);
        for tile in self.lines.tiles() {
            let size = tile.lines * points;
            (0..=D).for_each(|field| tile.gather(&values[field * extent..], &mut self.tile[field * size..]));
            for line in 0..tile.lines {
                let wave = tile.line_start(line);
                let factors = factors(&self.symbols, self.walled, wave);
                let mut fields = Fields { values: &mut self.tile[line * points..], step: size, walled: self.walled };
                self.solvers[self.solver_of[waves.offset(wave)]].solve(&factors, &mut fields, &mut self.work);
            }
            (0..=D).for_each(|field| tile.scatter(&self.tile[field * size..], &mut values[field * extent..]));
        }
    }
}

/// The factors of the gradient for a wave, zero along the walled axis.
fn factors<const D: usize>(symbols: &Symbols<D>, walled: usize, wave: [usize; D]) -> [Complex<f64>; D] {
    std::array::from_fn(|axis| if axis == walled { Complex::default() } else { symbols.gradient(axis)[wave[axis]] })
}

/// The number of the wave, `|g|`.
fn number<const D: usize>(factors: &[Complex<f64>; D]) -> f64 {
    factors.iter().map(Complex::norm_sqr).sum::<f64>().sqrt()
}
