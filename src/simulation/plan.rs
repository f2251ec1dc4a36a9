//! What a scene calls for, before anything is built.

mod demand;
mod effects;
mod fitted;
mod memory;

use std::fmt;

use crate::{
    constraint::Size,
    error::Result,
    geometry::Ball,
    grid::Grid,
    scene::{ConstraintMethod, FlowModel, Scene},
    simulation::{DrySetup, ScalarSetup, Setup, closure::Closure, law},
};
pub use demand::demand;
use effects::{Effect, flow_effects, gravity, in_time};
use memory::{CONTACT_BYTES, bytes, multiplier_counts, scalar_bytes};

/// The effects of a scene with their unknowns and memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    effects: Vec<Effect>,
    /// How the resolution was chosen, or who is to choose it.
    choice: Option<String>,
    fluid: Option<FluidPlan>,
    bytes: f64,
}

#[derive(Debug, Clone, PartialEq)]
struct FluidPlan {
    cells: Vec<usize>,
    blocks: Vec<usize>,
    grid_unknowns: usize,
    multiplier_unknowns: usize,
    closure_unknowns: usize,
}

impl Plan {
    /// The plan of a scene of dimension `D` on a number of ranks; builds no matrix and solves nothing.
    ///
    /// # Errors
    /// Bodies, grid or rank count do not fit.
    pub fn of<const D: usize>(scene: &Scene, ranks: usize) -> Result<Plan> {
        let on_mesh = scene.method.constraint == ConstraintMethod::Fitted;
        match scene.flow.model {
            FlowModel::None => Plan::of_dry(scene, &DrySetup::<D>::of(scene)?),
            FlowModel::Scalar => {
                let setup = ScalarSetup::<D>::of(scene)?;
                if on_mesh { fitted::scalar(&setup, ranks) } else { Plan::of_scalar(&setup, ranks) }
            }
            FlowModel::Stokes => {
                let setup = Setup::<D>::of(scene)?;
                if on_mesh { fitted::flow(scene, &setup, ranks) } else { Plan::of_flow(scene, &setup, ranks) }
            }
        }
    }

    /// The plan with a line that says how its resolution was chosen.
    pub fn with_choice(self, choice: String) -> Plan {
        Plan { choice: Some(choice), ..self }
    }

    /// The plan without grid, unknowns and memory, which take a resolution that is yet to be chosen in the way that is said.
    pub fn undecided(self, choice: String) -> Plan {
        Plan { fluid: None, bytes: f64::NAN, ..self.with_choice(choice) }
    }

    /// Unknowns of the grid and multipliers, if there is a grid.
    pub fn unknowns(&self) -> Option<(usize, usize)> {
        self.fluid.as_ref().map(|fluid| (fluid.grid_unknowns, fluid.multiplier_unknowns))
    }

    /// Bytes that it takes on all ranks together.
    pub fn bytes(&self) -> f64 {
        self.bytes
    }

    fn of_dry<const D: usize>(scene: &Scene, setup: &DrySetup<D>) -> Result<Plan> {
        let free = setup.bodies.iter().filter(|body| body.mass.is_finite()).count();
        let mut effects = vec![
            Effect::off("flow"),
            Effect::on("bodies", format!("{}, {free} of them free", setup.bodies.len())),
            Effect::on("inertia", "masses of the bodies".into()),
            Effect::off("pressure"),
            gravity(scene),
            Effect::on("rotation", "spins of the bodies".into()),
        ];
        effects.extend(in_time(scene, setup.longest_step()));
        Ok(Plan { effects, choice: None, fluid: None, bytes: CONTACT_BYTES * setup.bodies.len() as f64 })
    }

    fn of_scalar<const D: usize>(setup: &ScalarSetup<D>, ranks: usize) -> Result<Plan> {
        let grid = Grid::new(&setup.domain, setup.spacing, ranks, 0)?;
        let inclusions = match setup.inclusions.len() {
            0 => Effect::off("inclusions"),
            count => Effect::on("inclusions", format!("{count}, {}", setup.method().description())),
        };
        let source = format!("{} outside the inclusions", setup.source);
        let gradient = setup.gradient.map(|gradient| format!("{:?}", gradient.as_slice()));
        let effects = vec![
            Effect::on("scalar", "one matrix, one multigrid hierarchy (hypre)".into()),
            Effect { name: "source", built: (setup.source != 0.0).then_some(source) },
            Effect { name: "mean gradient", built: gradient },
            inclusions,
        ]
        .into_iter()
        .chain(["pressure", "gravity", "rotation", "motion in time"].map(Effect::off))
        .collect();
        let counts = setup.counts(&grid);
        let (grid_unknowns, multiplier_unknowns) = (grid.unknowns(D), counts.iter().sum::<usize>());
        let fluid = FluidPlan {
            cells: grid.cells().to_vec(),
            blocks: grid.partition().ranks().to_vec(),
            grid_unknowns,
            multiplier_unknowns,
            closure_unknowns: 0,
        };
        let method = setup.method();
        let size = |(&(ball, order), &count): (&(Ball<D>, usize), &usize)| method.bytes(&grid, &Size { ball, order, count });
        let blocks: f64 = setup.inclusions.iter().zip(&counts).map(size).sum();
        Ok(Plan { effects, choice: None, fluid: Some(fluid), bytes: scalar_bytes(&grid, multiplier_unknowns) + blocks })
    }

    fn of_flow<const D: usize>(scene: &Scene, setup: &Setup<D>, ranks: usize) -> Result<Plan> {
        let grid = Grid::new(&setup.domain, setup.spacing, ranks, 0)?;
        let (mut effects, counts) = (flow_effects(setup, &grid), multiplier_counts(setup, &grid));
        effects.extend([Effect::off("inertia"), gravity(scene)]);
        let contact = law::of_flow(scene.contact.model, setup);
        let longest = law::longest_step_in_flow(contact, setup);
        law::check(scene, contact, longest)?;
        effects.extend(in_time(scene, longest));
        let fluid = FluidPlan {
            cells: grid.cells().to_vec(),
            blocks: grid.partition().ranks().to_vec(),
            grid_unknowns: grid.fluid_unknowns(),
            multiplier_unknowns: counts.iter().sum(),
            closure_unknowns: Closure::count(&setup.drive, &setup.domain),
        };
        Ok(Plan { effects, choice: None, fluid: Some(fluid), bytes: bytes(setup, (&grid, &counts), scene.time.is_some()) })
    }
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Effect { name, built } in &self.effects {
            match built {
                Some(built) => writeln!(f, "built      {name}: {built}")?,
                None => writeln!(f, "not built  {name}")?,
            }
        }
        if let Some(choice) = &self.choice {
            writeln!(f, "accuracy   {choice}")?;
        }
        if let Some(fluid) = &self.fluid {
            writeln!(f, "grid       {:?} cells in {:?} blocks", fluid.cells, fluid.blocks)?;
            writeln!(
                f,
                "unknowns   {} on the grid, {} multipliers, {} mean values",
                fluid.grid_unknowns, fluid.multiplier_unknowns, fluid.closure_unknowns
            )?;
        }
        if self.bytes.is_finite() {
            writeln!(f, "memory     about {:.0} MB on all ranks", (self.bytes / 1e6).ceil())?;
        }
        Ok(())
    }
}
