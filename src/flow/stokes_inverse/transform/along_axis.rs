//! Transforms of real values along one axis in which a second difference is a number for each wave.
//!
//! Minus the second difference of a line is `(2 - 2 cos t) / h^2` for a wave of angle `t` a cell: Fourier's waves along a periodic axis; sines of the distance to the
//! wall for velocities, which vanish there (on a face or half a cell beyond the last point); cosines for the pressure, whose difference vanishes. All are made of complex
//! Fourier transforms (Makhoul 1980, doi:10.1109/TASSP.1980.1163351), each of two lines, of which one is the imaginary part.

use std::f64::consts::PI;

use rustfft::num_complex::Complex;

use super::fourier::Waves;

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
    ends: LineEnds,
    points: usize,
    waves: Waves,
    /// Two lines as they are transformed.
    pair: Vec<Complex<f64>>,
    /// `exp(-i t / 2)` of each wave.
    half_turns: Vec<Complex<f64>>,
    /// For each place of a transformed line.
    pub eigenvalues: Vec<f64>,
    /// By how much a line grows there and back.
    pub growth: f64,
}

impl AxisTransform {
    /// That of lines of `points` points with a spacing.
    pub fn new(ends: LineEnds, points: usize, spacing: f64) -> AxisTransform {
        let length = points as f64;
        let size = if ends == LineEnds::OnWalls { 2 * points } else { points };
        let angle = |place: usize| match ends {
            // cosines and sines of a wave follow each other
            LineEnds::Periodic => 2.0 * PI * place.div_ceil(2) as f64 / length,
            LineEnds::Vanish => PI * (place + 1) as f64 / length,
            LineEnds::OnWalls | LineEnds::Flat => PI * place as f64 / length,
        };
        AxisTransform {
            ends,
            points,
            waves: Waves::new(size),
            pair: vec![Complex::default(); size],
            half_turns: (0..=points).map(|wave| Complex::cis(-0.5 * PI * wave as f64 / length)).collect(),
            eigenvalues: (0..points).map(|place| (2.0 - 2.0 * angle(place).cos()) / (spacing * spacing)).collect(),
            growth: size as f64,
        }
    }

    /// From points to waves, of any number of lines.
    pub fn forward(&mut self, lines: &mut [f64]) {
        self.each_pair(lines, AxisTransform::forward_pair);
    }

    /// From waves to points, grown.
    pub fn backward(&mut self, lines: &mut [f64]) {
        self.each_pair(lines, AxisTransform::backward_pair);
    }

    fn each_pair(&mut self, lines: &mut [f64], transform: fn(&mut AxisTransform, &mut [f64], &mut [f64])) {
        let mut pairs = lines.chunks_exact_mut(2 * self.points);
        for pair in &mut pairs {
            let (one, two) = pair.split_at_mut(self.points);
            transform(self, one, two);
        }
        let alone = pairs.into_remainder();
        if !alone.is_empty() {
            transform(self, alone, &mut vec![0.0; self.points]);
        }
    }

    fn forward_pair(&mut self, one: &mut [f64], two: &mut [f64]) {
        match self.ends {
            LineEnds::Periodic => self.forward_waves(one, two),
            LineEnds::OnWalls => self.sines_on_walls(one, two),
            LineEnds::Flat => self.forward_cosines(one, two),
            LineEnds::Vanish => {
                // sines are cosines of what changes its sign from point to point, the fastest first
                alternate(one, two);
                self.forward_cosines(one, two);
                one.reverse();
                two.reverse();
            }
        }
    }

    fn backward_pair(&mut self, one: &mut [f64], two: &mut [f64]) {
        match self.ends {
            LineEnds::Periodic => self.backward_waves(one, two),
            LineEnds::OnWalls => self.sines_on_walls(one, two),
            LineEnds::Flat => self.backward_cosines(one, two),
            LineEnds::Vanish => {
                one.reverse();
                two.reverse();
                self.backward_cosines(one, two);
                alternate(one, two);
            }
        }
    }

    /// `sum_j x_j cos(pi k (j + 1/2) / n)`.
    fn forward_cosines(&mut self, one: &mut [f64], two: &mut [f64]) {
        let points = self.points;
        // even points, and odd ones backwards
        for (place, value) in self.pair.iter_mut().enumerate() {
            let point = if 2 * place < points { 2 * place } else { 2 * (points - 1 - place) + 1 };
            *value = Complex::new(one[point], two[point]);
        }
        self.waves.forward(&mut self.pair);
        for wave in 0..points {
            let (here, there) = (self.pair[wave], self.pair[(points - wave) % points].conj());
            let (first, second) = ((here + there) * 0.5, (here - there) * Complex::new(0.0, -0.5));
            (one[wave], two[wave]) = ((first * self.half_turns[wave]).re, (second * self.half_turns[wave]).re);
        }
    }

