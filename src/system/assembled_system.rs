//! One configuration of a suspension, ready to be solved.

use std::time::Instant;

use super::{
    assembly::Assembly,
    bodies::Bodies,
    coupled::{Coupled, Operator, SystemParts},
    extrapolation::InitialGuess,
    fixed_operators::FixedOperators,
    krylov_workspace::{KrylovWorkspace, Stop},
    pair_constraints::PairConstraints,
    pair_resistance::{belongs, pair_constraints},
    schur_complement::SchurComplement,
    surfaces::{BodyOperator, SurfaceOperators},
    uzawa::uzawa,
};
use crate::{
    error::Result,
    flow::StokesInverse,
    linalg::CANCELLATION,
    petsc::{Krylov, Report, Session, Stage, Vector, enter},
    scene::{ConstraintMethod, MultiplierSolver},
    setup::Configuration,
    system::{
        ExtrapolationHistory, ResidualMonitor,
        work::{Sizes, SolvedUnknowns},
    },
};

/// All that the solve of one configuration needs.
pub struct AssembledSystem<'a, const D: usize> {
    pub bodies: Bodies<'a, D>,
    pub operators: Vec<BodyOperator>,
    pub assembly: Assembly<D>,
    pub pair_constraints: PairConstraints,
    pub workspace: KrylovWorkspace,
    pub guess: Option<InitialGuess<D>>,
    prescribed_drag: f64,
    stop: Stop,
}

impl<'a, const D: usize> AssembledSystem<'a, D> {
    /// Puts bodies in their places and fills right-hand side and start; what is at hand is used again where it fits.
    pub fn new(
        fixed: &'a FixedOperators<D>,
        assembly: Option<Assembly<D>>,
        workspace: Option<KrylovWorkspace>,
        past: Option<&ExtrapolationHistory<D>>,
        configuration: &Configuration<D>,
    ) -> Result<Self> {
        let _stage = enter(Stage::Assembly);
        let assembly = Assembly::of(fixed, configuration.centers, assembly)?;
        let (placed, neighbourhood) = (assembly.placed.clone(), assembly.neighbourhood.clone());
        let bodies = Bodies::new(&fixed.setup, &fixed.grid, &fixed.body_types, placed, neighbourhood, assembly.layout.clone());
        let operators = bodies.operators(&assembly.blocks, &assembly.damping);
        let mut guess = past.map_or(Ok(None), |past| past.guess(&bodies, configuration.centers, configuration.time))?;
        if let Some(fluid) = guess.as_mut().and_then(|guess| guess.extrapolated.fluid.as_mut())
            && fixed.stokes.shift() > 0.0
        {
            // no row of a fully periodic box sees a mean velocity, which bodies with inertia do not follow
            fixed.stokes.project(fluid)?;
        }
        let mean_flow = fixed.mean_flow.unknowns::<D>();
        let places = workspace.as_ref().map_or(0, |workspace| workspace.work.sizes().constraints);
        let pair_constraints =
            pair_constraints(fixed, &bodies, configuration, &assembly.films, &assembly.undisturbed, assembly.medium.as_ref(), places)?;
        let fluid = if fixed.condensed { 0 } else { fixed.grid.local_fluid_unknowns() };
        let sizes = Sizes { fluid, multipliers: assembly.undisturbed.len(), mean_flow, constraints: pair_constraints.places() };
        let mut workspace = KrylovWorkspace::fitting(workspace, fixed, sizes)?;
        workspace.krylov.set_tolerance(configuration.tolerance);
        let prescribed_drag = prescribed_drag(&fixed.session, &operators);
        let wanted = bodies.wanted_rows(&assembly.blocks, &operators, &assembly.undisturbed, configuration.pushes);
        fixed.fill_right_hand_side(&wanted, pair_constraints.wanted(), prescribed_drag, &mut workspace.rhs)?;
        let rounding = CANCELLATION * scale(&fixed.session, &assembly.undisturbed, &workspace.rhs)?;
        let unit = pair_constraints.scale * fixed.setup.viscosity;
        let contacts = configuration.contacts.iter().zip(configuration.contact_guess).filter(|(row, _)| belongs(&bodies.layout, row));
        workspace.start(&bodies, guess.as_ref(), contacts.map(|(_, force)| force / unit).collect())?;
        let stop = Stop { tolerance: configuration.tolerance, rounding };
        Ok(AssembledSystem { bodies, operators, assembly, pair_constraints, workspace, guess, prescribed_drag, stop })
    }

