//! `summary.json`: the numbers of a run.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{
    AccuracySummary, AutocorrelationSummary, DisplacementSummary, DragSummary, ForceSummary, MeanViscosity, OscillationSummary,
    PairSummary, ParallelSummary, QuantitySummary, ScalarSummary, Spread, StructureFactorSummary, TooShort, VelocitySummary,
    body_summary::{BodySummary, ListedBodies, MOST_LISTED, OtherBodies},
};
use crate::{
    flow::{Drive, InverseMethod},
    geometry::Ball,
    mechanics::{FlowSolver, SolvedScalar},
    motion::Simulation,
    observe::{InertialNumbers, Part, Parts, Viscosity, why_no_viscosity},
    parallel::{World, peak_memory_bytes},
    scene::Scene,
    setup::Setup,
    system::{Cost, Lubrication, Solution},
};

/// Everything that `summary.json` holds; an effect that the scene does not call for is `null`.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    /// Name of the scene.
    pub scene: String,
    /// Its title.
    pub title: String,
    /// Version of the program.
    pub version: &'static str,
    /// Time reached.
    pub time: f64,
    /// Steps made.
    pub steps: usize,
    /// Part of the box that bodies fill.
    pub fraction: f64,
    /// The bodies; if there are more than [`MOST_LISTED`], the first of them.
    pub bodies: Vec<BodySummary>,
    /// The others, if there are any.
    pub other_bodies: Option<OtherBodies>,
    /// Force of the fluid on bodies whose motion is given.
    pub forces: Option<ForceSummary>,
    /// Velocities of free bodies.
    pub velocities: Option<VelocitySummary>,
    /// The flow.
    pub flow: Option<FlowSummary>,
    /// The scalar around inclusions, where it takes the place of the flow.
    pub scalar: Option<ScalarSummary>,
    /// Apparent viscosity over that of the fluid, in a sheared suspension of free bodies.
    pub viscosity: Option<ViscositySummary>,
    /// What a shear that oscillates measures.
    pub oscillation: Option<OscillationSummary>,
    /// Why such a suspension has none.
    pub no_viscosity: Option<String>,
    /// All that was measured of the suspension, by the names of columns of `series.csv`.
    pub quantities: BTreeMap<String, QuantitySummary>,
    /// What inertia amounts to, in a run of a flow that has it.
    pub inertia: Option<InertiaSummary>,
    /// The balance of its energy from start to end, if it is asked for.
    pub energy: Option<EnergySummary>,
    /// Error bars, if the scene asks for an accuracy.
    pub accuracy: Option<AccuracySummary>,
    /// Films, if lubrication acts.
    pub lubrication: Option<LubricationSummary>,
    /// Contacts, if a contact model acts.
    pub contact: Option<ContactSummary>,
    /// How bodies lie to each other, if the scene asks for it.
    pub pairs: Option<PairSummary>,
    /// How far from random their places are at each length, if the scene asks for it.
    pub structure_factor: Option<StructureFactorSummary>,
    /// How far they go besides what carries all of them along, if the scene asks for it.
    pub displacements: Option<DisplacementSummary>,
    /// How long they keep their velocities besides those of the shear, if the scene asks for it.
    pub velocity_autocorrelation: Option<AutocorrelationSummary>,
    /// What the last solve of the flow cost.
    pub solver: Option<SolverSummary>,
    /// The run as a whole, if it was one in time.
    pub motion: Option<MotionSummary>,
    /// Ranks used.
    pub ranks: usize,
    /// How evenly they shared the work, and what they sent.
    pub parallel: ParallelSummary,
}

/// The flow as a whole.
#[derive(Debug, Clone, Serialize)]
pub struct FlowSummary {
    /// What drives it: `none`, `mean-velocity`, `pressure-gradient`, `body-force`, `shear`, or
    /// `shear-stress` where a stress decides the rate.
    pub drive: &'static str,
    /// Over the whole box, bodies included, without a background shear.
    pub mean_velocity: Vec<f64>,
    /// Mean velocity along each axis times the area of the box across it (the length in two dimensions).
    pub flow_rate: Vec<f64>,
    /// The mean one.
    pub pressure_gradient: Vec<f64>,
}

