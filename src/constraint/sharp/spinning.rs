//! The `sharp` method for bodies with inertia: the fluid inside spins up with them.
//!
//! What rotates rigidly ever faster needs the force `rho w' x r` inside, which no pressure bears, and the Laplacian of the velocity jumps by it across
//! the surface. The torque on a free body says how fast it spins up, `I w' = -(torque on the fluid)`: so both go with its rotation modes.

use std::rc::Rc;

use nalgebra::{DMatrix, SMatrix, SVector};

use super::{INTERPOLATION_REACH, JumpNodes, SharpBody, Workspace, assemble, bytes};
use crate::{
    body::planes,
    constraint::{
        body::{BodyBlocks, Plans, WallForces, Walls},
        conservation::TERMS,
        layout::MultiplierLayout,
        method::{Method, Size},
        placed::{Placed, Surrounded},
        places::{Entries, EntriesMut, Places},
    },
    grid::Grid,
    linalg::dot,
    surface::{SurfaceTable, unit_rotation},
};

/// The method; surfaces need the jumps of spin-ups ([`SurfaceTable::with_spin_up`]).
#[derive(Debug, Clone)]
pub struct SharpWithInertia {
    /// For each body, the spin-up `rho w' / mu` that a unit multiplier of rotation gives it; zero for prescribed motion.
    pub spin_up_of: Vec<f64>,
}

impl<const D: usize> Method<D, Box<dyn BodyBlocks<D>>> for SharpWithInertia {
    fn description(&self) -> String {
        "surface multipliers with corrected stencils (sharp), bodies with inertia".into()
    }

    fn assemble(&self, grid: &Grid<D>, bodies: &[Surrounded<D>], memory: Vec<Vec<f64>>) -> Vec<Box<dyn BodyBlocks<D>>> {
        let mut workspace = Workspace { values: memory, ..Workspace::default() };
        let of = |body: &Surrounded<D>| -> Box<dyn BodyBlocks<D>> {
            let (blocks, nodes) = assemble(grid, body, &mut workspace, |nodes| moments(grid, body.placed, nodes));
            let interior = Interior::new(grid, body.placed, &nodes[..D]);
            Box::new(SpinningBody::new(blocks, interior, body.body, &self.spin_up_of))
        };
        bodies.iter().map(of).collect()
    }

    fn bytes(&self, grid: &Grid<D>, size: &Size<D>) -> f64 {
        bytes(grid, size)
    }

    fn reach(&self) -> f64 {
        INTERPOLATION_REACH
    }
}

/// Unknowns inside a body, each with the velocity there of unit spins.
struct Interior {
    unknowns: Vec<usize>,
    places: Vec<u32>,
    /// One a plane for each unknown.
    velocities: Vec<f64>,
}

impl Interior {
    fn new<const D: usize>(grid: &Grid<D>, placed: &Placed<D>, nodes: &[JumpNodes<D>]) -> Interior {
        let mut interior = Interior { unknowns: Vec::new(), places: Vec::new(), velocities: Vec::new() };
        for (component, nodes) in nodes.iter().enumerate() {
            each_inside(grid, nodes, |place, unknown| {
                let offset = nodes.position(place) - placed.center;
                interior.unknowns.push(unknown);
                interior.velocities.extend((0..planes::<D>().len()).map(|plane| unit_rotation(plane, offset.as_slice(), component)));
            });
        }
        interior
    }

    fn plan(&mut self, places: &mut Places) {
        self.places = places.each(&self.unknowns);
    }

    fn add(&self, factor: f64, spin_up: &[f64], rows: &mut EntriesMut) {
        if spin_up.iter().all(|spin_up| *spin_up == 0.0) {
            return;
        }
        for (place, velocity) in self.places.iter().zip(self.velocities.chunks_exact(spin_up.len())) {
            *rows.at(*place) += factor * dot(velocity, spin_up);
        }
    }
}

