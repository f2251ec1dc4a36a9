//! The velocities of the grid inside a body or near it.

use nalgebra::SVector;

use crate::{
    constraint::IndexBox,
    grid::{Grid, Index, Node},
};

/// A velocity of the grid inside a body.
pub struct Point<const D: usize> {
    /// Its component.
    pub component: usize,
    /// Its place in fluid vectors.
    pub place: usize,
    /// Where it is, seen from the centre.
    pub offset: SVector<f64, D>,
    /// Its index, in an image of the box or in it.
    pub index: Index<D>,
    /// Velocity of the frame in which convection is told there, as the body sees it.
    pub frame: SVector<f64, D>,
    /// What the velocity of the body is told beyond: that of the shear there, in a sheared box.
    pub shear: SVector<f64, D>,
}

/// Visits the velocities inside a ball whose centre, not wrapped into the box, lies in this rank's block.
pub fn each_inside<const D: usize>(grid: &Grid<D>, center: &SVector<f64, D>, radius: f64, visit: impl FnMut(Point<D>)) {
    if grid.owner(&grid.domain().wrap(*center)) == grid.rank() {
        within(grid, center, radius, visit);
    }
}

/// Visits the velocities inside a ball, of whatever rank they are.
pub fn within<const D: usize>(grid: &Grid<D>, center: &SVector<f64, D>, radius: f64, mut visit: impl FnMut(Point<D>)) {
    let (domain, unwrapped) = (grid.domain(), center);
    let center = domain.wrap(*unwrapped);
    let (sheared, most) = (domain.slide().is_some(), radius * radius * (1.0 + 1e-12));
    for component in 0..D {
        each_unknown(grid, component, &IndexBox::around(grid, component, &center, radius), |index, place| {
            let offset = grid.position(component, index) - center;
            // most points of the box of indices lie outside by more than rounding
            if offset.norm_squared() <= most && offset.norm() <= radius {
                let at = unwrapped + offset;
                let [frame, shear] = if sheared { [grid.frame_velocity(&at), domain.carried(&at)] } else { [SVector::zeros(); 2] };
                visit(Point { component, place, offset, index, frame, shear });
            }
        });
    }
}

/// Visits the unknowns of a component at indices of a box: the index and the place in fluid vectors.
fn each_unknown<const D: usize>(grid: &Grid<D>, component: usize, around: &IndexBox<D>, mut visit: impl FnMut(Index<D>, usize)) {
    let length = around.extent()[D - 1];
    for first in (0..around.len()).step_by(length.max(1)) {
        let (mut index, mut left) = (around.index(first), length);
        while left > 0 {
            let (node, follow) = grid.fluid_run(component, index);
            for along in 0..follow.min(left) {
                if let Node::Unknown(place) = node {
                    visit(index, place + along);
                }
                index[D - 1] += 1;
            }
            left -= follow.min(left);
        }
    }
}