/// Apparent viscosity and its parts.
#[derive(Debug, Clone, Serialize)]
pub struct ViscositySummary {
    /// Total.
    pub relative: f64,
    /// Its parts; that of contacts if a contact model acts.
    #[serde(flatten)]
    pub parts: Parts<f64>,
    /// Where the value for a grid without end lies, lowest and highest, if the scene asks for an accuracy.
    pub interval: Option<[f64; 2]>,
    /// From the shear stress on the walls: must agree with `relative`, with inertia in a steady state.
    pub from_walls: Option<f64>,
    /// First normal stress difference over viscosity and rate: along the flow less along the gradient, tension positive.
    pub first_normal_difference: f64,
    /// Second one: along the gradient less along the vorticity, in three dimensions.
    pub second_normal_difference: Option<f64>,
    /// Pressure that bodies bear beyond the mean of the fluid's, over viscosity and rate, where the method tells.
    pub particle_pressure: Option<f64>,
    /// Its contact part.
    pub particle_pressure_contact: Option<f64>,
    /// Means over the steady part of a run in time; nothing while it has none.
    pub mean: Option<MeanViscosity>,
    /// Why a run in time has none.
    pub too_short: Option<TooShort>,
}

/// Inertia of fluid and bodies.
#[derive(Debug, Clone, Serialize)]
pub struct InertiaSummary {
    kinetic_energy: f64,
    reynolds: f64,
    stokes: f64,
    /// Thickness of the thinnest layer on a body, in cells, where it is measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    boundary_layer: Option<f64>,
    /// The spacing with which that layer is a cell thick, if it is thinner.
    #[serde(skip_serializing_if = "Option::is_none")]
    resolving_spacing: Option<f64>,
}

/// Where the energy of a run went.
#[derive(Debug, Clone, Serialize)]
pub struct EnergySummary {
    /// Done by forces on free bodies, drive, walls and given motions.
    pub work: f64,
    /// By viscosity.
    pub dissipated: f64,
    /// By films, if lubrication acts.
    pub dissipated_films: Option<f64>,
    /// In contacts.
    pub lost_in_contacts: f64,
    /// Kinetic energy at the end less that at the start.
    pub gained: f64,
    /// What work brought and nothing took: the error of the balance.
    pub unbalanced: f64,
}

/// Films that modes do not see.
#[derive(Debug, Clone, Serialize)]
pub struct LubricationSummary {
    /// Their number.
    films: usize,
    /// Smallest gap, in radii of the smaller body, before roughness; nothing without films.
    smallest_gap: Option<f64>,
    /// Net force or torque of a film on the two bodies, at most, over its force: rounding.
    imbalance: f64,
}

/// Contacts at the end of a run, and how well they were kept on the way.
#[derive(Debug, Clone, Serialize)]
pub struct ContactSummary {
    /// The law of contact.
    pub model: &'static str,
    /// Pairs that the contact model looked at in the last step.
    pub pairs: usize,
    /// Contacts that bear a force.
    pub active: usize,
    /// Smallest gap of all steps, in radii of the smaller body; nothing if no two came near each other.
    pub smallest_gap: Option<f64>,
    /// Largest residual of the optimality conditions of all steps, if velocities were projected.
    pub kkt_residual: Option<f64>,
    /// Sum of all contact forces, those that pull being negative.
    pub total_force: f64,
    /// What contacts remember, if they are gluey.
    pub glue: Option<GlueSummary>,
    /// How well the law of friction was kept, if there is friction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction: Option<FrictionSummary>,
}

/// How well the law of friction was kept in a run.
#[derive(Debug, Clone, Serialize)]
pub struct FrictionSummary {
    /// Largest residual of all steps: the natural map of the exact law, over the largest velocity that contacts would have without forces.
    pub residual: f64,
    /// Steps whose residual was above the tolerance.
    pub steps_above_tolerance: usize,
    /// The tolerance.
    pub tolerance: f64,
}

/// What gluey contacts remember at the end of a run.
#[derive(Debug, Clone, Serialize)]
pub struct GlueSummary {
    /// Contacts that stick.
    pub stuck: usize,
    /// The least memory of them, 0 if there are none.
    pub gamma: f64,
}

