//! By how much the row blocks of a program miss their bounds, and what they do.

use super::{
    bounds::{Limit, shortened},
    cone::{ContactState, larger, natural_map, project, tangential_size},
    program::FrictionProgram,
    row_block::RowBlock,
};

impl<const D: usize, const W: usize> FrictionProgram<D, W> {
    /// What bounds the tangential impulse of a row block.
    pub fn limit(&self, place: usize) -> Limit {
        let RowBlock { friction, dilation, .. } = self.row_blocks[place];
        Limit { friction, dilation, load: self.bounds.get(place).map_or(0.0, |bound| bound.load) }
    }

    /// The contact whose normal impulse that is.
    pub fn leader(&self, place: usize) -> usize {
        self.bounds.get(place).map_or(place, |bound| bound.leader)
    }

    /// Whether a row block turns a contact, and has no normal impulse.
    pub fn follows(&self, place: usize) -> bool {
        self.leader(place) != place
    }

    /// The largest component by which a row block misses its part of the law: the natural map; with a load that of the normal and of the tangential part alone.
    pub fn miss(&self, place: usize, forces: &[[f64; D]], velocity: &[f64; D]) -> f64 {
        let force = &forces[place];
        let Limit { friction, load, dilation } = self.limit(place);
        if load == 0.0 && !self.follows(place) {
            return natural_map(force, velocity, friction, dilation);
        }
        let normal = forces[self.leader(place)][0];
        let aim: [f64; D] = std::array::from_fn(|axis| force[axis] - velocity[axis]);
        let next = shortened(&aim, self.limit(place).at(normal));
        let across = (1..D).map(|axis| (force[axis] - next[axis]).abs()).fold(0.0, larger);
        if self.follows(place) { across } else { larger(across, (normal - aim[0].max(0.0)).abs()) }
    }

    /// What a row block does.
    pub fn state(&self, place: usize, forces: &[[f64; D]], velocities: &[[f64; D]]) -> ContactState {
        let (limit, leader) = (self.limit(place), self.leader(place));
        let aim: [f64; D] = std::array::from_fn(|axis| forces[place][axis] - velocities[place][axis]);
        if limit.dilation > 0.0 {
            return ContactState::by_projection(&aim, limit.friction);
        }
        match forces[leader][0] - velocities[leader][0] {
            normal if normal <= 0.0 => ContactState::Open,
            normal if (limit.load == 0.0 || normal > limit.load) && tangential_size(&aim) <= limit.at(normal) => ContactState::Sticking,
            _ => ContactState::Slipping,
        }
    }

    /// Impulses that obey all bounds next to these, of which those that turn contacts have no normal part.
    pub fn within(&self, forces: &[[f64; D]]) -> Vec<[f64; D]> {
        let single = |place: usize| match self.limit(place) {
            Limit { friction, load: 0.0, .. } if !self.follows(place) => project(forces[place], friction),
            limit => {
                let next = shortened(&forces[place], limit.at(forces[self.leader(place)][0]));
                std::array::from_fn(|axis| match axis {
                    0 if self.follows(place) => 0.0,
                    0 => next[0].max(0.0),
                    _ => next[axis],
                })
            }
        };
        (0..forces.len()).map(single).collect()
    }
}
