//! Transforms of real values along one axis in which a second difference is a number for each wave.
//!
//! Minus the second difference of a line is `(2 - 2 cos t) / h^2` for a wave of angle `t` a cell: Fourier's waves along a periodic axis, `sin` of the distance to the wall for
//! velocities that vanish there (on faces or half a cell away), `cos` for the pressure, whose difference vanishes.

use std::{f64::consts::PI, sync::Arc};

use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustdct::{DctPlanner, Dst1, TransformType2And3};
use rustfft::num_complex::Complex;

/// How the lines of a field end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineEnds {
    /// They do not: the axis is periodic.
    Periodic,
    /// The first point lies on a wall and is no unknown; values vanish there and one cell beyond the last.
    OnWalls,
    /// Values vanish half a cell beyond both ends.
    Vanish,
    /// Differences vanish across both ends.
    Flat,
}

/// A transform along an axis, and what it makes of minus the second difference.
pub struct AxisTransform {
    kind: Kind,
    /// For each place of a transformed line.
    pub eigenvalues: Vec<f64>,
    /// By how much a line grows there and back.
    pub growth: f64,
    scratch: Vec<f64>,
}

enum Kind {
    Periodic(Box<Periodic>),
    OnWalls(Arc<dyn Dst1<f64>>),
    Vanish(Arc<dyn TransformType2And3<f64>>),
    Flat(Arc<dyn TransformType2And3<f64>>),
}

struct Periodic {
    forward: Arc<dyn RealToComplex<f64>>,
    backward: Arc<dyn ComplexToReal<f64>>,
    waves: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
}

/// What of a transform of planned lengths cannot go wrong.
const PLANNED: &str = "lengths are as planned, and constant and fastest waves are real";

impl AxisTransform {
    /// That of lines of `points` points with a spacing.
    pub fn new(ends: LineEnds, points: usize, spacing: f64) -> AxisTransform {
        let mut planner = DctPlanner::new();
        let length = points as f64;
        let (kind, growth, scratch) = match ends {
            LineEnds::Periodic => (Kind::Periodic(Box::new(Periodic::new(points))), length, 0),
            LineEnds::OnWalls => {
                let plan = planner.plan_dst1(points - 1);
                let scratch = plan.get_scratch_len();
                (Kind::OnWalls(plan), 0.5 * length, scratch)
            }
            LineEnds::Vanish => {
                let plan = planner.plan_dst2(points);
                let scratch = plan.get_scratch_len();
                (Kind::Vanish(plan), 0.5 * length, scratch)
            }
            LineEnds::Flat => {
                let plan = planner.plan_dct2(points);
                let scratch = plan.get_scratch_len();
                (Kind::Flat(plan), 0.5 * length, scratch)
            }
        };
        let angle = |place: usize| match ends {
            // cosines and sines of a wave follow each other
            LineEnds::Periodic => 2.0 * PI * place.div_ceil(2) as f64 / length,
            LineEnds::Vanish => PI * (place + 1) as f64 / length,
            LineEnds::OnWalls | LineEnds::Flat => PI * place as f64 / length,
        };
        let eigenvalues = (0..points).map(|place| (2.0 - 2.0 * angle(place).cos()) / (spacing * spacing)).collect();
        AxisTransform { kind, eigenvalues, growth, scratch: vec![0.0; scratch] }
    }

    /// From points to waves.
    pub fn forward(&mut self, line: &mut [f64]) {
        let scratch = &mut self.scratch;
        match &mut self.kind {
            Kind::Periodic(periodic) => periodic.forward(line),
            Kind::OnWalls(plan) => by_sines(plan.as_ref(), line, scratch),
            Kind::Vanish(plan) => plan.process_dst2_with_scratch(line, scratch),
            Kind::Flat(plan) => plan.process_dct2_with_scratch(line, scratch),
        }
    }