    /// The solver with its right-hand side and start, and what the system is made of.
    pub fn parts<'b>(
        &'b mut self,
        fixed: &'b FixedOperators<D>,
        inverse: &'b mut dyn StokesInverse<D>,
    ) -> (Solver<'b>, SystemParts<'b, D>) {
        let surfaces = SurfaceOperators {
            world: fixed.session.world(),
            blocks: &mut self.assembly.blocks,
            pairs: self.assembly.pairs.as_mut(),
            operators: &self.operators,
            mean_flow: &fixed.mean_flow,
            pair_constraints: &mut self.pair_constraints,
            pairs_exert_torques: fixed.setup.inertia.is_some() && fixed.setup.interactions.turn(),
            prescribed_drag: self.prescribed_drag,
        };
        let KrylovWorkspace { krylov, work, rhs, x } = &mut self.workspace;
        (Solver { krylov, rhs, x }, SystemParts { stokes: &fixed.stokes, inverse, surfaces, work })
    }

    /// Solves; the velocities that are found include those of the flow without bodies.
    pub fn solve(
        &mut self,
        fixed: &FixedOperators<D>,
        inverse: &mut dyn StokesInverse<D>,
        monitor: ResidualMonitor,
    ) -> Result<(Report, SolvedUnknowns)> {
        let _stage = enter(Stage::Orthogonalisation);
        let stop = self.stop;
        let (Solver { krylov, rhs, x }, parts) = self.parts(fixed, inverse);
        let (report, mut found) = match fixed.setup.constraint {
            ConstraintMethod::MeanValue(MultiplierSolver::Uzawa(step)) => {
                solve(rhs, x, SchurComplement::new(parts), |system, rhs, x| uzawa(system, rhs, x, step, stop, monitor))
            }
            _ if fixed.condensed => {
                solve(rhs, x, SchurComplement::new(parts), |system, rhs, x| krylov.solve_above(stop.rounding, system, rhs, x, monitor))
            }
            _ => solve(rhs, x, Coupled(parts), |system, rhs, x| krylov.solve_above(stop.rounding, system, rhs, x, monitor)),
        }?;
        found.velocities.iter_mut().zip(&self.assembly.undisturbed).for_each(|(velocity, undisturbed)| *velocity += undisturbed);
        Ok((report, found))
    }
}

/// What solves.
pub struct Solver<'a> {
    /// The method.
    pub krylov: &'a mut Krylov,
    /// The right-hand side.
    pub rhs: &'a Vector,
    /// Where it starts, and what it finds.
    pub x: &'a mut Vector,
}

fn solve<S: Operator>(
    rhs: &Vector,
    x: &mut Vector,
    mut system: S,
    by: impl FnOnce(&mut S, &Vector, &mut Vector) -> Result<Report>,
) -> Result<(Report, SolvedUnknowns)> {
    let start = Instant::now();
    let report = by(&mut system, rhs, x)?;
    let found = system.unknowns(x)?;
    Ok((Report { seconds: start.elapsed().as_secs_f64(), ..report }, found))
}

/// Norm of the velocities that a right-hand side is the difference of.
fn scale(session: &Session, undisturbed: &[f64], rhs: &Vector) -> Result<f64> {
    let mut square = [undisturbed.iter().map(|velocity| velocity * velocity).sum()];
    session.world().sum(&mut square);
    Ok(square[0].sqrt().max(rhs.norm()?))
}

/// Sum over all prescribed bodies of the net force that a unit velocity takes by their preconditioner.
fn prescribed_drag(session: &Session, operators: &[BodyOperator]) -> f64 {
    let mut drag = [operators.iter().filter(|member| !member.free).map(|member| member.area * member.inverse.diagonal(0)).sum()];
    session.world().sum(&mut drag);
    if drag[0] > 0.0 { drag[0] } else { 1.0 }
}
