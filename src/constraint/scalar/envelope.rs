//! The potential of sources in one inclusion, which nothing but its own links holds together.

use super::links::Link;
use crate::linalg::Skyline;

/// Cholesky factors of the Laplacian of its cells, of which one is held: the one that links hold best, because what rounding makes of the
/// sum of all sources leaves through it, and the others rise by that over its links.
pub struct Envelope {
    factors: Skyline,
    held: usize,
}

impl Envelope {
    /// Factors the Laplacian of cells that their links connect.
    pub fn new(cells: usize, links: &[Link]) -> Envelope {
        let held = best_held(cells, links);
        let rows = |link: &Link| link.cells.map(|cell| row_of(cell, held));
        let mut firsts: Vec<usize> = (0..cells - 1).collect();
        for link in links {
            if let [Some(one), Some(two)] = rows(link) {
                firsts[one.max(two)] = firsts[one.max(two)].min(one.min(two));
            }
        }
        let mut laplacian = Skyline::new(firsts);
        for link in links {
            rows(link).into_iter().flatten().for_each(|row| laplacian.add(row, row, link.weight));
            if let [Some(one), Some(two)] = rows(link) {
                laplacian.add(one.max(two), one.min(two), -link.weight);
            }
        }
        Envelope { factors: laplacian.factor(), held }
    }

    /// Adds to `out` the potential of sources in the cells: both without their means.
    pub fn add_potential(&self, sources: &[f64], out: &mut [f64]) {
        let mean = sources.iter().sum::<f64>() / sources.len() as f64;
        let mut potential: Vec<f64> = sources.iter().map(|source| source - mean).collect();
        potential.remove(self.held);
        self.factors.solve(&mut potential);
        potential.insert(self.held, 0.0);
        let mean = potential.iter().sum::<f64>() / sources.len() as f64;
        out.iter_mut().zip(potential).for_each(|(out, potential)| *out += potential - mean);
    }
}

/// The cell whose links weigh most.
fn best_held(cells: usize, links: &[Link]) -> usize {
    let mut weights = vec![0.0; cells];
    links.iter().for_each(|link| link.cells.iter().for_each(|&cell| weights[cell] += link.weight));
    (0..cells).max_by(|&one, &two| weights[one].total_cmp(&weights[two])).unwrap_or(0)
}

/// The row of a cell; none for the one that is held.
fn row_of(cell: usize, held: usize) -> Option<usize> {
    (cell != held).then(|| cell - usize::from(cell > held))
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
