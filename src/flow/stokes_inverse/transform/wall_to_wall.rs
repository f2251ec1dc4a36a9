//! The Stokes equations for one wave on a line from wall to wall.
//!
//! With `g` the factors of the discrete gradient of the wave, `k = |g|`, `A` and `N` minus the second differences of tangential
//! and normal velocities between the walls (the former vanish half a cell beyond their outermost points), `d` the first difference
//! from centres to faces and `d'` the one back, the part `u = conj(g) . u_t / k` of the tangential velocity `u_t`, the normal
//! velocity `v` and the pressure solve the real system
//!
//! ```text
//! (A + k^2 + s) u + k b p = r_u,   (N + k^2 + s) v + d p = r_v,   -k u + d' v = r_p
//! ```
//!
//! with the shift `s` of a flow with inertia, `b` what is left of the pressure's gradient beside walls (see [`gradient`](crate::grid::stencil::gradient)), 1 elsewhere;
//! and the part of the tangential velocity across `g` diffuses by itself. Momentum rows are multiplied by the square of the spacing
//! `s`, continuity rows by `s`, so that all entries are of the order of one; the unknown that goes with them is `s p`.

use rustfft::num_complex::Complex;

use crate::{
    grid::stencil::BESIDE_WALL,
    linalg::{BandedLanes, Lanes, Tridiagonal},
};

/// Waves that are solved side by side.
pub const LANES: usize = 4;

type Coupled = BandedLanes<COUPLED_BAND, LANES>;
type Diffusion = BandedLanes<1, LANES>;

/// Unknowns of a cell: velocity along the wave, normal velocity on the upper face, pressure. In this order pivots are the largest that there are.
const OF_CELL: usize = 3;
const COUPLED_BAND: usize = 4;

/// Solver for some waves, which differ.
pub struct WallToWall {
    spacing: f64,
    numbers: Lanes<LANES>,
    /// Velocity along the wave, normal velocity and pressure.
    coupled: Coupled,
    /// Tangential velocity across the wave.
    diffusion: Diffusion,
}

/// Solver without a wave, where velocity and pressure are sums.
pub struct WithoutWave {
    spacing: f64,
    shift: f64,
    /// Tangential velocities.
    diffusion: Tridiagonal,
}

/// The values of all fields on some lines; those of the velocity along the walled axis start on the lower wall.
pub struct Fields<'a> {
    /// Line after line.
    pub values: &'a mut [Complex<f64>],
    /// From a field to the next.
    pub step: usize,
    /// The axis from wall to wall.
    pub walled: usize,
}

/// A line of cells from wall to wall.
#[derive(Debug, Clone, Copy)]
pub struct WalledLine {
    /// How many cells it has.
    pub points: usize,
    /// Their length.
    pub spacing: f64,
}

/// A line of a wave.
pub struct WaveLine<const D: usize> {
    /// Which of the waves of a solver it is.
    pub lane: usize,
    /// Where it starts among the values.
    pub start: usize,
    /// The factors of the gradient.
    pub factors: [Complex<f64>; D],
}

/// Room for the unknowns of some lines, real and imaginary parts.
pub struct LineWorkspace {
    coupled: Vec<[Lanes<LANES>; 2]>,
    across: Vec<[Lanes<LANES>; 2]>,
}

impl LineWorkspace {
    /// For lines of `points` points.
    pub fn new(points: usize) -> LineWorkspace {
        LineWorkspace { coupled: Coupled::room(OF_CELL * points), across: Diffusion::room(points) }
    }
}

/// What a wave and the shift add to the diagonal, and whether a point lies beside a wall.
fn diagonal(line: WalledLine, number: f64, shift: f64, point: usize) -> f64 {
    let decay = (number * number + shift) * line.spacing * line.spacing;
    decay + if point == 0 || point == line.points - 1 { 3.0 } else { 2.0 }
}