/// A run in time.
#[derive(Debug, Clone, Default, Serialize)]
pub struct MotionSummary {
    /// Shortest and longest step.
    pub steps: [f64; 2],
    /// Steps that were longer than the one before.
    pub grown: usize,
    /// Steps that were shorter than the one before.
    pub shrunk: usize,
    /// Times that a step led nowhere and was halved.
    pub halved: usize,
    /// Solves of the flow.
    pub solves: usize,
    /// Their iterations.
    pub iterations: usize,
    /// Wall-clock seconds of all steps.
    pub seconds: f64,
    /// Of these: jump corrections.
    pub assembly_seconds: f64,
    /// Of these: coupled solver.
    pub solve_seconds: f64,
    /// Of these: contacts.
    pub contact_seconds: f64,
    /// Of these: files.
    pub output_seconds: f64,
    /// Contacts that were solved for, summed over the steps.
    pub contacts: usize,
    /// Contacts of the largest island that one rank solved, summed over the steps.
    pub island_contacts: usize,
}

/// Cost and convergence.
#[derive(Debug, Clone, Serialize)]
pub struct SolverSummary {
    /// What inverts the fluid: `hypre` or `transform`.
    pub inverse: &'static str,
    /// A faster inverse that the box allows.
    pub faster: Option<&'static str>,
    /// Unknowns of the grid.
    pub grid_unknowns: usize,
    /// Multipliers of bodies.
    pub multiplier_unknowns: usize,
    /// Meshes that were made, by a method that makes meshes.
    pub meshes: Option<usize>,
    /// Iterations of the coupled solver.
    pub iterations: usize,
    /// Relative residual reached.
    pub residual: f64,
    /// Matrices, hierarchies, flow without bodies.
    pub setup_seconds: f64,
    /// Jump corrections.
    pub assembly_seconds: f64,
    /// Coupled solver.
    pub solve_seconds: f64,
    /// Of the coupled solver: approximate inverse of the fluid.
    pub inverse_seconds: f64,
    /// Of the coupled solver: matrices of the box.
    pub matrix_seconds: f64,
    /// Of the coupled solver: blocks of the bodies.
    pub body_seconds: f64,
    /// Of the coupled solver: the rest, nearly all of it orthogonalisation.
    pub krylov_seconds: f64,
    /// Sum over the ranks.
    pub peak_memory_bytes: f64,
}

impl Summary {
    /// The numbers of an instant of a suspension in flow; collective.
    pub fn of_flow<const D: usize>(
        scene: &Scene,
        suspension: &dyn FlowSolver<D>,
        solution: &Solution<D>,
        viscosity: Option<Viscosity>,
        world: &World,
    ) -> Summary {
        let (setup, grid) = (suspension.setup(), suspension.grid());
        let held = solution.bodies.iter().filter(|body| grid.owner(&setup.domain.wrap(body.center)) == world.rank()).count();
        let bodies = ListedBodies::new(BodySummary::of_flow(setup, solution), solution.bodies.len());
        let parallel = ParallelSummary::new(world, held, grid.local_unknowns(D));
        Summary {
            flow: Some(FlowSummary::new(setup, solution)),
            forces: ForceSummary::of(setup, solution),
            velocities: VelocitySummary::of_flow(scene, setup, solution),
            no_viscosity: viscosity.is_none().then(|| why_no_viscosity(setup).or_else(|| scene.why_nothing_shears())).flatten(),
            viscosity: viscosity.filter(|viscosity| !viscosity.at_rest).map(ViscositySummary::new),
            lubrication: solution.lubrication.as_ref().map(LubricationSummary::new),
            solver: Some(SolverSummary::of_flow(setup, &solution.cost, world)),
            ..Summary::of_bodies(scene, bodies, setup.fraction(), world.size(), parallel)
        }
    }

    /// The numbers of a dry run; collective.
    pub fn of_granular<const D: usize>(scene: &Scene, simulation: &Simulation<D>, world: &World) -> Summary {
        let (state, domain) = (simulation.state(), simulation.domain());
        let volume = |ball: Ball<D>| ball.volume();
        let mut filled = [state.balls(simulation.radii()).into_iter().map(volume).sum::<f64>()];
        state.peers(world).sum(&mut filled);
        let listed = simulation.whole_part(0..state.count().min(MOST_LISTED));
        let bodies = ListedBodies::new(BodySummary::of_granular(domain, listed), state.count());
        let parallel = ParallelSummary::new(world, state.bodies.len(), 0);
        let velocities = VelocitySummary::of_dry(simulation, world);
        Summary { velocities, ..Summary::of_bodies(scene, bodies, filled[0] / domain.volume(), world.size(), parallel) }
    }

    /// Tells the peak of memory anew, after what has been written since; collective.
    pub fn measure_memory(&mut self, world: &World) {
        let all = world.gather(&[peak_memory_bytes()]);
        if let Some(solver) = &mut self.solver {
            solver.peak_memory_bytes = all.iter().sum();
        }
        self.parallel.memory_bytes = Spread::of(all);
    }

