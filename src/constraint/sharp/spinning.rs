//! The `sharp` method for bodies with inertia: the fluid inside spins up with them.
//!
//! That takes an [`InteriorForce`], and the Laplacian of the velocity jumps by it across the surface: both go with the rotation modes of a free body.
//!
//! A body lighter than the fluid may move as the fluid inside does. Its excess mass is negative, and in steps too short for viscosity to reach across a cell
//! the jumps of steady flow make its surface more mobile than any fluid that has mass: its momentum would have the wrong sign. It spins as its surface
//! does: nothing else would hold the inside to the surface.

use nalgebra::{DMatrix, SMatrix, SVector};

use super::{AssembledBody, INTERPOLATION_REACH, JumpNodes, SharpBody, Workspace, assemble, bytes};
use crate::{
    body::planes,
    constraint::{
        blocks::rotations,
        body::{BodyBlocks, BodyRows, InteriorBlocks, Plans, WallForces, Walls},
        conservation::TERMS,
        interior::InteriorForce,
        kept_values::Precision,
        layout::MultiplierLayout,
        method::{Method, Size},
        placed::{Placed, Surrounded},
        places::{Entries, EntriesMut},
    },
    grid::Grid,
    linalg::dot,
    surface::unit_rotation,
};

/// The method; surfaces need the jumps of spin-ups (`surface::SurfaceTable::with_spin_up`).
#[derive(Debug, Clone)]
pub struct SharpWithInertia {
    /// How exactly rows are kept.
    pub precision: Precision,
    /// For each body, the spin-up `rho w' / mu` that a unit multiplier of rotation gives it; zero for prescribed motion.
    pub spin_up_of: Vec<f64>,
    /// For each body, whether it moves as the fluid inside it does.
    pub inside: Vec<bool>,
}

impl<const D: usize> Method<D, Box<dyn BodyBlocks<D>>> for SharpWithInertia {
    fn description(&self) -> String {
        "surface multipliers with corrected stencils (sharp), bodies with inertia".into()
    }

    fn assemble(&self, grid: &Grid<D>, bodies: &[Surrounded<D>], memory: Vec<Vec<f32>>) -> Vec<Box<dyn BodyBlocks<D>>> {
        let mut workspace = Workspace::new(self.precision, memory);
        let of = |body: &Surrounded<D>| -> Box<dyn BodyBlocks<D>> {
            let assembled = assemble(grid, body, &mut workspace, |nodes| moments(grid, body.placed, nodes));
            let nodes = &assembled.nodes[..D];
            let interior = interior_force(grid, body.placed, nodes, self.spin_up_of[body.body]);
            let mean_motion = self.inside[body.body].then(|| MeanMotion::new(grid, body.placed, nodes));
            Box::new(SpinningBody::new(assembled, interior, mean_motion, &self.spin_up_of, &mut workspace))
        };
        bodies.iter().map(of).collect()
    }

    fn bytes(&self, grid: &Grid<D>, size: &Size<D>) -> f64 {
        bytes(grid, size, self.precision)
    }

    fn reach(&self) -> f64 {
        INTERPOLATION_REACH
    }

    fn jumps(&self) -> bool {
        true
    }
}

/// The force inside a body, whole at every unknown inside.
fn interior_force<const D: usize>(grid: &Grid<D>, placed: &Placed<D>, nodes: &[JumpNodes<D>], factor: f64) -> InteriorForce {
    let mut force = InteriorForce::new(factor);
    for (component, nodes) in nodes.iter().enumerate() {
        each_inside(grid, nodes, |place, unknown| force.push(unknown, component, &(nodes.position(place) - placed.center), 1.0));
    }
    force
}

/// The translation of the rigid motion that is nearest to the flow inside a body.
struct MeanMotion {
    unknowns: Vec<usize>,
    places: Vec<u32>,
    /// Of each component of the translation (down), over the unknowns inside.
    weights: DMatrix<f64>,
}

