//! Where values and waves lie at each stage of a transform along all axes, and what ranks exchange between stages.

use rustfft::num_complex::Complex;

use super::{Axis, BlockLayout, Domain, Grid, Pencils};

/// The layouts of a transform along all axes.
pub struct Stages<const D: usize> {
    /// The blocks of the grid.
    pub own: BlockLayout<D>,
    /// Values where the first axis is whole.
    pub whole: BlockLayout<D>,
    /// Waves where each axis is whole, one after the other.
    pub waves: Vec<BlockLayout<D>>,
    /// The axes in that order.
    pub order: [usize; D],
}

impl<const D: usize> Stages<D> {
    /// Those that move least from the blocks of a grid.
    pub fn new(grid: &Grid<D>) -> Stages<D> {
        let own = blocks(grid);
        let special = (0..D).find(|&axis| grid.domain().axes[axis] != Axis::Periodic);
        let pencils = Pencils::new(&own, grid.cells(), special);
        let order = pencils.order();
        let mut waves = grid.cells();
        waves[order[0]] = waves[order[0]] / 2 + 1;
        Stages { whole: pencils.layout(0, grid.cells()), waves: pencils.layouts(waves), own, order }
    }
}

/// Whether all fields of a box are transformed together: at most one axis may have walls.
pub fn transforms_at_once<const D: usize>(domain: &Domain<D>) -> bool {
    (0..D).filter(|&axis| !domain.periodic(axis)).count() <= 1
}

/// The blocks of a grid.
fn blocks<const D: usize>(grid: &Grid<D>) -> BlockLayout<D> {
    BlockLayout((0..grid.partition().blocks()).map(|rank| grid.partition().block(rank)).collect())
}

/// The layouts in which the fields are transformed one after the other: the blocks of the grid, and those where each axis is whole, with these in order.
pub fn separated<const D: usize>(grid: &Grid<D>) -> (Vec<BlockLayout<D>>, [usize; D]) {
    let own = blocks(grid);
    let pencils = Pencils::new(&own, grid.cells(), None);
    (std::iter::once(own).chain(pencils.layouts(grid.cells())).collect(), pencils.order())
}

/// What the busiest rank sends in one solve by transforms: all values but those that it keeps, there and back.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Transposes {
    /// Messages to other ranks.
    pub messages: f64,
    /// Bytes of them.
    pub bytes: f64,
}

impl Transposes {
    /// Of a solve on a grid.
    pub fn of<const D: usize>(grid: &Grid<D>) -> Transposes {
        if !transforms_at_once(grid.domain()) {
            let (layouts, _) = separated(grid);
            let moves = layouts.windows(2).map(|pair| (&pair[0], &pair[1], size_of::<f64>()));
            let all = Transposes::of_moves::<D>(moves);
            return Transposes { messages: (D + 1) as f64 * all.messages, ..all };
        }
        let Stages { own, whole, waves, .. } = Stages::new(grid);
        let moves = std::iter::once((&own, &whole, size_of::<f64>()));
        Transposes::of_moves::<D>(moves.chain(waves.windows(2).map(|pair| (&pair[0], &pair[1], size_of::<Complex<f64>>()))))
    }

    fn of_moves<'a, const D: usize>(moves: impl Iterator<Item = (&'a BlockLayout<D>, &'a BlockLayout<D>, usize)>) -> Transposes {
        let mut all = Transposes::default();
        for (from, to, size) in moves {
            for (messages, indices) in [from.sent_to(to), to.sent_to(from)] {
                all.messages += messages as f64;
                all.bytes += ((D + 1) * indices * size) as f64;
            }
        }
        all
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use nalgebra::SVector;

    use super::*;

    #[test]
    fn one_rank_sends_nothing_and_many_all_values_but_their_own() {
        let domain = Domain { size: SVector::from([8.0, 8.0]), axes: [Axis::Periodic; 2] };
        let of = |ranks| Transposes::of(&Grid::<2>::new(&domain, 0.125, ranks, 0).unwrap());
        assert_eq!(of(1), Transposes::default());
        // values of three fields, 64^2 points shared by four: half of them to whole lines of the other rank beside it, three quarters of the
        // waves on to the other axis, where one rank has nine of 33, there and back
        let (values, waves) = (3.0 * 32.0 * 16.0 * 8.0, 3.0 * 16.0 * 33.0 * 16.0);
        let four = of(4);
        assert_eq!(four.messages, 2.0 * (1.0 + 3.0));
        assert!((four.bytes / (2.0 * (values + 0.75 * waves)) - 1.0).abs() < 0.05, "{four:?}");
        // sixteen blocks of 16^2: each rank's lines lie in four of them, and one rank has three of 33 waves
        let sixteen = of(16);
        assert_eq!(sixteen.messages, 2.0 * (3.0 + 15.0));
        assert!((sixteen.bytes / (2.0 * (1.5 * values + 15.0 / 16.0 * waves) / 4.0) - 1.0).abs() < 0.15, "{sixteen:?}");
    }
}
