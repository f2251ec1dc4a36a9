//! Dense columns: what a front does to itself.

use nalgebra::{Dyn, MatrixView, MatrixViewMut};

/// Columns eliminated one by one before the others hear of them.
const FEW: usize = 12;
/// Columns updated at once: more would compute more of the upper half, which nobody reads.
const STRIP: usize = 64;
/// Multiplications per row from which a product of matrices is worth its start.
const SMALL: usize = 64;

type DenseView<'a> = MatrixView<'a, f64, Dyn, Dyn, Dyn, Dyn>;
type ViewMut<'a> = MatrixViewMut<'a, f64, Dyn, Dyn, Dyn, Dyn>;

/// Cholesky's factors of the first columns, in place: the lower half of a panel of so many rows and columns.
///
/// No pivot of `I + A^T W A` is below 1, and if one is, that is rounding.
pub(super) fn eliminate(panel: &mut [f64], height: usize, width: usize) {
    for start in (0..width).step_by(FEW) {
        let end = width.min(start + FEW);
        for column in start..end {
            let (done, rest) = panel.split_at_mut(column * height);
            let own = &mut rest[column..height];
            for earlier in done.chunks_exact(height).skip(start) {
                let factor = earlier[column];
                own.iter_mut().zip(&earlier[column..]).for_each(|(own, entry)| *own -= factor * entry);
            }
            let root = own[0].max(1.0).sqrt();
            own[0] = root;
            own[1..].iter_mut().for_each(|own| *own /= root);
        }
        let (done, rest) = panel.split_at_mut(end * height);
        for first in (end..width).step_by(STRIP) {
            let strip = first..width.min(first + STRIP);
            let rest = &mut rest[(first - end) * height + first..];
            let columns = Columns { entries: &done[start * height + first..], height, width: end - start };
            subtract_product(columns, height - first, strip.len(), rest, height);
        }
    }
}

/// Takes what eliminated columns do to the others from these, in the lower half.
pub(super) fn subtract(panel: &[f64], height: usize, width: usize, rest: &mut [f64]) {
    let below = height - width;
    if width * below < SMALL {
        for (column, own) in rest.chunks_exact_mut(below.max(1)).enumerate() {
            for done in panel.chunks_exact(height) {
                let done = &done[width + column..];
                own[column..].iter_mut().zip(done).for_each(|(own, entry)| *own -= done[0] * entry);
            }
        }
        return;
    }
    for first in (0..below).step_by(STRIP) {
        let strip = STRIP.min(below - first);
        let columns = Columns { entries: &panel[width + first..], height, width };
        subtract_product(columns, below - first, strip, &mut rest[first * below + first..], below);
    }
}

/// Columns of a panel from some row on.
struct Columns<'a> {
    entries: &'a [f64],
    /// From a column to the next.
    height: usize,
    /// Their number.
    width: usize,
}

/// Takes `B C^T` from a matrix of so many rows and columns, where `B` and `C` are the first rows of these columns.
fn subtract_product(from: Columns, rows: usize, columns: usize, target: &mut [f64], stride: usize) {
    let Columns { entries, height, width } = from;
    let left = DenseView::from_slice_with_strides_generic(entries, Dyn(rows), Dyn(width), Dyn(1), Dyn(height));
    let right = DenseView::from_slice_with_strides_generic(entries, Dyn(width), Dyn(columns), Dyn(height), Dyn(1));
    let mut target = ViewMut::from_slice_with_strides_generic(target, Dyn(rows), Dyn(columns), Dyn(1), Dyn(stride));
    target.gemm(-1.0, &left, &right, 1.0);
}
