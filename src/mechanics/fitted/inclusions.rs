//! Inclusions of the scalar problem on a fitted mesh.

use std::time::Instant;

use nalgebra::Vector2;

use super::plane::{flat, flat_disk, plane};
use crate::{
    error::{Error, Result},
    fitted::{Mesh, MeshScalar, Place, ScalarNumbering, System, generate},
    geometry::Ball,
    grid::{Grid, operators::signed},
    mechanics::{InclusionState, ScalarSetup, ScalarSolution},
    petsc::{Report, Session, Stage, Vector, enter},
    system::{Cost, ResidualMonitor},
};

/// The scalar problem in 2D on a mesh that fits the inclusions.
pub struct FittedInclusions<const D: usize> {
    session: Session,
    setup: ScalarSetup<D>,
    grid: Grid<D>,
    mesh: Mesh,
    cost: Cost,
}

impl<const D: usize> FittedInclusions<D> {
    /// Makes the mesh of a setup.
    ///
    /// # Errors
    /// The box has no wall, no mesh fits, or the rank count does not fit the grid on which the scalar is given.
    pub fn new(session: &Session, setup: ScalarSetup<D>) -> Result<FittedInclusions<D>> {
        if setup.domain.fully_periodic() {
            return Err(Error::refused("a scalar in a fully periodic box has no definite value; put up walls along an axis"));
        }
        let (_stage, start, world) = (enter(Stage::SetUp), Instant::now(), session.world());
        let grid = Grid::new(&setup.domain, setup.spacing, world.size(), world.rank())?;
        let mesh = mesh(&setup)?;
        let cost = Cost { setup: start.elapsed().as_secs_f64(), meshes: 1, ..Cost::default() };
        Ok(FittedInclusions { session: session.clone(), setup, grid, mesh, cost })
    }

    /// The grid on which the scalar is given.
    pub fn grid(&self) -> &Grid<D> {
        &self.grid
    }

    /// What is solved.
    pub fn setup(&self) -> &ScalarSetup<D> {
        &self.setup
    }

    /// What the last solve cost.
    pub fn cost(&self) -> &Cost {
        &self.cost
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Solves; `monitor` is told the relative residual.
    ///
    /// # Errors
    /// [`Error::Diverged`] when the matrix is singular.
    pub fn solve(&mut self, monitor: ResidualMonitor) -> Result<ScalarSolution<D>> {
        let (stage, start) = (enter(Stage::Assembly), Instant::now());
        let numbering = ScalarNumbering::new(&self.mesh);
        let mut system = System::new(self.session.world(), numbering.unknowns());
        numbering.assemble(&self.mesh, self.setup.source, &mut system)?;
        self.cost.assembly = start.elapsed().as_secs_f64();
        drop(stage);
        let (_stage, start) = (enter(Stage::Inverse), Instant::now());
        let (found, residual) = system.solve(&self.session, &mut None)?;
        monitor(1, residual);
        self.cost.stages.inverse = start.elapsed().as_secs_f64();
        self.cost.krylov = Report { iterations: 1, residual, seconds: self.cost.stages.inverse };
        self.cost.grid_unknowns = numbering.unknowns();
        self.solution(numbering.values(&found))
    }

    fn solution(&self, nodes: Vec<f64>) -> Result<ScalarSolution<D>> {
        let (integral, fluxes) = self.integrals(&nodes)?;
        let on_mesh = MeshScalar { mesh: self.mesh.clone(), nodes };
        let state = |(((ball, _), disk), flux): ((&(Ball<D>, usize), usize), f64)| InclusionState {
            center: self.setup.domain.wrap(ball.center),
            radius: ball.radius,
            value: on_mesh.in_disk(disk),
            flux,
        };
        let inclusions = self.setup.inclusions.iter().zip(0..).zip(fluxes).map(state).collect();
        let energy = -0.5 * self.setup.source * integral;
        let field = self.interpolate(&on_mesh)?;
        Ok(ScalarSolution { inclusions, field, on_mesh: Some(on_mesh), energy, mean_flux: None, uzawa: None })
    }

    /// Integral of the scalar outside the inclusions, and net fluxes out of these.
    fn integrals(&self, values: &[f64]) -> Result<(f64, Vec<f64>)> {
        let (mut integral, mut fluxes) = (0.0, vec![0.0; self.mesh.disks.len()]);
        for triangle in &self.mesh.triangles {
            for sample in self.mesh.shape(triangle).samples()? {
                let at_nodes = triangle.nodes.map(|node| values[node]);
                integral += sample.weight * at_nodes.iter().zip(sample.values).map(|(one, other)| one * other).sum::<f64>();
                let gradient: Vector2<f64> = at_nodes.iter().zip(sample.gradients).map(|(value, slope)| slope * *value).sum();
                for (i, &node) in triangle.nodes.iter().enumerate() {
                    let Place::Surface(disk) = self.mesh.places[node] else { continue };
                    fluxes[disk] += sample.weight * (sample.gradients[i].dot(&gradient) - self.setup.source * sample.values[i]);
                }
            }
        }
        Ok((integral, fluxes))
    }

    /// The scalar at this rank's cell centres.
    fn interpolate(&self, on_mesh: &MeshScalar) -> Result<Vector> {
        let mut field = Vector::new(&self.session, self.grid.local_unknowns(D))?;
        let centers = self.grid.block(D).indices().map(|index| flat(&self.grid.position(D, signed(index))));
        field.local_mut()?.copy_from_slice(&on_mesh.at(centers)?);
        Ok(field)
    }
}

fn mesh<const D: usize>(setup: &ScalarSetup<D>) -> Result<Mesh> {
    let disks: Vec<Ball<2>> = setup.inclusions.iter().map(|(ball, _)| flat_disk(ball)).collect();
    generate(&plane(&setup.domain), &disks, setup.spacing)
}

/// Numbers of triangles and unknowns of a setup.
///
/// # Errors
/// No mesh fits.
pub fn size<const D: usize>(setup: &ScalarSetup<D>) -> Result<(usize, usize)> {
    let mesh = mesh(setup)?;
    Ok((mesh.triangles.len(), ScalarNumbering::new(&mesh).unknowns()))
}
