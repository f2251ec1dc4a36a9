//! Wave vectors that fit a periodic box, whose images may have slid.

use std::{f64::consts::TAU, ops::RangeInclusive};

use nalgebra::SVector;

use crate::geometry::Domain;

/// All wave vectors of a box up to a length but zero, of two that are opposite one.
pub(super) fn for_each_wave_vector<const D: usize>(domain: &Domain<D>, largest: f64, mut visit: impl FnMut(&SVector<f64, D>)) {
    let shift = domain.shift() - domain.size[0] * (domain.shift() / domain.size[0]).round();
    // the axis across which images slide comes after x, of whose number its own depends
    let mut numbers = [0_i64; D];
    visit_axis(0, &mut numbers, &|axis, numbers: &[i64; D]| wave_numbers(domain, shift, axis, numbers, largest), &mut |numbers| {
        if numbers.iter().find(|number| **number != 0).is_some_and(|first| *first > 0) {
            let vector = wave_vector(domain, shift, numbers);
            if vector.norm() < largest {
                visit(&vector);
            }
        }
    });
}

fn visit_axis<const D: usize>(
    axis: usize,
    numbers: &mut [i64; D],
    range: &impl Fn(usize, &[i64; D]) -> RangeInclusive<i64>,
    visit: &mut impl FnMut(&[i64; D]),
) {
    if axis == D {
        return visit(numbers);
    }
    for number in range(axis, numbers) {
        numbers[axis] = number;
        visit_axis(axis + 1, numbers, range, visit);
    }
    numbers[axis] = 0;
}

/// Numbers of periods along an axis of wave vectors up to a length, after those along the axes before it.
fn wave_numbers<const D: usize>(domain: &Domain<D>, shift: f64, axis: usize, before: &[i64; D], largest: f64) -> RangeInclusive<i64> {
    if !domain.periodic(axis) {
        return 0..=0;
    }
    let middle = if axis == 1 { before[0] as f64 * shift / domain.size[0] } else { 0.0 };
    let most = largest * domain.size[axis] / TAU;
    let least = if axis == 0 { 0.0 } else { (middle - most).ceil() };
    least as i64..=(middle + most).floor() as i64
}

fn wave_vector<const D: usize>(domain: &Domain<D>, shift: f64, numbers: &[i64; D]) -> SVector<f64, D> {
    let mut vector = SVector::from_fn(|axis, _| TAU * numbers[axis] as f64 / domain.size[axis]);
    vector[1] -= vector[0] * shift / domain.size[1];
    vector
}