    /// Number of bodies.
    pub fn body_count(&self) -> usize {
        self.bodies.len() + self.other_bodies.as_ref().map_or(0, |others| others.count)
    }

    pub(super) fn of_bodies(scene: &Scene, bodies: ListedBodies, fraction: f64, ranks: usize, parallel: ParallelSummary) -> Summary {
        Summary {
            scene: scene.name.clone(),
            title: scene.title.clone(),
            version: env!("CARGO_PKG_VERSION"),
            time: 0.0,
            steps: 0,
            // the sum over no body is a negative zero
            fraction: fraction + 0.0,
            bodies: bodies.listed,
            other_bodies: bodies.others,
            forces: None,
            velocities: None,
            flow: None,
            scalar: None,
            viscosity: None,
            no_viscosity: None,
            quantities: BTreeMap::new(),
            inertia: None,
            energy: None,
            oscillation: None,
            accuracy: None,
            lubrication: None,
            contact: None,
            pairs: None,
            structure_factor: None,
            displacements: None,
            velocity_autocorrelation: None,
            solver: None,
            motion: None,
            ranks,
            parallel,
        }
    }

    /// The numbers of a scalar problem of a scene; collective.
    pub fn of_scalar<const D: usize>(scene: &Scene, solved: &SolvedScalar<D>, world: &World) -> Summary {
        let SolvedScalar { setup, grid, solution, inverse, cost } = *solved;
        let held = solution.inclusions.iter().filter(|inclusion| grid.owner(&inclusion.center) == world.rank()).count();
        Summary {
            scalar: Some(ScalarSummary::new(solved)),
            solver: Some(SolverSummary::of_cost(inverse, cost, world)),
            ..Summary::of_bodies(
                scene,
                ListedBodies::new(std::iter::empty(), 0),
                setup.fraction(),
                world.size(),
                ParallelSummary::new(world, held, grid.local_unknowns(D)),
            )
        }
    }

    /// Attaches bars; `whole` is the root mean square of forces and torques over radius on the bodies whose motion is given, if there are any.
    pub fn attach(&mut self, accuracy: AccuracySummary, whole: Option<f64>) {
        if let (Some(viscosity), Some(error)) = (&mut self.viscosity, accuracy.estimated.viscosity) {
            let bar = error * viscosity.relative.abs();
            viscosity.interval = Some([viscosity.relative - bar, viscosity.relative + bar]);
        }
        let forces = self.forces.as_ref().map(|forces| forces.root_mean_square);
        let summary = |((whole, error), root_mean_square)| DragSummary { root_mean_square, bar: whole * error };
        let drag = whole.zip(accuracy.estimated.drag).zip(forces).map(summary);
        self.accuracy = Some(AccuracySummary { drag, ..accuracy });
    }
}

impl FlowSummary {
    fn new<const D: usize>(setup: &Setup<D>, solution: &Solution<D>) -> FlowSummary {
        let drive = match setup.drive {
            _ if setup.protocol().is_some_and(|protocol| protocol.stresses().is_some()) => "shear-stress",
            Drive::Rest => "none",
            Drive::MeanVelocity(_) => "mean-velocity",
            Drive::PressureGradient(_) => "pressure-gradient",
            Drive::BodyForce(_) => "body-force",
            Drive::Shear(_) => "shear",
        };
        let (size, volume) = (setup.domain.size, setup.domain.volume());
        // nothing flows through walls; the grid's mean is what interpolation makes of that
        let mean_velocity = |axis: usize| if setup.domain.axes[axis].walls().is_some() { 0.0 } else { solution.mean_velocity[axis] };
        FlowSummary {
            drive,
            mean_velocity: (0..D).map(mean_velocity).collect(),
            flow_rate: (0..D).map(|axis| mean_velocity(axis) * volume / size[axis]).collect(),
            pressure_gradient: solution.pressure_gradient.as_slice().to_vec(),
        }
    }
}

impl LubricationSummary {
    fn new<const D: usize>(lubrication: &Lubrication<D>) -> LubricationSummary {
        let Lubrication { films, smallest_gap, imbalance, .. } = *lubrication;
        LubricationSummary { films, smallest_gap: (films > 0).then_some(smallest_gap), imbalance }
    }
}

