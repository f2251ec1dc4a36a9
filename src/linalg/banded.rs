//! Direct solution of banded systems, factored once, several of them side by side.

/// One number for each of the systems.
pub type Lanes<const LANES: usize> = [f64; LANES];

/// Triangular factors of banded matrices, as many as there are `LANES`, with `BAND` entries on either side of the diagonal.
///
/// Rows are not interchanged: pivots are taken as they come. Systems side by side do not wait for each other's last result.
pub struct BandedLanes<const BAND: usize, const LANES: usize> {
    /// Multipliers left of the diagonal, the nearest one last.
    lower: Vec<[Lanes<LANES>; BAND]>,
    /// One over the pivots.
    inverse_pivots: Vec<Lanes<LANES>>,
    /// Entries right of the diagonal.
    upper: Vec<[Lanes<LANES>; BAND]>,
}

impl<const BAND: usize, const LANES: usize> BandedLanes<BAND, LANES> {
    /// Factors matrices of `size` rows with the entries `entry(lane, row, column)`, for rows and columns no further apart than the band.
    pub fn new(size: usize, entry: impl Fn(usize, usize, usize) -> f64) -> Self {
        let mut factors = BandedLanes {
            lower: vec![[[0.0; LANES]; BAND]; size],
            inverse_pivots: vec![[0.0; LANES]; size],
            upper: vec![[[0.0; LANES]; BAND]; size],
        };
        (0..LANES).for_each(|lane| (0..size).for_each(|row| factors.eliminate(lane, row, |column| entry(lane, row, column))));
        factors
    }

    /// Turns the entries of a row into factors, those above being known.
    fn eliminate(&mut self, lane: usize, row: usize, entry: impl Fn(usize) -> f64) {
        let (first, last) = (row.saturating_sub(BAND), (row + BAND).min(self.upper.len() - 1));
        let mut entries = vec![0.0; last + 1 - first];
        entries.iter_mut().zip(first..).for_each(|(value, column)| *value = entry(column));
        for column in first..row {
            let multiplier = entries[column - first] * self.inverse_pivots[column][lane];
            let below = entries[column + 1 - first..].iter_mut().zip(&self.upper[column]);
            below.for_each(|(entry, above)| *entry -= multiplier * above[lane]);
            self.lower[row][column + BAND - row][lane] = multiplier;
        }
        self.inverse_pivots[row][lane] = 1.0 / entries[row - first];
        self.upper[row].iter_mut().zip(&entries[row + 1 - first..]).for_each(|(upper, entry)| upper[lane] = *entry);
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        self.upper.len()
    }

    /// Room for right-hand sides of `size` rows, each with as many parts as one matrix serves: zeros, `BAND` rows of which stand before them and as many
    /// behind.
    pub fn room<const PARTS: usize>(size: usize) -> Vec<[Lanes<LANES>; PARTS]> {
        vec![[[0.0; LANES]; PARTS]; size + 2 * BAND]
    }

    /// Replaces right-hand sides in their [`room`](Self::room) by the solutions.
    pub fn solve<const PARTS: usize>(&self, values: &mut [[Lanes<LANES>; PARTS]]) {
        for (row, factors) in self.lower.iter().enumerate() {
            let (known, open) = values[row..].split_at_mut(BAND);
            let mut value = open[0];
            factors.iter().zip(known).for_each(|(factor, known)| subtract(factor, known, &mut value));
            open[0] = value;
        }
        for (row, (factors, inverse)) in self.upper.iter().zip(&self.inverse_pivots).enumerate().rev() {
            let (open, known) = values[row + BAND..][..=BAND].split_at_mut(1);
            let mut value = open[0];
            // the one found last comes last
            factors.iter().zip(known).rev().for_each(|(factor, known)| subtract(factor, known, &mut value));
            open[0] = value.map(|part| std::array::from_fn(|lane| part[lane] * inverse[lane]));
        }
    }
}

/// `value -= factor * known`, lane by lane.
#[inline(always)]
fn subtract<const PARTS: usize, const LANES: usize>(
    factor: &Lanes<LANES>,
    known: &[Lanes<LANES>; PARTS],
    value: &mut [Lanes<LANES>; PARTS],
) {
    for (value, known) in value.iter_mut().zip(known) {
        (0..LANES).for_each(|lane| value[lane] -= factor[lane] * known[lane]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Entries without pattern below a large diagonal, others in each lane.
    fn entry(lane: usize, row: usize, column: usize) -> f64 {
        let size = if row == column { 5.0 } else { 0.0 };
        if row.abs_diff(column) <= 3 { size + ((7 * row + 13 * column + lane) as f64).sin() } else { 0.0 }
    }

    #[test]
    fn banded_systems_are_solved_side_by_side() {
        for size in [1, 2, 3, 4, 5, 8, 40] {
            let factors = BandedLanes::<3, 2>::new(size, entry);
            let solution = |row: usize, part: usize, lane: usize| ((row + 3 * part + 5 * lane) as f64).cos();
            let mut values = BandedLanes::<3, 2>::room::<2>(size);
            for (row, parts) in values[3..][..size].iter_mut().enumerate() {
                for (part, lanes) in parts.iter_mut().enumerate() {
                    *lanes =
                        std::array::from_fn(|lane| (0..size).map(|column| entry(lane, row, column) * solution(column, part, lane)).sum());
                }
            }
            factors.solve(&mut values);
            for (row, parts) in values[3..][..size].iter().enumerate() {
                for (part, lanes) in parts.iter().enumerate() {
                    (0..2).for_each(|lane| assert!((lanes[lane] - solution(row, part, lane)).abs() < 1e-12, "{size} rows"));
                }
            }
            let beyond = values[..3].iter().chain(&values[size + 3..]).flatten().flatten();
            assert!(beyond.copied().all(|value| value == 0.0));
        }
    }
}
