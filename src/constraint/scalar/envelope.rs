//! The potential of sources in one inclusion, which nothing but its own edges holds together.

use super::graph::CellEdge;
use crate::linalg::Skyline;

/// Cholesky factors of the Laplacian of its cells, of which one is held: the one that edges hold best, because what rounding makes of the
/// sum of all sources leaves through it, and the others rise by that over its edges.
pub struct Envelope {
    factors: Skyline,
    held: usize,
}

impl Envelope {
    /// Factors the Laplacian of cells that their edges connect.
    pub fn new(cells: usize, edges: &[CellEdge]) -> Envelope {
        let held = best_held(cells, edges);
        let rows = |edge: &CellEdge| edge.cells.map(|cell| row_of(cell, held));
        let mut firsts: Vec<usize> = (0..cells - 1).collect();
        for edge in edges {
            if let [Some(one), Some(two)] = rows(edge) {
                firsts[one.max(two)] = firsts[one.max(two)].min(one.min(two));
            }
        }
        let mut laplacian = Skyline::new(firsts);
        for edge in edges {
            rows(edge).into_iter().flatten().for_each(|row| laplacian.add(row, row, edge.weight));
            if let [Some(one), Some(two)] = rows(edge) {
                laplacian.add(one.max(two), one.min(two), -edge.weight);
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

/// The cell whose edges weigh most.
fn best_held(cells: usize, edges: &[CellEdge]) -> usize {
    let mut weights = vec![0.0; cells];
    edges.iter().for_each(|edge| edge.cells.iter().for_each(|&cell| weights[cell] += edge.weight));
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
        let edge = |one: usize, two: usize| CellEdge { cells: [one, two], weight: 1.0 + (one * two) as f64 };
        let edges: Vec<CellEdge> = (0..3)
            .flat_map(|x| (0..4).map(move |y| 4 * x + y))
            .flat_map(|cell| {
                let (up, right) = ((cell % 4 < 3).then(|| edge(cell + 1, cell)), (cell < 8).then(|| edge(cell, cell + 4)));
                up.into_iter().chain(right)
            })
            .collect();
        let mut sources: Vec<f64> = (0..12).map(|cell| (cell as f64).sin()).collect();
        let mean = sources.iter().sum::<f64>() / 12.0;
        sources.iter_mut().for_each(|source| *source -= mean);
        let mut potential = vec![0.0; 12];
        Envelope::new(12, &edges).add_potential(&sources, &mut potential);
        assert!(potential.iter().sum::<f64>().abs() < 1e-13);
        for &CellEdge { cells: [one, two], weight } in &edges {
            let flux = weight * (potential[one] - potential[two]);
            sources[one] -= flux;
            sources[two] += flux;
        }
        assert!(sources.iter().all(|left| left.abs() < 1e-13), "{sources:?}");
    }
}