impl MeanMotion {
    fn new<const D: usize>(grid: &Grid<D>, placed: &Placed<D>, nodes: &[JumpNodes<D>]) -> MeanMotion {
        let (mut unknowns, mut motions) = (Vec::new(), Vec::new());
        for (component, nodes) in nodes.iter().enumerate() {
            each_inside(grid, nodes, |place, unknown| {
                let offset = nodes.position(place) - placed.center;
                unknowns.push(unknown);
                motions.extend((0..D).map(|axis| f64::from(axis == component)));
                motions.extend((0..planes::<D>().len()).map(|plane| unit_rotation(plane, offset.as_slice(), component)));
            });
        }
        let motions = DMatrix::from_row_slice(unknowns.len(), D + planes::<D>().len(), &motions);
        let squares = motions.tr_mul(&motions).cholesky().expect("rigid motions differ at the points inside a body");
        let weights = squares.solve(&motions.transpose()).rows(0, D).into_owned();
        MeanMotion { unknowns, places: Vec::new(), weights }
    }

    fn read(&self, u: Entries, out: &mut [f64]) {
        out[..self.weights.nrows()].fill(0.0);
        for (weights, &place) in self.weights.column_iter().zip(&self.places) {
            let velocity = u.from(place)[0];
            out.iter_mut().zip(weights.iter()).for_each(|(out, weight)| *out += weight * velocity);
        }
    }
}

/// What one body adds.
struct SpinningBody<const D: usize> {
    blocks: SharpBody<D>,
    interior: InteriorForce,
    /// If the translation of the body is that of the flow inside.
    mean_motion: Option<MeanMotion>,
    /// For each row, what unit spin-ups add to it.
    rows: Vec<f64>,
    /// For each block of E, what unit spin-ups (down) of its body add to the rows of the modes (across).
    local: Vec<DMatrix<f64>>,
}

impl<const D: usize> SpinningBody<D> {
    /// Takes the columns of spin-ups out of the blocks of a body, and adds them to those of rotations.
    fn new(
        mut assembled: AssembledBody<D>,
        interior: InteriorForce,
        mean_motion: Option<MeanMotion>,
        spin_up_of: &[f64],
        workspace: &mut Workspace,
    ) -> Self {
        let (planes, count, factor) = (planes::<D>().len(), assembled.body.surface.modes.count(), interior.factor());
        let (mut values, mut rows) = (Vec::with_capacity(assembled.rows.values.len()), Vec::new());
        for row in assembled.rows.values.chunks_exact(count + planes) {
            let (of_modes, of_spin_ups) = row.split_at(count);
            let start = values.len();
            values.extend_from_slice(of_modes);
            of_spin_ups.iter().enumerate().for_each(|(plane, value)| values[start + D + plane] += factor * value);
            rows.extend_from_slice(of_spin_ups);
        }
        assembled.rows.values = values;
        let mut local = Vec::new();
        for block in &mut assembled.local {
            let of_modes = block.transposed.nrows() - planes;
            let mut of_spin_ups = block.transposed.rows(of_modes, planes).into_owned();
            let mut kept = block.transposed.rows(0, of_modes).into_owned();
            let mut rotations = kept.rows_mut(D, planes);
            rotations += &of_spin_ups * spin_up_of[block.body];
            if mean_motion.is_some() {
                // no jump is met inside
                [&mut kept, &mut of_spin_ups].into_iter().for_each(|block| block.columns_mut(0, D).fill(0.0));
            }
            block.transposed = kept;
            local.push(of_spin_ups);
        }
        SpinningBody { blocks: assembled.kept(workspace), interior, mean_motion, rows, local }
    }
}

impl<const D: usize> BodyBlocks<D> for SpinningBody<D> {
    fn count(&self) -> usize {
        self.blocks.count()
    }

    fn plan(&mut self, layout: &MultiplierLayout, plans: &mut Plans) {
        self.blocks.plan(layout, plans);
        self.interior.plan(&mut plans.spread);
        if let Some(mean_motion) = &mut self.mean_motion {
            mean_motion.places = plans.read.each(&mean_motion.unknowns);
        }
    }

    fn spread(&self, factor: f64, c: &[f64], scratch: &mut Vec<f64>, rows: &mut EntriesMut) {
        self.blocks.spread(factor, c, scratch, rows);
        self.interior.add_of_rotations::<D>(factor, c, rows);
    }

