//! Products of dense rows, written so that several entries are taken at once.

use super::vectorized;

const WIDTH: usize = 8;

/// Scalar product of two slices of equal length.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a_parts, a_rest) = a.as_chunks::<WIDTH>();
    let (b_parts, b_rest) = b.as_chunks::<WIDTH>();
    let mut sums = [0.0; WIDTH];
    for (a, b) in a_parts.iter().zip(b_parts) {
        sums = sum(|k| sums[k] + a[k] * b[k]);
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

/// Euclidean norm of a slice.
pub fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// Scalar products of rows in single precision that follow each other in `rows` with `c`; taken together, they wait less for memory.
#[inline(always)]
pub fn dots<const ROWS: usize>(rows: &[f32], c: &[f64]) -> [f64; ROWS] {
    const PART: usize = WIDTH;
    let (count, (parts, rest)) = (c.len(), c.as_chunks::<PART>());
    let mut sums = [[0.0; PART]; ROWS];
    for (part, c) in parts.iter().enumerate() {
        for (row, before) in sums.iter_mut().enumerate() {
            let row: &[f32; PART] = rows[row * count + part * PART..].first_chunk().expect("a whole part");
            *before = sum(|k| before[k] + f64::from(row[k]) * c[k]);
        }
    }
    let mut found = [0.0; ROWS];
    for (row, (found, sums)) in found.iter_mut().zip(sums).enumerate() {
        let last = &rows[row * count + count - rest.len()..][..rest.len()];
        let last: f64 = last.iter().zip(rest).map(|(value, c)| f64::from(*value) * c).sum();
        *found = sums.iter().sum::<f64>() + last;
    }
    found
}

/// Sums that are taken together, in a plain loop: closures that change them one by one end up in memory.
#[inline(always)]
fn sum<const N: usize>(term: impl Fn(usize) -> f64) -> [f64; N] {
    let mut sums = [0.0; N];
    for (k, sum) in sums.iter_mut().enumerate() {
        *sum = term(k);
    }
    sums
}

/// Length of rows of `count` entries with room to take all of them several at once.
pub fn padded(count: usize) -> usize {
    count.next_multiple_of(WIDTH)
}

/// Adds to `out` the weighted sum of rows of `values`, each as long as `out`, a padded length; terms are row and weight.
pub fn add_rows(terms: &[(u32, f64)], values: &[f64], out: &mut [f64]) {
    vectorized(
        #[inline(always)]
        || {
            let mut start = add_parts::<{ 3 * WIDTH }>(terms, values, 0, out);
            start = add_parts::<{ 2 * WIDTH }>(terms, values, start, out);
            add_parts::<WIDTH>(terms, values, start, out);
        },
    );
}

/// As many parts of `N` entries as fit from `start` on; returns where the next would start.
#[inline(always)]
fn add_parts<const N: usize>(terms: &[(u32, f64)], values: &[f64], mut start: usize, out: &mut [f64]) -> usize {
    let length = out.len();
    while let Some(part) = out[start..].first_chunk_mut::<N>() {
        let mut sums = [0.0; N];
        for &(row, weight) in terms {
            let values: &[f64; N] = values[row as usize * length + start..].first_chunk().expect("a whole row");
            sums = sum(|k| sums[k] + weight * values[k]);
        }
        *part = sum(|k| part[k] + sums[k]);
        start += N;
    }
    start
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_of_plain_loops() {
        let length = padded(45);
        let values: Vec<f64> = (0..5 * length).map(|place| (place as f64).sin()).collect();
        let rows: Vec<&[f64]> = values.chunks(length).collect();
        let plain: f64 = rows[0][..45].iter().zip(rows[1]).map(|(a, b)| a * b).sum();
        assert!((dot(&rows[0][..45], &rows[1][..45]) - plain).abs() < 1e-13);
        let single: Vec<f32> = values.iter().map(|&value| value as f32).collect();
        let products: [f64; 2] = dots(&single, rows[1]);
        for (product, row) in products.iter().zip(&rows) {
            assert!((product - dot(row, rows[1])).abs() < 1e-6);
        }
        let mut out = vec![1.0; length];
        add_rows(&[(4, 0.5), (1, -2.0)], &values, &mut out);
        for (place, out) in out.iter().enumerate() {
            assert!((out - 1.0 - 0.5 * rows[4][place] + 2.0 * rows[1][place]).abs() < 1e-15);
        }
    }
}
