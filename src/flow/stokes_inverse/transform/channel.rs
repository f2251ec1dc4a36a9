//! Box with walls across one axis: for every wave along the other axes, a line from wall to wall by itself.

use rustfft::num_complex::Complex;

use super::{
    lines::{Lines, TILE, Tile},
    symbols::Symbols,
    wall_to_wall::{Fields, LANES, LineWorkspace, WallToWall, WalledLine, WaveLine, WithoutWave},
};
use crate::grid::{Block, Grid};

/// The solution of all lines between the walls, a tile at a time.
pub struct ChannelLines<const D: usize> {
    lines: Lines<D>,
    walled: usize,
    symbols: Symbols<D>,
    /// The solvers that differ, each of some neighbouring waves.
    solvers: Vec<WallToWall>,
    without_wave: WithoutWave,
    /// For each line its solver, and which of the waves of that it is; nothing without a wave.
    places: Vec<Option<(usize, usize)>>,
    tile: Vec<Complex<f64>>,
    work: LineWorkspace,
}

impl<const D: usize> ChannelLines<D> {
    /// The lines of a block between the walls of the axis `walled`, already transformed along all other axes.
    pub fn new(lines: Lines<D>, walled: usize, grid: &Grid<D>, shift: f64, symbols: Symbols<D>) -> ChannelLines<D> {
        let line = WalledLine { points: lines.points(), spacing: grid.spacing()[walled] };
        let (mut solvers, mut places, across) = (Vec::new(), Vec::new(), lines.across());
        // waves that run in opposite directions have the same solver
        let folded = Block { start: [0; D], end: grid.cells().map(|cells| cells / 2 + 1) }.flattened(walled);
        let mut known = vec![None; folded.len()];
        for wave in lines.block().flattened(walled).indices() {
            let wave: [usize; D] = std::array::from_fn(|axis| wave[axis].min(grid.cells()[axis] - wave[axis]));
            let lane = wave[across] % LANES;
            let of_lane = |lane: usize| {
                let mut other = wave;
                other[across] = (wave[across] / LANES * LANES + lane).min(folded.end[across] - 1);
                number(&factors(&symbols, walled, other))
            };
            let mut first = wave;
            first[across] -= lane;
            let solver = known[folded.offset(first)].get_or_insert_with(|| {
                // any number stands for none, whose line is not solved here
                let numbers = std::array::from_fn(of_lane).map(|number: f64| if number > 0.0 { number } else { 1.0 / line.spacing });
                solvers.push(WallToWall::new(line, numbers, shift));
                solvers.len() - 1
            });
            places.push((of_lane(lane) > 0.0).then_some((*solver, lane)));
        }
        let (tile, work) = (vec![Complex::default(); (D + 1) * TILE * line.points], LineWorkspace::new(line.points));
        ChannelLines { lines, walled, symbols, solvers, without_wave: WithoutWave::new(line, shift), places, tile, work }
    }

    /// Replaces rows by the solution.
    pub fn solve(&mut self, values: &mut [Complex<f64>]) {
        let extent = self.lines.block().len();
        for tile in self.lines.tiles() {
            let size = tile.lines * tile.points;
            (0..=D).for_each(|field| tile.gather(&values[field * extent..], &mut self.tile[field * size..]));
            self.solve_tile(&tile);
            (0..=D).for_each(|field| tile.scatter(&self.tile[field * size..], &mut values[field * extent..]));
        }
    }

    /// Solves the lines of a tile, those that follow each other and have a solver in common together.
    fn solve_tile(&mut self, tile: &Tile<D>) {
        let waves = self.lines.block().flattened(self.walled);
        let mut fields = Fields { values: &mut self.tile, step: tile.lines * tile.points, walled: self.walled };
        let (mut together, mut common): (Vec<WaveLine<D>>, usize) = (Vec::with_capacity(LANES), 0);
        for line in 0..tile.lines {
            let (wave, start) = (tile.line_start(line), line * tile.points);
            let Some((solver, lane)) = self.places[waves.offset(wave)] else {
                self.without_wave.solve::<D>(start, &mut fields);
                continue;
            };
            if !together.is_empty() && (solver != common || together.iter().any(|other| other.lane == lane)) {
                self.solvers[common].solve(&together, &mut fields, &mut self.work);
                together.clear();
            }
            common = solver;
            together.push(WaveLine { lane, start, factors: factors(&self.symbols, self.walled, wave) });
        }
        if !together.is_empty() {
            self.solvers[common].solve(&together, &mut fields, &mut self.work);
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
