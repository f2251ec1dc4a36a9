//! What outputs and quantities see of a run.

use std::{cell::OnceCell, path::Path};

use nalgebra::SVector;

use super::{
    column::SeriesEntry,
    motion_view::{ContactTotals, MotionView},
    viscosity::ViscosityHistory,
};
use crate::{
    error::Result,
    mechanics::FlowSolver,
    motion::Simulation,
    observe::{ChainNumbers, InertialNumbers, MembraneNumbers, Shear, Viscosity},
    output::write_whole,
    parallel::World,
    scene::Scene,
    system::Solution,
};

/// What there is to write of an instant.
pub struct View<'a, const D: usize> {
    /// All ranks.
    pub world: &'a World,
    /// What is simulated.
    pub scene: &'a Scene,
    /// The flow, if there is one.
    pub flow: Option<FlowView<'a, D>>,
    /// Its viscosity, in a sheared suspension.
    pub viscosity: Option<Viscosity>,
    /// The bodies on their way, in a run in time.
    pub motion: Option<MotionView<'a, D>>,
    /// The viscosity over time.
    pub history: &'a ViscosityHistory,
    /// What was measured of this instant, a number for each column.
    pub row: &'a [SeriesEntry],
    /// What several quantities need, once it was found.
    found: SharedMeasurements<D>,
}

/// Measurements from which several quantities are read.
#[derive(Default)]
struct SharedMeasurements<const D: usize> {
    inertia: OnceCell<Option<InertialNumbers>>,
    contacts: OnceCell<Option<ContactTotals>>,
    centers: OnceCell<Option<Vec<SVector<f64, D>>>>,
    chains: OnceCell<Option<ChainNumbers<D>>>,
    membranes: OnceCell<Option<MembraneNumbers>>,
}

/// A flow at an instant.
#[derive(Clone, Copy)]
pub struct FlowView<'a, const D: usize> {
    /// What solved it.
    pub solver: &'a dyn FlowSolver<D>,
    /// The solution.
    pub solution: &'a Solution<D>,
}

impl<'a, const D: usize> View<'a, D> {
    /// Of a run of a scene; nothing was measured yet.
    pub(super) fn new(world: &'a World, scene: &'a Scene, history: &'a ViscosityHistory) -> View<'a, D> {
        View { world, scene, history, flow: None, viscosity: None, motion: None, row: &[], found: SharedMeasurements::default() }
    }

    /// The simple shear that box and drive impose on the flow, if it is one.
    pub fn shear(&self) -> Option<Shear<D>> {
        let setup = self.flow?.solver.setup();
        Shear::of(&setup.domain, &setup.drive)
    }

    /// What inertia amounts to in a flow that has it. Collective, as are the next ones.
    ///
    /// # Errors
    /// PETSc fails.
    pub fn inertia(&self) -> Result<Option<InertialNumbers>> {
        if let Some(known) = self.found.inertia.get() {
            return Ok(*known);
        }
        let start = self.motion.is_none_or(|motion| motion.state().steps == 0);
        let found = match &self.flow {
            Some(flow) => InertialNumbers::of(flow.solver.setup(), flow.solver.grid(), flow.solution, start)?,
            None => None,
        };
        Ok(*self.found.inertia.get_or_init(|| found))
    }

    /// The contacts of all bodies, in a run in time.
    pub fn contacts(&self) -> Option<ContactTotals> {
        *self.found.contacts.get_or_init(|| Some(self.motion?.contact_totals(self.world)))
    }

    /// The centres of all bodies, not moved back into the box, in a run in time.
    pub fn whole_centers(&self) -> Option<&[SVector<f64, D>]> {
        let centers = || Some(self.motion?.simulation.whole_state().centers());
        self.found.centers.get_or_init(centers).as_deref()
    }

    /// The chains; nothing without chains.
    pub fn chains(&self) -> Option<ChainNumbers<D>> {
        let of = |simulation: &Simulation<D>| match simulation.interactions().chains().is_empty() {
            true => None,
            false => ChainNumbers::of(simulation.interactions(), self.whole_centers()?),
        };
        *self.found.chains.get_or_init(|| of(self.motion?.simulation))
    }

    /// The red cells; nothing without any.
    pub fn membranes(&self) -> Option<&MembraneNumbers> {
        let of = |simulation: &Simulation<D>| match simulation.interactions().conserved().is_empty() {
            true => None,
            false => MembraneNumbers::of(simulation.interactions(), self.whole_centers()?),
        };
        self.found.membranes.get_or_init(|| of(self.motion?.simulation)).as_ref()
    }

    /// Writes a file of the run on the first rank, and gives its name.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write_file(&self, folder: &Path, name: &str, bytes: &[u8]) -> Result<String> {
        self.world.on_first_rank(|| write_whole(&folder.join(name), bytes))?;
        Ok(name.to_owned())
    }
}
