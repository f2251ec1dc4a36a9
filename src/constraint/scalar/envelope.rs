//! The potential of sources in one inclusion, which nothing but its own links holds together.

use super::links::Link;
use crate::constraint::skyline::Skyline;

/// Cholesky factors of the Laplacian of its cells, of which the last is held.
pub struct Envelope(Skyline);

impl Envelope {
    /// Factors the Laplacian of cells that their links connect.
    pub fn new(cells: usize, links: &[Link]) -> Envelope {
        let mut firsts: Vec<usize> = (0..cells).collect();
        for &Link { cells: [one, two], .. } in links {
            firsts[one.max(two)] = firsts[one.max(two)].min(one.min(two));
        }
        firsts.truncate(cells - 1);
        let mut laplacian = Skyline::new(firsts);
        for &Link { cells: [one, two], weight } in links {
            [(one, one, weight), (two, two, weight), (one.max(two), one.min(two), -weight)]
                .into_iter()
                .filter(|(row, ..)| row + 1 < cells)
                .for_each(|(row, column, weight)| laplacian.add(row, column, weight));
        }
        Envelope(laplacian.factor())
    }

    /// Adds to `out` the potential of sources in the cells: both without their means.
    pub fn add_potential(&self, sources: &[f64], out: &mut [f64]) {
        let mean = sources.iter().sum::<f64>() / sources.len() as f64;
        let mut potential: Vec<f64> = sources.iter().map(|source| source - mean).collect();
        if let Some((held, others)) = potential.split_last_mut() {
            *held = 0.0;
            self.0.solve(others);
        }
        let mean = potential.iter().sum::<f64>() / sources.len() as f64;
        out.iter_mut().zip(potential).for_each(|(out, potential)| *out += potential - mean);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_laplacian_of_the_potential_is_the_source() {
        let link = |one: usize, two: usize| Link { cells: [one, two], weight: 1.0 + (one * two) as f64 };
        let links: Vec<Link> = (0..3)
            .flat_map(|x| (0..4).map(move |y| 4 * x + y))
            .flat_map(|cell| {
                let (up, right) = ((cell % 4 < 3).then(|| link(cell + 1, cell)), (cell < 8).then(|| link(cell, cell + 4)));
                up.into_iter().chain(right)
            })
            .collect();
        let mut sources: Vec<f64> = (0..12).map(|cell| (cell as f64).sin()).collect();
        let mean = sources.iter().sum::<f64>() / 12.0;
        sources.iter_mut().for_each(|source| *source -= mean);
        let mut potential = vec![0.0; 12];
        Envelope::new(12, &links).add_potential(&sources, &mut potential);
        assert!(potential.iter().sum::<f64>().abs() < 1e-13);
        for &Link { cells: [one, two], weight } in &links {
            let flux = weight * (potential[one] - potential[two]);
            sources[one] -= flux;
            sources[two] += flux;
        }
        assert!(sources.iter().all(|left| left.abs() < 1e-13), "{sources:?}");
    }
}