    fn read(&self, u: Entries, walls: Walls, scratch: &mut Vec<f64>, out: &mut [f64]) {
        self.blocks.read(u, walls, scratch, out);
    }

    fn rows(&self) -> BodyRows<'_, D> {
        self.blocks.rows()
    }

    fn add_local(&self, own: &[f64], all: Entries, out: &mut [f64]) {
        self.blocks.add_local(own, all, out);
    }

    fn interior(&self) -> Option<&dyn InteriorBlocks> {
        Some(self)
    }

    fn coefficients(&self, known: &dyn Fn(&SVector<f64, D>) -> SVector<f64, D>) -> Vec<f64> {
        self.blocks.coefficients(known)
    }

    fn first_moment(&self, c: &[f64]) -> SMatrix<f64, D, D> {
        self.blocks.first_moment(c)
    }

    fn add_on_walls(&self, c: &[f64], forces: &mut WallForces<D>) {
        self.blocks.add_on_walls(c, forces);
    }

    fn into_memory(self: Box<Self>) -> Vec<Vec<f32>> {
        Box::new(self.blocks).into_memory()
    }
}

impl<const D: usize> InteriorBlocks for SpinningBody<D> {
    fn spread_spin_up(&self, factor: f64, spin_up: &[f64], rows: &mut EntriesMut) {
        if spin_up.iter().any(|spin_up| *spin_up != 0.0) {
            for (place, values) in self.blocks.rows.places.iter().zip(self.rows.chunks_exact(spin_up.len())) {
                *rows.at(*place) += factor * dot(values, spin_up);
            }
            self.interior.add(factor, spin_up, rows);
        }
    }

    fn spin_up_of_rotation(&self) -> f64 {
        self.interior.factor()
    }

    fn add_spin_up(&self, spin_ups: Entries, out: &mut [f64]) {
        for (block, &place) in self.local.iter().zip(&self.blocks.local_places) {
            let spin_ups = &spin_ups.from(place)[rotations::<D>()];
            out.iter_mut().zip(block.column_iter()).for_each(|(out, column)| *out += dot(column.as_slice(), spin_ups));
        }
    }

    fn read_inside(&self, u: Entries, out: &mut [f64]) {
        if let Some(mean_motion) = &self.mean_motion {
            mean_motion.read(u, out);
        }
    }
}

/// Moments of the rows of unit spin-ups in each component: with the force inside they add up to those of the force in the whole body.
fn moments<const D: usize>(grid: &Grid<D>, placed: &Placed<D>, nodes: &[JumpNodes<D>]) -> Vec<Vec<[f64; TERMS]>> {
    let ball = placed.ball();
    // the mean of the square of a coordinate over a ball, over its radius
    let square = ball.volume() * ball.radius / (D as f64 + 2.0) / grid.spacing().product();
    let of = |component: usize| {
        let of_plane = |plane: usize| {
            let mut moments = [0.0; TERMS];
            for axis in 0..D {
                let unit: SVector<f64, D> = SVector::from_fn(|other, _| if other == axis { 1.0 } else { 0.0 });
                moments[axis + 1] = square * unit_rotation(plane, unit.as_slice(), component);
            }
            each_inside(grid, &nodes[component], |place, _| {
                let offset = nodes[component].position(place) - ball.center;
                let force = unit_rotation(plane, offset.as_slice(), component);
                moments[0] -= force;
                (0..D).for_each(|axis| moments[axis + 1] -= force * offset[axis] / ball.radius);
            });
            moments
        };
        (0..planes::<D>().len()).map(of_plane).collect()
    };
    (0..D).map(of).collect()
}

fn each_inside<const D: usize>(grid: &Grid<D>, nodes: &JumpNodes<D>, mut visit: impl FnMut(usize, usize)) {
    nodes.runs(
        grid,
        |row| row,
        |first, length, unknown| {
            (0..length).filter(|along| !nodes.outside[first + along]).for_each(|along| visit(first + along, unknown + along));
        },
    );
}
