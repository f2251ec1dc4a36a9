//! What is known of a flow at one time, and what the next steps take of it.
//!
//! The field on the grid is the flow outside bodies and the motion inside. Where a surface will have passed a point, the point takes part in what
//! lies outside: so the flow is extended into bodies by its jump functions, `u + D`, as deep as steps and stencils reach. In convection only
//! the tangential traction counts: the pressure of a step comes from its convection, and would come back into the next one larger. Methods without
//! jump functions take the field on the grid as it is.
//!
//! Jump functions are those of means of multipliers over the time in which viscosity passes a third of a cell. In steps shorter than that a multiplier moves the
//! grid's velocity by `h^2 / (nu dt)` times less than its jump function says, so that what is wrong by rounding or a coarse grid would grow from
//! step to step where a body passes points: a disk that moves half a cell a step at 36 for the Reynolds number of a cell was unstable.

use nalgebra::{DVector, SVector};

use super::{
    bodies::BodyTypes,
    points::{Point, each_inside, within},
};
use crate::{
    body::Twist,
    error::Result,
    grid::Grid,
    interaction::Wrench,
    linalg::dot,
    petsc::{Scatter, Vector},
};

/// How deep the flow is extended into bodies, in cells.
const DEPTH: f64 = 3.5;

/// How far from surfaces rigid motions are needed, in cells: as far as a point that a body reaches in a step may be, and its neighbours.
const REACH: f64 = 3.5;

/// Depths below a surface, in cells, between which the slope of a jump is measured.
const SLOPE: [f64; 2] = [0.1, 1.0];

/// Jump functions this close to the centre, in radii, say nothing.
pub const CORE: f64 = 0.2;

/// The flow and the bodies at one time.
pub struct Level<const D: usize> {
    /// The time.
    pub time: f64,
    /// Velocity and pressure over viscosity.
    pub fluid: Vector,
    /// Multipliers, body by body; none where the method has no jump functions.
    pub multipliers: Vec<Vec<f64>>,
    /// Their means over the time in which viscosity passes a third of a cell: with what they lag behind, those of jump functions.
    pub smooth: Vec<Vec<f64>>,
    /// Their means over the time in which viscosity passes half a cell, by which surfaces in thin gaps are damped.
    pub slow: Vec<Vec<f64>>,
    /// Their means over the time in which viscosity passes a cell: what `smooth` differs from them by tells how fast multipliers change. Less at the start,
    /// and nothing in sheared boxes.
    pub lagging: Vec<Vec<f64>>,
    /// Centres of the bodies, not wrapped into the box.
    pub centers: Vec<SVector<f64, D>>,
    /// Their motions.
    pub twists: Vec<Twist<D>>,
    /// Their spin-ups, density of the fluid over viscosity times rate of change of the spin.
    pub spin_ups: Vec<Vec<f64>>,
    /// The impulse that contacts gave each of them in the step that led here, and its moment.
    pub impulses: Vec<Wrench<D>>,
    /// The part of jumps that convection sees, none at the start; until the level is past that of the one before.
    pub resolved: f64,
}

/// What a step takes of a level.
pub struct Extended<const D: usize> {
    /// The velocity, that outside bodies extended into them.
    pub velocity: Vector,
    /// The convection that rows outside bodies take.
    pub convection: Vector,
    /// That of rows inside, where it is another one.
    pub inside: Option<Vector>,
    /// Sums over the grid of the velocity that is not extended, and of its convection in flux form.
    pub sums: [SVector<f64, D>; 2],
}

impl<const D: usize> Extended<D> {
    /// The convection that rows inside bodies take.
    pub fn inside(&self) -> &Vector {
        self.inside.as_ref().unwrap_or(&self.convection)
    }
}

/// A velocity of this rank near a body or in it.
pub struct Near {
    /// Among the rank's entries.
    pub place: usize,
    pub component: usize,
    pub body: usize,
    /// Distance from the surface; negative inside.
    pub gap: f64,
    /// The rigid motion of the body there, in a sheared box less the shear.
    pub rigid: f64,
}

/// Unknowns inside bodies of this rank, near their surfaces, and the jumps there.
#[derive(Default)]
pub struct Band {
    pub places: Vec<usize>,
    /// By the whole traction.
    pub whole: Vec<f64>,
    /// By its tangential part.
    pub tangential: Vec<f64>,
    /// Squares of the slopes of tangential jumps within a cell of the surface and their number, by body and component.
    pub slopes: Vec<f64>,
    /// Velocities of this rank near bodies, each of the nearest one's.
    pub near: Vec<Near>,
}

impl<const D: usize> Level<D> {
    /// The jumps of a component of the velocity, outside minus inside, at offsets from the centre of a body, none in its core; one after the other.
    pub fn jumps_at(&self, body_types: &BodyTypes<D>, body: usize, offsets: &[f64], component: usize) -> Vec<f64> {
        let (modes, coefficients) = (&body_types.surface(body).modes, self.coefficients(body, &self.of_jumps(body)));
        let count = modes.jump_count();
        let mut jumps = vec![0.0; offsets.len() / D * count];
        modes.velocity_jumps(offsets, component, &mut jumps);
        let mut jumps: Vec<f64> = jumps.chunks_exact(count).map(|jumps| dot(jumps, &coefficients)).collect();
        if let Some(unsteady) = self.unsteady_jump(body_types, body) {
            unsteady.add(modes.as_ref(), offsets, component, &mut jumps);
        }
        jumps
    }

