//! Cholesky factors of the Laplacian of one inclusion, which nothing but its own links holds together.

use super::links::Link;
use crate::constraint::dense::dot;

/// The lower factor, each row from its first entry to the diagonal; the last cell, which is held, has none.
pub struct Envelope {
    /// For each row, its first column and where it starts in `values`.
    rows: Vec<(usize, usize)>,
    values: Vec<f64>,
}

impl Envelope {
    /// Factors the Laplacian of cells that their links connect.
    pub fn new(cells: usize, links: &[Link]) -> Envelope {
        let mut first: Vec<usize> = (0..cells).collect();
        for &Link { cells: [one, two], .. } in links {
            first[one.max(two)] = first[one.max(two)].min(one.min(two));
        }
        let (mut rows, mut length) = (Vec::with_capacity(cells), 0);
        for (row, &first) in first[..cells - 1].iter().enumerate() {
            rows.push((first, length));
            length += row + 1 - first;
        }
        let mut envelope = Envelope { rows, values: vec![0.0; length] };
        for &Link { cells: [one, two], weight } in links {
            [(one, one, weight), (two, two, weight), (one.max(two), one.min(two), -weight)]
                .into_iter()
                .filter(|(row, ..)| row + 1 < cells)
                .for_each(|(row, column, weight)| envelope.add(row, column, weight));
        }
        envelope.factor();
        envelope
    }

    fn add(&mut self, row: usize, column: usize, value: f64) {
        let (first, start) = self.rows[row];
        self.values[start + column - first] += value;
    }

    fn row(&self, row: usize) -> &[f64] {
        let (first, start) = self.rows[row];
        &self.values[start..=start + row - first]
    }

    fn factor(&mut self) {
        for row in 0..self.rows.len() {
            let (first, start) = self.rows[row];
            for column in first..=row {
                let from = first.max(self.rows[column].0);
                let taken = dot(
                    &self.row(row)[from - first..column - first],
                    &self.row(column)[from - self.rows[column].0..column - self.rows[column].0],
                );
                let value = self.values[start + column - first] - taken;
                self.values[start + column - first] =
                    if column == row { value.sqrt() } else { value / self.row(column)[column - self.rows[column].0] };
            }
        }
    }

    /// Adds to `out` the potential of sources in the cells: both without their means.
    pub fn add_potential(&self, sources: &[f64], out: &mut [f64]) {
        let mean = sources.iter().sum::<f64>() / sources.len() as f64;
        let mut potential: Vec<f64> = sources.iter().map(|source| source - mean).collect();
        if let Some(held) = potential.last_mut() {
            *held = 0.0;
        }
        self.solve(&mut potential);
        let mean = potential.iter().sum::<f64>() / sources.len() as f64;
        out.iter_mut().zip(potential).for_each(|(out, potential)| *out += potential - mean);
    }

    fn solve(&self, x: &mut [f64]) {
        for (row, &(first, _)) in self.rows.iter().enumerate() {
            let (entries, diagonal) = self.row(row).split_at(row - first);
            x[row] = (x[row] - dot(entries, &x[first..row])) / diagonal[0];
        }
        for (row, &(first, _)) in self.rows.iter().enumerate().rev() {
            let (entries, diagonal) = self.row(row).split_at(row - first);
            x[row] /= diagonal[0];
            let value = x[row];
            x[first..row].iter_mut().zip(entries).for_each(|(x, entry)| *x -= value * entry);
        }
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
