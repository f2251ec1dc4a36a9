//! Numbers of cells that are quick to transform and to coarsen.

use nalgebra::SVector;

use super::staggered::cells_along;

/// Largest part by which cells are longer or shorter than those asked for.
const LARGEST_CHANGE: f64 = 0.03;

/// Factors of lengths for which Fourier transforms have vector code.
const FACTORS: [usize; 4] = [2, 3, 5, 7];

/// The spacing, 3 % from the one asked for at most and the same along all axes, with which the fewest axes of a box have a number of cells that is odd or
/// has a factor above 7; among such a finer one if there is any, and the nearest.
pub fn quick_spacing<const D: usize>(size: &SVector<f64, D>, asked: f64) -> f64 {
    let slow = |spacing: f64| cells_along(size, spacing).iter().filter(|&&cells| !quick(cells as usize)).count();
    let counts = |axis: usize| {
        let length = size[axis] / asked;
        let (fewest, most) = ((length / (1.0 + LARGEST_CHANGE)).ceil(), (length * (1.0 + LARGEST_CHANGE)).floor());
        (fewest as usize..=most as usize).filter(|&count| quick(count)).map(move |count| size[axis] / count as f64)
    };
    let worth = |spacing: f64| (slow(spacing), spacing > asked, (spacing / asked - 1.0).abs());
    let better = |best: f64, other: f64| if worth(other) < worth(best) { other } else { best };
    // many axes' lengths lead to the same numbers of cells: what is asked for, wherever it does too
    let found = (0..D).flat_map(counts).fold(asked, better);
    if cells_along(size, found) == cells_along(size, asked) { asked } else { found }
}

/// Whether so many cells are even and have no factor above 7.
fn quick(cells: usize) -> bool {
    let divide =
        |rest: usize, factor: usize| (0..usize::BITS).fold(rest, |rest, _| if rest.is_multiple_of(factor) { rest / factor } else { rest });
    cells.is_multiple_of(2) && cells > 0 && FACTORS.into_iter().fold(cells, divide) == 1
}

#[cfg(test)]
mod tests {
    use nalgebra::{Vector2, vector};

    use super::*;

    fn cells<const D: usize>(size: &SVector<f64, D>, asked: f64) -> Vec<usize> {
        cells_along(size, quick_spacing(size, asked)).map(|cells| cells as usize).as_slice().to_vec()
    }

    #[test]
    fn lengths_have_small_factors_where_there_are_any_near() {
        for (asked, found) in [(443, 448), (139, 140), (217, 216), (71, 72), (61, 60), (64, 64), (75, 75), (13, 13), (38, 38), (1, 1)] {
            let size = Vector2::new(1.0, 1.0);
            assert_eq!(cells(&size, 1.0 / f64::from(asked)), [found; 2], "{asked}");
        }
    }

    #[test]
    fn axes_are_refined_alike() {
        assert_eq!(cells(&vector![24.0, 12.0], 24.0 / 443.0), [448, 224]);
        assert_eq!(cells(&vector![2.0, 1.0, 1.0], 1.0 / 71.0), [144, 72, 72]);
        let size = vector![10.0, 7.3];
        let found = cells(&size, 0.1);
        assert!((found[0] as f64 / found[1] as f64 / (10.0 / 7.3) - 1.0).abs() < 0.01, "{found:?}");
    }

    #[test]
    fn what_is_quick_stays_to_the_last_digit() {
        let size = vector![6.0, 4.0];
        assert_eq!(quick_spacing(&size, 0.125), 0.125);
        assert_eq!(quick_spacing(&size, 0.1251), 0.1251);
    }
}
