//! Layouts in which one axis after the other is whole on every rank, as transforms along all axes want it.
//!
//! The axes that are not whole are cut over a mesh of ranks with one dimension less than the box; from one stage to the next
//! one dimension of the mesh changes from cutting the axis that becomes whole to cutting the one that was.

use super::{
    partition::{Block, factorisations},
    redistribution::BlockLayout,
};

/// Indices that take as long to send as a message to start: some microseconds at some gigabytes a second, for four fields.
const MESSAGE: usize = 256;

/// The stages of a transform along all axes: stage `i` has axis `order[i]` whole.
#[derive(Debug, Clone, PartialEq)]
pub struct Pencils<const D: usize> {
    order: [usize; D],
    /// The last extent is one.
    mesh: [usize; D],
}

impl<const D: usize> Pencils<D> {
    /// The stages that move least, starting from a layout of `cells`, with the axis `last` (if any) whole at last.
    pub fn new(start: &BlockLayout<D>, cells: [usize; D], last: Option<usize>) -> Pencils<D> {
        let meshes = factorisations::<D>(start.0.len()).into_iter().filter(|mesh| mesh[D - 1] == 1);
        let candidates = meshes.flat_map(|mesh| orders(last).map(move |order| Pencils { order, mesh }));
        candidates.min_by_key(|pencils| pencils.cost(start, cells)).expect("there is an order and a mesh")
    }

    /// The axes in the order in which they are whole.
    pub fn order(&self) -> [usize; D] {
        self.order
    }

    /// The layout of a stage on a lattice of the given extents; ranks may be left without any index.
    pub fn layout(&self, stage: usize, extents: [usize; D]) -> BlockLayout<D> {
        let mesh = Block { start: [0; D], end: self.mesh };
        BlockLayout(mesh.indices().map(|place| self.block(stage, extents, place)).collect())
    }

    /// The layouts of all stages.
    pub fn layouts(&self, extents: [usize; D]) -> Vec<BlockLayout<D>> {
        (0..D).map(|stage| self.layout(stage, extents)).collect()
    }

    fn block(&self, stage: usize, extents: [usize; D], place: [usize; D]) -> Block<D> {
        let mut block = Block { start: [0; D], end: extents };
        for (turn, &axis) in self.order.iter().enumerate().filter(|&(turn, _)| turn != stage) {
            let dimension = if turn < stage { turn } else { turn - 1 };
            let cut = |part: usize| part * extents[axis] / self.mesh[dimension];
            (block.start[axis], block.end[axis]) = (cut(place[dimension]), cut(place[dimension] + 1));
        }
        block
    }

    /// Work and traffic grow with the largest share of a rank, traffic with the number of moves and of messages too.
    fn cost(&self, start: &BlockLayout<D>, cells: [usize; D]) -> usize {
        let mut layouts = vec![start.clone()];
        layouts.extend(self.layouts(cells));
        let moves = layouts.windows(2).filter(|pair| pair[0] != pair[1]);
        let (moves, messages) = moves.fold((0, 0), |(moves, messages), pair| (moves + 1, messages + pair[0].sent_to(&pair[1]).0));
        layouts.iter().map(BlockLayout::largest).max().unwrap_or(0) * (1 + moves) + MESSAGE * messages
    }
}

/// All orders of the axes that end with `last`, the one that starts with the fastest axis first.
fn orders<const D: usize>(last: Option<usize>) -> impl Iterator<Item = [usize; D]> {
    let all = Block { start: [0; D], end: [D; D] };
    let orders = all.indices().map(|order| order.map(|axis| D - 1 - axis));
    orders.filter(move |order| (0..D).all(|axis| order.contains(&axis)) && last.is_none_or(|last| order[D - 1] == last))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Partition;

    fn start<const D: usize>(cells: [usize; D], ranks: usize) -> BlockLayout<D> {
        let partition = Partition::new(cells, ranks).unwrap();
        BlockLayout((0..ranks).map(|rank| partition.block(rank)).collect())
    }

    #[test]
    fn every_stage_has_its_axis_whole_and_every_index_once() {
        let cells = [9, 7, 8];
        for ranks in [1, 2, 3, 4, 6, 12] {
            for last in [None, Some(0), Some(1), Some(2)] {
                let pencils = Pencils::new(&start(cells, ranks), cells, last);
                assert!(last.is_none_or(|last| pencils.order()[2] == last));
                for stage in 0..3 {
                    let layout = pencils.layout(stage, cells);
                    let whole = pencils.order()[stage];
                    assert!(layout.0.iter().all(|block| block.end[whole] - block.start[whole] == cells[whole]));
                    let all = Block { start: [0; 3], end: cells };
                    let holders = |index: [usize; 3]| {
                        let holds = |block: &&Block<3>| (0..3).all(|axis| (block.start[axis]..block.end[axis]).contains(&index[axis]));
                        layout.0.iter().filter(holds).count()
                    };
                    assert!(all.indices().all(|index| holders(index) == 1));
                }
            }
        }
    }

    #[test]
    fn two_ranks_move_values_once() {
        let [square, cube] = [Pencils::new(&start([40, 40], 2), [40, 40], None).cost(&start([40, 40], 2), [40, 40]), {
            let start = start([20, 20, 20], 2);
            Pencils::new(&start, [20; 3], Some(1)).cost(&start, [20; 3])
        }];
        assert_eq!((square, cube), (2 * 800 + MESSAGE, 2 * 4000 + MESSAGE));
    }

    #[test]
    fn many_ranks_with_thin_slabs_send_less_messages_in_a_mesh() {
        let cells = [64, 64, 64];
        let start = start(cells, 64);
        let pencils = Pencils::new(&start, cells, None);
        let layouts = pencils.layouts(cells);
        let messages = layouts.windows(2).map(|pair| pair[0].sent_to(&pair[1]).0);
        // slabs would take one move of 63 messages, a mesh of 8 x 8 ranks takes two of seven
        assert_eq!(messages.collect::<Vec<_>>(), [7, 7]);
    }

    #[test]
    fn more_ranks_than_layers_share_a_mesh() {
        let cells = [8, 8, 8];
        let pencils = Pencils::new(&start(cells, 16), cells, None);
        assert_eq!(pencils.layout(0, cells).largest(), 32);
    }
}
