//! Points taken several at once, so that one instruction works on all of them.

use crate::linalg::vectorized;

/// Number of points taken at once.
pub const LANES: usize = 8;

/// One number for each of the points.
pub type Simd = [f64; LANES];

/// Fills `out[point * stride + mode]`, `stride = out.len() / points`, batch by batch: `fill(positions, values)` gets the points'
/// coordinates over `length` and writes `values[mode * LANES + lane]`.
///
/// A last batch that is not full repeats its first point. To use wide registers `fill` is to be `#[inline(always)]`.
pub fn in_batches<const D: usize>(
    offsets: &[f64],
    length: f64,
    count: usize,
    out: &mut [f64],
    mut fill: impl FnMut(&[Simd; D], &mut [f64]),
) {
    if !offsets.is_empty() {
        vectorized(
            #[inline(always)]
            || batches(offsets, length, count, out, &mut fill),
        );
    }
}

#[inline(always)]
fn batches<const D: usize>(offsets: &[f64], length: f64, count: usize, out: &mut [f64], fill: &mut impl FnMut(&[Simd; D], &mut [f64])) {
    let stride = out.len() / (offsets.len() / D);
    let mut values = vec![0.0; count * LANES];
    let mut positions = [[0.0; LANES]; D];
    for (points, rows) in offsets.chunks(D * LANES).zip(out.chunks_mut(stride * LANES)) {
        for lane in 0..LANES {
            let point = points.chunks_exact(D).nth(lane).unwrap_or(&points[..D]);
            positions.iter_mut().zip(point).for_each(|(along, x)| along[lane] = x / length);
        }
        fill(&positions, &mut values);
        for (lane, row) in rows.chunks_exact_mut(stride).enumerate() {
            row.iter_mut().zip(values.as_chunks::<LANES>().0).for_each(|(out, mode)| *out = mode[lane]);
        }
    }
}

/// `f(lane)` for each lane.
#[inline(always)]
pub fn each(f: impl FnMut(usize) -> f64) -> Simd {
    std::array::from_fn(f)
}