impl WallToWall {
    /// Solver for waves of these `numbers`, none zero, on lines like this one.
    pub fn new(line: WalledLine, numbers: Lanes<LANES>, shift: f64) -> WallToWall {
        let WalledLine { points, spacing } = line;
        let tangential = |lane: usize, point: usize| diagonal(line, numbers[lane], shift, point);
        let coupled = Coupled::new(OF_CELL * points, |lane, row, column| {
            entry(points, spacing * numbers[lane], tangential(lane, row / OF_CELL), row, column)
        });
        let diffusion = Diffusion::new(points, |lane, row, column| if row == column { tangential(lane, row) } else { -1.0 });
        WallToWall { spacing, numbers, coupled, diffusion }
    }

    /// Replaces the rows of lines by the solution.
    pub fn solve<const D: usize>(&self, lines: &[WaveLine<D>], fields: &mut Fields, work: &mut LineWorkspace) {
        if lines.len() < LANES {
            // what is left of other lines would shrink to numbers that are slow
            work.coupled.fill([[0.0; LANES]; 2]);
            work.across.fill([[0.0; LANES]; 2]);
        }
        lines.iter().for_each(|line| self.take(line, fields, work));
        self.coupled.solve(&mut work.coupled);
        if D > 2 {
            self.diffusion.solve(&mut work.across);
        }
        lines.iter().for_each(|line| self.put(line, fields, work));
    }

    /// The directions along a wave and across it.
    fn directions<const D: usize>(&self, line: &WaveLine<D>, walled: usize) -> [[Complex<f64>; D]; 2] {
        let along = line.factors.map(|factor| factor / self.numbers[line.lane]);
        [along, across(&along, walled)]
    }

    /// Scales the rows and turns those of tangential velocities.
    fn take<const D: usize>(&self, line: &WaveLine<D>, fields: &Fields, work: &mut LineWorkspace) {
        let ([along, across], square, lane) = (self.directions(line, fields.walled), self.spacing * self.spacing, line.lane);
        let (cells, turned) = (work.coupled[COUPLED_BAND..].as_chunks_mut::<OF_CELL>().0, &mut work.across[1..]);
        let points = self.diffusion.size();
        for (point, (cell, turned)) in cells.iter_mut().zip(turned).enumerate().take(points) {
            let (mut first, mut second) = (Complex::default(), Complex::default());
            for axis in 0..D {
                let row = fields.values[axis * fields.step + line.start + point];
                first += along[axis].conj() * row;
                second += across[axis].conj() * row;
            }
            // the normal velocity on the upper wall is no unknown
            let above = line.start + point + 1;
            let normal = if point + 1 < points { fields.values[fields.walled * fields.step + above] } else { Complex::default() };
            put_lane(&mut cell[0], lane, first * square);
            put_lane(&mut cell[1], lane, normal * square);
            put_lane(&mut cell[2], lane, fields.values[D * fields.step + line.start + point] * self.spacing);
            put_lane(turned, lane, second * square);
        }
    }

    fn put<const D: usize>(&self, line: &WaveLine<D>, fields: &mut Fields, work: &LineWorkspace) {
        let ([along, across], lane) = (self.directions(line, fields.walled), line.lane);
        let (cells, turned) = (work.coupled[COUPLED_BAND..].as_chunks::<OF_CELL>().0, &work.across[1..]);
        let mut normal = Complex::default();
        for (point, ([first, above, pressure], second)) in cells.iter().zip(turned).enumerate().take(self.diffusion.size()) {
            let (first, second, place) = (take_lane(first, lane), take_lane(second, lane), line.start + point);
            for axis in 0..D {
                fields.values[axis * fields.step + place] = along[axis] * first + across[axis] * second;
            }
            fields.values[fields.walled * fields.step + place] = normal;
            fields.values[D * fields.step + place] = take_lane(pressure, lane) / self.spacing;
            normal = take_lane(above, lane);
        }
    }
}

fn put_lane(values: &mut [Lanes<LANES>; 2], lane: usize, value: Complex<f64>) {
    (values[0][lane], values[1][lane]) = (value.re, value.im);
}