    /// From waves to points, grown.
    pub fn backward(&mut self, line: &mut [f64]) {
        let scratch = &mut self.scratch;
        match &mut self.kind {
            Kind::Periodic(periodic) => periodic.backward(line),
            Kind::OnWalls(plan) => by_sines(plan.as_ref(), line, scratch),
            Kind::Vanish(plan) => plan.process_dst3_with_scratch(line, scratch),
            Kind::Flat(plan) => plan.process_dct3_with_scratch(line, scratch),
        }
    }
}

/// The sine transform of all points but the first.
fn by_sines(plan: &dyn Dst1<f64>, line: &mut [f64], scratch: &mut [f64]) {
    // the plan takes two numbers of the scratch for zeros, and leaves others there
    scratch.fill(0.0);
    plan.process_dst1_with_scratch(&mut line[1..], scratch);
}

impl Periodic {
    fn new(points: usize) -> Periodic {
        let mut planner = RealFftPlanner::new();
        let (forward, backward) = (planner.plan_fft_forward(points), planner.plan_fft_inverse(points));
        let size = forward.get_scratch_len().max(backward.get_scratch_len());
        Periodic { waves: forward.make_output_vec(), scratch: vec![Complex::default(); size], forward, backward }
    }

    fn forward(&mut self, line: &mut [f64]) {
        self.forward.process_with_scratch(line, &mut self.waves, &mut self.scratch).expect(PLANNED);
        line[0] = self.waves[0].re;
        for (pair, wave) in line[1..].chunks_mut(2).zip(&self.waves[1..]) {
            pair.iter_mut().zip([wave.re, wave.im]).for_each(|(place, part)| *place = part);
        }
    }

    fn backward(&mut self, line: &mut [f64]) {
        self.waves[0] = Complex::new(line[0], 0.0);
        for (pair, wave) in line[1..].chunks(2).zip(&mut self.waves[1..]) {
            *wave = Complex::new(pair[0], pair.get(1).copied().unwrap_or_default());
        }
        self.backward.process_with_scratch(&mut self.waves, line, &mut self.scratch).expect(PLANNED);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Minus the second difference of a line.
    fn bent(ends: LineEnds, line: &[f64], spacing: f64) -> Vec<f64> {
        let points = line.len();
        let beyond = |own: usize, other: Option<usize>| match (ends, other) {
            (_, Some(other)) => line[other],
            (LineEnds::Periodic, None) => line[if own == 0 { points - 1 } else { 0 }],
            (LineEnds::OnWalls, None) => 0.0,
            (LineEnds::Vanish, None) => -line[own],
            (LineEnds::Flat, None) => line[own],
        };
        let at = |own: usize| {
            let after = Some(own + 1).filter(|&after| after < points);
            (2.0 * line[own] - beyond(own, own.checked_sub(1)) - beyond(own, after)) / (spacing * spacing)
        };
        (0..points).map(|own| if own == 0 && ends == LineEnds::OnWalls { 0.0 } else { at(own) }).collect()
    }

    #[test]
    fn a_second_difference_is_a_number_for_each_wave() {
        for (ends, points) in [LineEnds::Periodic, LineEnds::OnWalls, LineEnds::Vanish, LineEnds::Flat]
            .into_iter()
            .flat_map(|ends| [(ends, 2), (ends, 8), (ends, 15), (ends, 40)])
        {
            let spacing = 0.3;
            let mut transform = AxisTransform::new(ends, points, spacing);
            // what one line leaves behind does not change another
            for phase in [0.0, 1.0, 2.0] {
                let mut line: Vec<f64> = (0..points).map(|point| (3.7 * point as f64 + phase).sin()).collect();
                if ends == LineEnds::OnWalls {
                    line[0] = 0.0;
                }
                let mut waves = line.clone();
                transform.forward(&mut waves);
                waves.iter_mut().zip(&transform.eigenvalues).for_each(|(wave, number)| *wave *= number / transform.growth);
                transform.backward(&mut waves);
                for (found, exact) in waves.iter().zip(bent(ends, &line, spacing)) {
                    assert!((found - exact).abs() < 1e-10, "{ends:?} {points}: {found} {exact}");
                }
            }
        }
    }
}