    /// The inverse, `points` times as large.
    fn backward_cosines(&mut self, one: &mut [f64], two: &mut [f64]) {
        let points = self.points;
        for wave in 0..points {
            // what the real part above has left out: the cosine that mirrors this one
            let mirrored = if wave == 0 { [0.0; 2] } else { [one[points - wave], two[points - wave]] };
            let both = Complex::new(one[wave] + mirrored[1], two[wave] - mirrored[0]);
            self.pair[wave] = both * self.half_turns[wave].conj();
        }
        self.waves.backward(&mut self.pair);
        for (place, value) in self.pair.iter().enumerate() {
            let point = if 2 * place < points { 2 * place } else { 2 * (points - 1 - place) + 1 };
            (one[point], two[point]) = (value.re, value.im);
        }
    }

    /// `2 sum_j x_j sin(pi j k / n)` of all points but the first, from lines that go on with the other sign.
    fn sines_on_walls(&mut self, one: &mut [f64], two: &mut [f64]) {
        let points = self.points;
        (self.pair[0], self.pair[points]) = (Complex::default(), Complex::default());
        for point in 1..points {
            let value = Complex::new(one[point], two[point]);
            (self.pair[point], self.pair[2 * points - point]) = (value, -value);
        }
        self.waves.forward(&mut self.pair);
        for wave in 1..points {
            // waves of lines that are odd are imaginary: -i S
            let value = self.pair[wave];
            (one[wave], two[wave]) = (-value.im, value.re);
        }
    }

    fn forward_waves(&mut self, one: &mut [f64], two: &mut [f64]) {
        let points = self.points;
        self.pair.iter_mut().zip(one.iter().zip(&*two)).for_each(|(value, (one, two))| *value = Complex::new(*one, *two));
        self.waves.forward(&mut self.pair);
        for place in 0..points {
            let wave = place.div_ceil(2);
            let (here, there) = (self.pair[wave], self.pair[(points - wave) % points].conj());
            let (first, second) = ((here + there) * 0.5, (here - there) * Complex::new(0.0, -0.5));
            let imaginary = place > 0 && place.is_multiple_of(2);
            (one[place], two[place]) = if imaginary { (first.im, second.im) } else { (first.re, second.re) };
        }
    }

    fn backward_waves(&mut self, one: &mut [f64], two: &mut [f64]) {
        let points = self.points;
        let wave_of = |line: &[f64], wave: usize| match wave {
            0 => Complex::new(line[0], 0.0),
            _ => Complex::new(line[2 * wave - 1], line.get(2 * wave).copied().unwrap_or_default()),
        };
        for wave in 0..=points / 2 {
            let (first, second) = (wave_of(one, wave), wave_of(two, wave));
            self.pair[wave] = first + second * Complex::i();
            if wave > 0 {
                self.pair[points - wave] = first.conj() + second.conj() * Complex::i();
            }
        }
        self.waves.backward(&mut self.pair);
        self.pair.iter().enumerate().for_each(|(place, value)| (one[place], two[place]) = (value.re, value.im));
    }
}

/// Changes the sign of every second value.
fn alternate(one: &mut [f64], two: &mut [f64]) {
    for line in [one, two] {
        line.iter_mut().skip(1).step_by(2).for_each(|value| *value = -*value);
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
        let all = [LineEnds::Periodic, LineEnds::OnWalls, LineEnds::Vanish, LineEnds::Flat];
        for (ends, points) in all.into_iter().flat_map(|ends| [1, 2, 3, 8, 15, 40].map(|points| (ends, points))) {
            let spacing = 0.3;
            let mut transform = AxisTransform::new(ends, points, spacing);
            let value = |place: usize| match ends {
                LineEnds::OnWalls if place.is_multiple_of(points) => 0.0,
                _ => (3.7 * place as f64 + 1.0).sin(),
            };
            // two lines together and one alone
            let lines: Vec<f64> = (0..3 * points).map(value).collect();
            let mut waves = lines.clone();
            transform.forward(&mut waves);
            for line in waves.chunks_exact_mut(points) {
                line.iter_mut().zip(&transform.eigenvalues).for_each(|(wave, number)| *wave *= number / transform.growth);
            }
            transform.backward(&mut waves);
            for (found, line) in waves.chunks_exact(points).zip(lines.chunks_exact(points)) {
                for (found, exact) in found.iter().zip(bent(ends, line, spacing)) {
                    assert!((found - exact).abs() < 1e-11, "{ends:?} {points}: {found} {exact}");
                }
            }
        }
    }
}
