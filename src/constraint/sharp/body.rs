//! The blocks of the `sharp` method of one body.

use std::rc::Rc;

use nalgebra::{SMatrix, SVector};

use super::spread::OnWall;
use crate::{
    constraint::{
        body::{BodyBlocks, BodyRows, Plans, WallForces, Walls},
        dense::KeptBlock,
        interpolant::Interpolant,
        layout::MultiplierLayout,
        places::{Entries, EntriesMut},
        rows::KeptRows,
    },
    linalg::dot,
    surface::SurfaceTable,
};

/// What one body adds: dense in its multipliers, on the lattice points near its surface.
pub struct SharpBody<const D: usize> {
    /// Its surface.
    pub surface: Rc<SurfaceTable<D>>,
    /// Rows of C.
    pub rows: KeptRows,
    /// What passes to walls.
    pub on_walls: Vec<OnWall>,
    /// J, before values at the points are projected on the modes.
    pub interpolant: Interpolant<D>,
    /// Dense blocks of E in the rows of this body.
    pub local: Vec<KeptBlock>,
    /// Once planned, the places of the first multipliers of the blocks of E.
    pub local_places: Vec<u32>,
}

impl<const D: usize> BodyBlocks<D> for SharpBody<D> {
    fn count(&self) -> usize {
        self.surface.modes.count()
    }

    fn plan(&mut self, layout: &MultiplierLayout, plans: &mut Plans) {
        self.interpolant.plan(&mut plans.read);
        self.rows.plan(&mut plans.spread);
        let place = |block: &KeptBlock| plans.multipliers.of(layout.global(block.body), block.columns);
        self.local_places = self.local.iter().map(place).collect();
    }

    fn spread(&self, factor: f64, c: &[f64], scratch: &mut Vec<f64>, rows: &mut EntriesMut) {
        self.rows.add(factor, c, scratch, rows);
    }

    fn read(&self, u: Entries, walls: Walls, scratch: &mut Vec<f64>, out: &mut [f64]) {
        self.interpolant.apply(u, scratch, out);
        if walls == Walls::Moving {
            out.iter_mut().zip(&self.interpolant.wall_values).for_each(|(value, wall)| *value += wall);
        }
    }

    fn rows(&self) -> BodyRows<'_, D> {
        BodyRows::Surface(&self.surface)
    }

    fn add_local(&self, _own: &[f64], all: Entries, out: &mut [f64]) {
        for (block, &place) in self.local.iter().zip(&self.local_places) {
            block.add(&all.from(place)[..block.columns], Some(&mut *out), None);
        }
    }

    fn add_at_points(&self, all: Entries, out: &mut [f64]) {
        for (block, &place) in self.local.iter().zip(&self.local_places) {
            block.add(&all.from(place)[..block.columns], None, Some(&mut *out));
        }
    }

    fn coefficients(&self, known: &dyn Fn(&SVector<f64, D>) -> SVector<f64, D>) -> Vec<f64> {
        self.surface.coefficients(known)
    }

    fn first_moment(&self, c: &[f64]) -> SMatrix<f64, D, D> {
        self.surface.first_moment(c)
    }

    fn add_on_walls(&self, c: &[f64], forces: &mut WallForces<D>) {
        for OnWall { axis, upper, component, values } in &self.on_walls {
            forces[*axis][usize::from(*upper)][*component] += dot(values, c);
        }
    }

    fn into_memory(self: Box<Self>) -> Vec<Vec<f32>> {
        self.rows.values.into_memory()
    }
}