impl LubricationSummary {
    /// In words.
    pub fn text(&self) -> String {
        let gap = self.smallest_gap.map_or(String::new(), |gap| format!(", smallest gap {gap:.2e} radii"));
        format!("{}{gap}", self.films)
    }
}

impl InertiaSummary {
    /// That of these numbers, and of the thinnest layer on a body in cells of a spacing.
    pub fn new(numbers: InertialNumbers, boundary_layer: Option<f64>, spacing: f64) -> InertiaSummary {
        let InertialNumbers { kinetic_energy, reynolds, stokes, .. } = numbers;
        let resolving_spacing = boundary_layer.filter(|layer| *layer < 1.0).map(|layer| layer * spacing);
        InertiaSummary { kinetic_energy, reynolds, stokes, boundary_layer, resolving_spacing }
    }

    /// In words.
    pub fn text(&self) -> String {
        let layer = match (self.warning(), self.boundary_layer) {
            (Some(warning), _) => format!("; warning: {warning}"),
            (None, Some(layer)) => format!(", thinnest boundary layer {layer:.2} cells"),
            (None, None) => String::new(),
        };
        let moving = [("Reynolds", self.reynolds), ("Stokes", self.stokes)].into_iter().filter(|(_, number)| *number > 0.0);
        let numbers: String = moving.map(|(name, number)| format!("{name} number {number:.4} (fastest body), ")).collect();
        format!("{numbers}kinetic energy {:.4e}{layer}", self.kinetic_energy)
    }

    /// That the grid does not resolve a layer, and what would.
    pub fn warning(&self) -> Option<String> {
        let (layer, spacing) = (self.boundary_layer?, self.resolving_spacing?);
        Some(format!("a boundary layer is {layer:.2} cells thick, choose resolution.spacing = {spacing:.2e} or less to resolve it"))
    }
}

impl EnergySummary {
    /// In words.
    pub fn text(&self) -> String {
        let films = self.dissipated_films.map_or(String::new(), |films| format!(", in lubrication films {films:.4e}"));
        let turned = [self.work, self.dissipated, self.gained].into_iter().fold(0.0, |most: f64, part| most.max(part.abs()));
        let part = if turned > 0.0 { 100.0 * self.unbalanced / turned } else { 0.0 };
        format!(
            "work {:.4e}, dissipated {:.4e}{films}, in contacts {:.4e}, gained {:.4e}, unbalanced {part:.2} %",
            self.work, self.dissipated, self.lost_in_contacts, self.gained
        )
    }
}

impl ViscositySummary {
    fn new(viscosity: Viscosity) -> ViscositySummary {
        ViscositySummary {
            relative: viscosity.relative(),
            parts: viscosity.parts,
            interval: None,
            from_walls: viscosity.from_walls,
            first_normal_difference: viscosity.normal.first,
            second_normal_difference: viscosity.normal.second,
            particle_pressure: viscosity.normal.pressure,
            particle_pressure_contact: viscosity.normal_parts.get(Part::Contact).and_then(|contact| contact.pressure),
            mean: None,
            too_short: None,
        }
    }
}

impl SolverSummary {
    fn of_flow<const D: usize>(setup: &Setup<D>, cost: &Cost, world: &World) -> SolverSummary {
        let faster = setup.faster_inverse().map(InverseMethod::word);
        SolverSummary { faster, ..SolverSummary::of_cost(setup.inverse_word(), cost, world) }
    }

    /// What a solve with this inverse cost; collective.
    pub(super) fn of_cost(inverse: &'static str, cost: &Cost, world: &World) -> SolverSummary {
        let mut memory = [peak_memory_bytes()];
        world.sum(&mut memory);
        let slowest = |seconds: f64| world.max(seconds);
        let stages = cost.stages;
        SolverSummary {
            inverse,
            faster: None,
            grid_unknowns: cost.grid_unknowns,
            multiplier_unknowns: cost.multiplier_unknowns,
            meshes: Some(cost.meshes).filter(|&made| made > 0),
            iterations: cost.krylov.iterations,
            residual: cost.krylov.residual,
            setup_seconds: slowest(cost.setup),
            assembly_seconds: slowest(cost.assembly),
            solve_seconds: slowest(cost.krylov.seconds),
            inverse_seconds: slowest(stages.inverse),
            matrix_seconds: slowest(stages.matrices),
            body_seconds: slowest(stages.bodies),
            krylov_seconds: slowest(cost.krylov.seconds - stages.inverse - stages.matrices - stages.bodies),
            peak_memory_bytes: memory[0],
        }
    }
}
