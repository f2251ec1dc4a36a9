//! Products of dense rows, written so that several entries are taken at once.

const WIDTH: usize = 8;

/// Scalar product of two slices of equal length.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a_parts, a_rest) = a.as_chunks::<WIDTH>();
    let (b_parts, b_rest) = b.as_chunks::<WIDTH>();
    let mut sums = [0.0; WIDTH];
    for (a, b) in a_parts.iter().zip(b_parts) {
        (0..WIDTH).for_each(|k| sums[k] += a[k] * b[k]);
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
    const PART: usize = 4;
    let (count, whole) = (c.len(), c.len() / PART * PART);
    let rows: [&[f32]; ROWS] = std::array::from_fn(|row| &rows[row * count..][..count]);
    let mut sums = [[0.0; PART]; ROWS];
    for start in (0..whole).step_by(PART) {
        let c: &[f64; PART] = c[start..].first_chunk().expect("a whole part");
        for (sums, row) in sums.iter_mut().zip(rows) {
            let row: &[f32; PART] = row[start..].first_chunk().expect("a whole part");
            (0..PART).for_each(|k| sums[k] += f64::from(row[k]) * c[k]);
        }
    }
    std::array::from_fn(|row| {
        let rest: f64 = (whole..count).map(|k| f64::from(rows[row][k]) * c[k]).sum();
        (sums[row][0] + sums[row][1]) + (sums[row][2] + sums[row][3]) + rest
    })
}

/// Length of rows of `count` entries with room to take all of them several at once.
pub fn padded(count: usize) -> usize {
    count.next_multiple_of(WIDTH)
}

/// Adds to `out` the weighted sum of rows of `values`, each as long as `out`, a padded length; terms are row and weight.
pub fn add_rows(terms: &[(u32, f64)], values: &[f64], out: &mut [f64]) {
    let mut start = add_parts::<{ 3 * WIDTH }>(terms, values, 0, out);
    start = add_parts::<{ 2 * WIDTH }>(terms, values, start, out);
    add_parts::<WIDTH>(terms, values, start, out);
}

/// As many parts of `N` entries as fit from `start` on; returns where the next would start.
#[inline(always)]
fn add_parts<const N: usize>(terms: &[(u32, f64)], values: &[f64], mut start: usize, out: &mut [f64]) -> usize {
    let length = out.len();
    while let Some(part) = out.get_mut(start..start + N) {
        let mut sums = [0.0; N];
        for &(row, weight) in terms {
            let values = &values[row as usize * length + start..][..N];
            (0..N).for_each(|k| sums[k] += weight * values[k]);
        }
        part.iter_mut().zip(sums).for_each(|(out, sum)| *out += sum);
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