fn take_lane(values: &[Lanes<LANES>; 2], lane: usize) -> Complex<f64> {
    Complex::new(values[0][lane], values[1][lane])
}

impl WithoutWave {
    /// Solver for lines like this one.
    pub fn new(line: WalledLine, shift: f64) -> WithoutWave {
        let diffusion = Tridiagonal::new((0..line.points).map(|point| diagonal(line, 0.0, shift, point)));
        WithoutWave { spacing: line.spacing, shift, diffusion }
    }

    /// Without a wave continuity rows give the normal velocity from wall to wall (they must have no mean), then its momentum
    /// rows the pressure but for its mean.
    pub fn solve<const D: usize>(&self, start: usize, fields: &mut Fields) {
        let (square, points) = (self.spacing * self.spacing, self.diffusion.size());
        for axis in (0..D).filter(|&axis| axis != fields.walled) {
            let line = &mut fields.values[axis * fields.step + start..][..points];
            line.iter_mut().for_each(|value| *value *= square);
            self.diffusion.solve(line);
        }
        let (velocities, pressures) = fields.values.split_at_mut(D * fields.step);
        let normal = &mut velocities[fields.walled * fields.step + start..][..points];
        let pressures = &mut pressures[start..][..points];
        remove_mean(pressures);
        self.sum_up(normal, pressures);
        remove_mean(pressures);
    }

    /// Turns rows of the normal velocity and of continuity into the normal velocity and the pressure, which starts with zero.
    fn sum_up(&self, normal: &mut [Complex<f64>], pressures: &mut [Complex<f64>]) {
        let (mut before, mut velocity, mut pressure) = (Complex::default(), Complex::default(), Complex::default());
        for (point, (value, source)) in normal.iter_mut().zip(pressures).enumerate() {
            let after = velocity + *source * self.spacing;
            // on the wall there is no row
            if point > 0 {
                let drag = (velocity * 2.0 - before - after) / self.spacing + velocity * self.shift * self.spacing;
                pressure += *value * self.spacing - drag;
            }
            *value = velocity;
            *source = pressure;
            (before, velocity) = (velocity, after);
        }
    }
}

/// The direction at right angles to that of the wave and to the walled axis; none in two dimensions.
fn across<const D: usize>(along: &[Complex<f64>; D], walled: usize) -> [Complex<f64>; D] {
    let mut across = [Complex::default(); D];
    if D == 3 {
        let (first, second) = ((walled + 1) % D, (walled + 2) % D);
        (across[first], across[second]) = (-along[second].conj(), along[first].conj());
    }
    across
}

fn remove_mean(values: &mut [Complex<f64>]) {
    let mean = values.iter().sum::<Complex<f64>>() / values.len() as f64;
    values.iter_mut().for_each(|value| *value -= mean);
}

/// An entry of the coupled matrix of a wave; rows and columns are velocity along the wave, normal velocity on the upper face and pressure of a cell in turn.
/// `tangential` is the diagonal entry of the velocity along the wave in the cell of the row.
fn entry(points: usize, number: f64, tangential: f64, row: usize, column: usize) -> f64 {
    let (cell, other) = (row / OF_CELL, column / OF_CELL);
    let at_edge = cell == 0 || cell == points - 1;
    // the normal velocity on the upper wall is no unknown
    let on_wall = OF_CELL * points - 2;
    if row == on_wall || column == on_wall {
        return if row == column { 1.0 } else { 0.0 };
    }
    match (row % OF_CELL, column % OF_CELL, other as isize - cell as isize) {
        (0, 0, 0) => tangential,
        (1, 1, 0) => tangential - if at_edge { 1.0 } else { 0.0 },
        (0, 0, -1 | 1) | (1, 1, -1 | 1) | (1, 2, 0) | (2, 1, -1) => -1.0,
        (1, 2, 1) | (2, 1, 0) => 1.0,
        (0, 2, 0) => number * if at_edge { BESIDE_WALL } else { 1.0 },
        (2, 0, 0) => -number,
        _ => 0.0,
    }
}