/// What one body adds.
struct SpinningBody<const D: usize> {
    blocks: SharpBody<D>,
    interior: Interior,
    /// Spin-up of a unit multiplier of rotation.
    factor: f64,
    /// For each row, what unit spin-ups add to it.
    rows: Vec<f64>,
    /// For each block of E, the body that spins up and what its unit spin-ups (down) add to the rows of the modes (across).
    local: Vec<(usize, DMatrix<f64>)>,
}

impl<const D: usize> SpinningBody<D> {
    /// Takes the columns of spin-ups out of the blocks of a body, and adds them to those of rotations.
    fn new(mut blocks: SharpBody<D>, interior: Interior, body: usize, spin_up_of: &[f64]) -> Self {
        let (planes, count, factor) = (planes::<D>().len(), blocks.surface.modes.count(), spin_up_of[body]);
        let (mut values, mut rows) = (Vec::with_capacity(blocks.rows.values.len()), Vec::new());
        for row in blocks.rows.values.chunks_exact(count + planes) {
            let (of_modes, of_spin_ups) = row.split_at(count);
            let start = values.len();
            values.extend_from_slice(of_modes);
            of_spin_ups.iter().enumerate().for_each(|(plane, value)| values[start + D + plane] += factor * value);
            rows.extend_from_slice(of_spin_ups);
        }
        blocks.rows.values = values;
        let mut local = Vec::new();
        for block in &mut blocks.local {
            let of_modes = block.transposed.nrows() - planes;
            let of_spin_ups = block.transposed.rows(of_modes, planes).into_owned();
            let mut kept = block.transposed.rows(0, of_modes).into_owned();
            let mut rotations = kept.rows_mut(D, planes);
            rotations += &of_spin_ups * spin_up_of[block.body];
            block.transposed = kept;
            local.push((block.body, of_spin_ups));
        }
        SpinningBody { blocks, interior, factor, rows, local }
    }
}

impl<const D: usize> BodyBlocks<D> for SpinningBody<D> {
    fn count(&self) -> usize {
        self.blocks.count()
    }

    fn plan(&mut self, layout: &MultiplierLayout, plans: &mut Plans) {
        self.blocks.plan(layout, plans);
        self.interior.plan(&mut plans.spread);
    }

    fn spread(&self, factor: f64, c: &[f64], scratch: &mut Vec<f64>, rows: &mut EntriesMut) {
        self.blocks.spread(factor, c, scratch, rows);
        self.interior.add(factor * self.factor, &c[D..D + planes::<D>().len()], rows);
    }

    fn read(&self, u: Entries, walls: Walls, scratch: &mut Vec<f64>, out: &mut [f64]) {
        self.blocks.read(u, walls, scratch, out);
    }

    fn surface(&self) -> Option<&Rc<SurfaceTable<D>>> {
        self.blocks.surface()
    }

    fn add_local(&self, own: &[f64], all: Entries, out: &mut [f64]) {
        self.blocks.add_local(own, all, out);
    }

    fn spread_spin_up(&self, factor: f64, spin_up: &[f64], rows: &mut EntriesMut) {
        if spin_up.iter().any(|spin_up| *spin_up != 0.0) {
            for (place, values) in self.blocks.rows.places.iter().zip(self.rows.chunks_exact(spin_up.len())) {
                *rows.at(*place) += factor * dot(values, spin_up);
            }
            self.interior.add(factor, spin_up, rows);
        }
    }

    fn add_spin_up(&self, spin_ups: &[Vec<f64>], out: &mut [f64]) {
        for (body, block) in &self.local {
            for (out, column) in out.iter_mut().zip(block.column_iter()) {
                *out += column.iter().zip(&spin_ups[*body]).map(|(value, spin_up)| value * spin_up).sum::<f64>();
            }
        }
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

    fn into_memory(self: Box<Self>) -> Option<Vec<f64>> {
        Box::new(self.blocks).into_memory()
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