    /// The velocity, that outside bodies extended into them as multipliers are at that time: what lags behind them tells of slopes that a flow that has met
    /// something no longer has. Collective.
    pub fn velocity_outside(&self, grid: &Grid<D>, body_types: &BodyTypes<D>) -> Result<Vector> {
        let jumps = self.jumps(grid, body_types, &self.multipliers);
        self.with_jumps(&mut Scatter::new(&self.fluid, &jumps.places)?, &jumps.whole)
    }

    /// The fluid with jumps added at the places of a scatter.
    pub fn with_jumps(&self, scatter: &mut Scatter, jumps: &[f64]) -> Result<Vector> {
        let mut extended = self.fluid.copied()?;
        scatter.places().copy_from_slice(jumps);
        scatter.add_back(&mut extended)?;
        Ok(extended)
    }

    /// The jumps in bodies, and what is near them, on the grid of that time.
    ///
    /// # Errors
    /// PETSc fails.
    pub fn band(&self, grid: &Grid<D>, body_types: &BodyTypes<D>) -> Result<Band> {
        let multipliers: Vec<Vec<f64>> = (0..self.centers.len()).map(|body| self.of_jumps(body)).collect();
        Ok(Band { near: self.near(grid, body_types)?, ..self.jumps(grid, body_types, &multipliers) })
    }

    /// The jumps in bodies by these multipliers of all of them.
    fn jumps(&self, grid: &Grid<D>, body_types: &BodyTypes<D>, multipliers: &[Vec<f64>]) -> Band {
        let mut band = Band { slopes: vec![0.0; 2 * D * self.centers.len()], ..Band::default() };
        multipliers.iter().enumerate().for_each(|(body, multipliers)| self.extend(grid, body_types, body, multipliers, &mut band));
        band
    }

    /// The velocities of this rank near bodies, each of the nearest one's.
    fn near(&self, grid: &Grid<D>, body_types: &BodyTypes<D>) -> Result<Vec<Near>> {
        let own = self.fluid.range()?;
        let mut claims: Vec<Option<u32>> = vec![None; own.len()];
        let mut near: Vec<Near> = Vec::new();
        for (body, center) in self.centers.iter().enumerate() {
            let radius = body_types.surface(body).modes.radius();
            within(grid, center, radius + REACH * grid.spacing().max(), |Point { component, place, offset, shear, .. }| {
                if !own.contains(&place) {
                    return;
                }
                let (place, gap) = (place - own.start, offset.norm() - radius);
                let found = Near { place, component, body, gap, rigid: (self.twists[body].at(&offset) - shear)[component] };
                match claims[place] {
                    Some(before) if near[before as usize].gap <= gap => {}
                    Some(before) => near[before as usize] = found,
                    None => {
                        claims[place] = Some(near.len() as u32);
                        near.push(found);
                    }
                }
            });
        }
        Ok(near)
    }

    /// Adds the points inside a body with these multipliers near its surface, if it is this rank's.
    fn extend(&self, grid: &Grid<D>, body_types: &BodyTypes<D>, body: usize, multipliers: &[f64], band: &mut Band) {
        let surface = body_types.surface(body);
        let (radius, count) = (surface.modes.radius(), surface.modes.jump_count());
        let (whole, unsteady) = (self.coefficients(body, multipliers), self.unsteady_jump(body_types, body));
        let tangential = body_types.tangential(body) * DVector::from_column_slice(multipliers);
        let tangential = self.coefficients(body, tangential.as_slice());
        let deepest = (radius - DEPTH * grid.spacing().max()).max(CORE * radius);
        let mut offsets = vec![Vec::new(); D];
        each_inside(grid, &self.centers[body], radius, |Point { component, place, offset, .. }| {
            if offset.norm() >= deepest {
                band.places.push(place);
                offsets[component].extend_from_slice(offset.as_slice());
            }
        });
        for (component, offsets) in offsets.iter().enumerate() {
            let mut jumps = vec![0.0; offsets.len() / D * count];
            surface.modes.velocity_jumps(offsets, component, &mut jumps);
            let first = band.whole.len();
            band.whole.extend(jumps.chunks_exact(count).map(|jumps| dot(jumps, &whole)));
            if let Some(unsteady) = &unsteady {
                unsteady.add(surface.modes.as_ref(), offsets, component, &mut band.whole[first..]);
            }
            band.tangential.extend(jumps.chunks_exact(count).map(|jumps| dot(jumps, &tangential)));
            let found = &band.tangential[band.tangential.len() - offsets.len() / D..];
            let slopes = &mut band.slopes[2 * (D * body + component)..][..2];
            for (jump, offset) in found.iter().zip(offsets.chunks_exact(D)) {
                let depth = (radius - SVector::<f64, D>::from_column_slice(offset).norm()) / grid.spacing().max();
                if (SLOPE[0]..SLOPE[1]).contains(&depth) {
                    slopes[0] += (jump / (depth * grid.spacing().max())).powi(2);
                    slopes[1] += 1.0;
                }
            }
        }
    }

    /// Coefficients of the jump functions of a body, for these of its modes.
    fn coefficients(&self, body: usize, modes: &[f64]) -> Vec<f64> {
        modes.iter().chain(&self.spin_ups[body]).copied().collect()
    }
}
