//! The report of a plan: its effects, unknowns and memory.

use super::{
    Plan, PlannedModel,
    effects::{Effect, flow_effects, gravity, in_time, inertia},
    fitted,
    memory::{CONTACT_BYTES, bytes, multiplier_counts, scalar_bytes},
    report::{GridPlan, PlanReport},
};
use crate::{
    constraint::Size,
    error::Result,
    geometry::Ball,
    grid::{Grid, cells_along},
    mechanics::ScalarSetup,
    motion::GranularSetup,
    scene::ConstraintMethod,
    setup::Setup,
    system::mean_flow_constraint::MeanFlowConstraint,
};

impl<const D: usize> Plan<D> {
    /// What is built on so many ranks, and what it takes.
    ///
    /// # Errors
    /// Bodies, grid or rank count do not fit.
    pub fn report(&self, ranks: usize) -> Result<PlanReport> {
        let on_mesh = self.scene.method.constraint == ConstraintMethod::Fitted;
        let report = match &self.model {
            PlannedModel::Granular(setup) => self.of_granular(setup, ranks),
            PlannedModel::Scalar(setup) if on_mesh => fitted::scalar(setup, ranks)?,
            PlannedModel::Scalar(setup) => of_scalar(setup, ranks)?,
            PlannedModel::Flow(setup) if on_mesh => fitted::flow(self, setup, ranks)?,
            PlannedModel::Flow(setup) => self.of_flow(setup, ranks)?,
        };
        Ok(match self.asked_cells() {
            Some(cells) if !on_mesh => report.asked(cells),
            _ => report,
        })
    }

    /// The cells along the axes that the scene asks for, if it has a grid and says how fine.
    fn asked_cells(&self) -> Option<Vec<usize>> {
        let (domain, radii): (_, Vec<f64>) = match &self.model {
            PlannedModel::Granular(_) => return None,
            PlannedModel::Scalar(setup) => (&setup.domain, setup.inclusions.iter().map(|(ball, _)| ball.radius).collect()),
            PlannedModel::Flow(setup) => (&setup.domain, setup.bodies.iter().map(|suspended| suspended.body.ball.radius).collect()),
        };
        let spacing = self.scene.resolution.as_ref()?.spacing.length(radii.into_iter().fold(f64::INFINITY, f64::min));
        Some(cells_along(&domain.size, spacing).iter().map(|&cells| cells as usize).collect())
    }

    fn of_granular(&self, setup: &GranularSetup<D>, ranks: usize) -> PlanReport {
        let free = setup.bodies.iter().filter(|body| body.mass.is_finite()).count();
        let mut effects = vec![
            Effect::off("flow"),
            Effect::on("bodies", format!("{}, {free} of them free", setup.bodies.len())),
            Effect::on("inertia", "masses of the bodies".into()),
            Effect::off("pressure"),
            gravity(&self.scene),
            Effect::on("rotation", "spins of the bodies".into()),
        ];
        effects.extend(in_time(self));
        PlanReport::new(effects, None, CONTACT_BYTES * setup.bodies.len() as f64, ranks)
    }

    fn of_flow(&self, setup: &Setup<D>, ranks: usize) -> Result<PlanReport> {
        let grid = setup.grid(ranks, 0)?;
        let (mut effects, counts) = (flow_effects(setup, &grid), multiplier_counts(setup, &grid));
        effects.extend([inertia(setup), gravity(&self.scene)]);
        effects.extend(in_time(self));
        let fluid = GridPlan {
            cells: grid.cells().to_vec(),
            asked: None,
            blocks: grid.partition().ranks().to_vec(),
            grid_unknowns: grid.fluid_unknowns(),
            multiplier_unknowns: counts.iter().sum(),
            closure_unknowns: MeanFlowConstraint::count(&setup.drive, &setup.domain),
        };
        Ok(PlanReport::new(effects, Some(fluid), bytes(setup, &grid, &counts, self.scene.time.is_some()), ranks))
    }
}

fn of_scalar<const D: usize>(setup: &ScalarSetup<D>, ranks: usize) -> Result<PlanReport> {
    let grid = Grid::new(&setup.domain, setup.spacing, ranks, 0)?;
    let inclusions = match setup.inclusions.len() {
        0 => Effect::off("inclusions"),
        count => Effect::on("inclusions", format!("{count}, {}", setup.method().description())),
    };
    let source = format!("{} outside the inclusions", setup.source);
    let gradient = setup.gradient.map(|gradient| format!("{:?}", gradient.as_slice()));
    let effects = vec![
        Effect::on("scalar", "one matrix, one multigrid hierarchy (hypre)".into()),
        Effect { name: "source".into(), built: (setup.source != 0.0).then_some(source) },
        Effect { name: "mean gradient".into(), built: gradient },
        inclusions,
    ]
    .into_iter()
    .chain(["pressure", "gravity", "rotation", "motion in time"].map(Effect::off))
    .collect();
    let counts = setup.counts(&grid);
    let (grid_unknowns, multiplier_unknowns) = (grid.unknowns(D), counts.iter().sum::<usize>());
    let fluid = GridPlan {
        cells: grid.cells().to_vec(),
        asked: None,
        blocks: grid.partition().ranks().to_vec(),
        grid_unknowns,
        multiplier_unknowns,
        closure_unknowns: 0,
    };
    let method = setup.method();
    let size = |(&(ball, order), &count): (&(Ball<D>, usize), &usize)| method.bytes(&grid, &Size { ball, order, count });
    let blocks: f64 = setup.inclusions.iter().zip(&counts).map(size).sum();
    Ok(PlanReport::new(effects, Some(fluid), scalar_bytes(&grid, multiplier_unknowns) + blocks, ranks))
}
