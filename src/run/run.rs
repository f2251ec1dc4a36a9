//! A run: evaluate, write, step, until the end or a signal; or one solve at an instant.

use std::time::Instant;

use super::{
    calibration::{self, Calibrated, RefinementSequence, Solved, refine_whole_runs},
    column::SeriesEntry,
    finished::Finished,
    folder::RunFolder,
    motion_view::MotionView,
    options::Options,
    output::{BeforeStep, Output},
    outputs::{self, outputs},
    progress::{Progress, TimeProgress},
    quantities::quantities,
    quantity::Quantity,
    scalar,
    signals::Signals,
    statistics::RunStatistics,
    summary::{summary, table_of_bodies},
    view::{FlowView, View},
    viscosity::ViscosityHistory,
};
use crate::{
    error::{Error, Result},
    linalg::ROUNDING,
    mechanics::FlowSolver,
    motion::{Observation, Simulation},
    observe::{self, Viscosity},
    output::{Checkpoint, CurvePoint, MotionSummary, Summary, note, write_whole},
    parallel::World,
    petsc::{Session, Stage, enter},
    plan::flow_solver,
    scene::{FlowModel, Scene},
    setup::{Setup, State},
    system::Solution,
};

/// How much wider than wanted an interval is at most before steps that may end the run: these start from a checkpoint.
const ABOUT: f64 = 1.25;

/// A run of a scene of dimension `D`, but for a scalar one. Every function is collective.
pub struct Run<'a, const D: usize> {
    world: &'a World,
    scene: Scene,
    folder: Option<RunFolder<'a>>,
    calibrated: Option<Calibrated>,
    machinery: Machinery<D>,
    outputs: Vec<Box<dyn Output<D>>>,
    statistics: RunStatistics,
    history: ViscosityHistory,
    viscosity: Option<Viscosity>,
    quantities: Vec<Quantity<D>>,
    row: Vec<SeriesEntry>,
    signals: Option<Signals>,
    /// Whether what there is to see of the state was evaluated.
    evaluated: bool,
}

/// What solves.
enum Machinery<const D: usize> {
    /// A flow at an instant, and its solution once there is one.
    Instant { solver: Box<dyn FlowSolver<D>>, solution: Option<Solution<D>> },
    /// A simulation in time, and what happens in its state once it was evaluated.
    InTime { simulation: Box<Simulation<D>>, observation: Option<Observation<D>> },
}

/// Runs a scene of dimension `D` from its start to its end; without a folder it leaves nothing behind. Collective.
///
/// # Errors
/// As [`Run::start`] and [`Run::advance`].
pub fn complete<const D: usize>(session: &Session, scene: &Scene, folder: Option<RunFolder>, options: Options) -> Result<Finished> {
    match scene.scalar() {
        true => scalar::run::<D>(session, scene, folder, options),
        false => Run::<D>::start(session, scene, folder, options)?.complete(),
    }
}

impl<'a, const D: usize> Run<'a, D> {
    /// Builds what a scene calls for; without a folder it leaves nothing behind.
    ///
    /// # Errors
    /// Bodies, grid, rank count or dimension do not fit, the accuracy cannot be met, or the folder is in use.
    pub fn start(session: &'a Session, scene: &Scene, folder: Option<RunFolder<'a>>, options: Options) -> Result<Run<'a, D>> {
        Run::build(session, scene, folder, None, options)
    }

    /// Goes on with the run of a folder, whose scene and checkpoint [`RunFolder::read`] gives.
    ///
    /// # Errors
    /// As [`start`](Run::start); the checkpoint does not fit.
    pub fn resume(
        session: &'a Session,
        scene: &Scene,
        folder: RunFolder<'a>,
        checkpoint: &Checkpoint,
        options: Options,
    ) -> Result<Run<'a, D>> {
        Run::build(session, scene, Some(folder), Some(checkpoint), options)
    }

    fn build(
        session: &'a Session,
        scene: &Scene,
        mut folder: Option<RunFolder<'a>>,
        checkpoint: Option<&Checkpoint>,
        options: Options,
    ) -> Result<Run<'a, D>> {
        let world = session.world();
        refuse_dimension::<D>(scene)?;
        let (calibrated, solved) = match scene.accuracy {
            Some(_) => calibrate(session, scene, &mut folder, checkpoint.is_none())?,
            None => (None, None),
        };
        let signals = if options.signals && scene.time.is_some() { Some(Signals::listen()?) } else { None };
        let resolved = calibrated.as_ref().map_or_else(|| scene.clone(), |calibrated| calibrated.calibration.resolved(scene));
        let mut machinery = Machinery::new(session, &resolved, solved)?;
        let statistics = machinery.restored(world, scene, checkpoint)?;
        if let (Some(signals), Machinery::InTime { simulation, .. }) = (&signals, &mut machinery) {
            simulation.heed(signals.stop_request());
        }
        let mut run = Run {
            world,
            scene: scene.clone(),
            folder,
            calibrated,
            machinery,
            outputs: Vec::new(),
            statistics,
            history: ViscosityHistory::default(),
            viscosity: None,
            quantities: quantities(),
            row: Vec::new(),
            signals,
            evaluated: false,
        };
        run.open(options)?;
        Ok(run)
    }

    /// Opens what the run writes.
    fn open(&mut self, options: Options) -> Result<()> {
        let (world, scene, simulation) = (self.world, &self.scene, self.machinery.simulation());
        let mut points = Vec::new();
        if let Some(folder) = &mut self.folder {
            folder.claim(scene)?;
            (self.outputs, points) = outputs(world, scene, folder.path(), folder.texts(scene)?, simulation)?;
        }
        if options.progress {
            let line: Box<dyn Output<D>> = match &self.machinery {
                Machinery::Instant { solver, .. } => Box::new(Progress::new(world.rank(), solver.setup().tolerance.at_an_instant())),
                Machinery::InTime { simulation, .. } => Box::new(TimeProgress::new(world.rank(), simulation.state().time, scene.end())),
            };
            self.outputs.insert(0, line);
        }
        let missed = simulation.and_then(|simulation| simulation.missed_end(scene.end()));
        missed.iter().filter(|_| world.rank() == 0).for_each(|missed| note(&format!("turbid: {missed}")));
        self.history = ViscosityHistory::new(scene.time.as_ref().and_then(|time| time.until), points);
        Ok(())
    }

    /// Adds an output, which writes after the others.
    pub fn add(&mut self, output: Box<dyn Output<D>>) {
        self.outputs.push(output);
    }

    /// Adds a quantity, which is measured at each instant: it gets columns in `series.csv` and entries in the summary, as those of the program have.
    /// To be called before the first [`advance`](Run::advance).
    ///
    /// # Errors
    /// Another quantity has its name, or it is no name of a column.
    pub fn measure(&mut self, quantity: Quantity<D>) -> Result<()> {
        quantity.check(&self.quantities)?;
        self.quantities.push(quantity);
        Ok(())
    }

    /// Takes a step, unless this is the first call, evaluates the state and writes what is due; whether the run goes on from there.
    ///
    /// # Errors
    /// A solver does not converge, contacts cannot be kept, a file cannot be written, or a signal came ([`Error::Stopped`]).
    pub fn advance(&mut self) -> Result<bool> {
        let outcome = self.step_on();
        let outcome = self.keep_island(outcome);
        if let Err(error) = &outcome {
            self.outputs.iter_mut().for_each(|output| output.interrupted(error));
        }
        outcome
    }

    fn step_on(&mut self) -> Result<bool> {
        if self.evaluated {
            if self.ended() {
                return Ok(false);
            }
            self.step()?;
        }
        self.evaluate()?;
        Ok(!self.ended())
    }

    /// Goes on to the end.
    ///
    /// # Errors
    /// As [`advance`](Run::advance).
    pub fn complete(mut self) -> Result<Finished> {
        while self.advance()? {}
        self.finish()
    }

    /// Where bodies are, in a run in time.
    pub fn state(&self) -> Option<&State<D>> {
        self.machinery.simulation().map(Simulation::state)
    }

    /// The flow that was evaluated last, if there is one.
    pub fn solution(&self) -> Option<&Solution<D>> {
        self.machinery.flow().map(|flow| flow.solution)
    }

    /// The viscosity of what was evaluated last, in a sheared suspension.
    pub fn viscosity(&self) -> Option<&Viscosity> {
        self.viscosity.as_ref()
    }

    /// What was measured of what was evaluated last, a number for each column.
    pub fn row(&self) -> &[SeriesEntry] {
        &self.row
    }

    /// The viscosity over time.
    pub fn history(&self) -> &ViscosityHistory {
        &self.history
    }

    /// What the steps cost and kept.
    pub fn statistics(&self) -> &RunStatistics {
        &self.statistics
    }

    fn evaluate(&mut self) -> Result<()> {
        let asked = self.signals.as_ref().is_some_and(Signals::take_checkpoint);
        self.keep(asked)?;
        let outputs = &mut self.outputs;
        let evaluated =
            self.machinery.evaluate(&mut |iteration, residual| outputs.iter_mut().for_each(|output| output.iterate(iteration, residual)));
        self.or_stop(evaluated)?;
        self.viscosity = self.machinery.viscosity()?;
        self.evaluated = true;
        self.timed(|run| {
            if let Machinery::InTime { simulation, .. } = &run.machinery {
                let of_all_times = run.viscosity.filter(|_| run.scene.changing_shear().is_none());
                let point = of_all_times
                    .map(|viscosity| CurvePoint::of(&viscosity, simulation.domain().strain(viscosity.rate, simulation.state().time)));
                run.history.add(run.world, point, ABOUT);
            }
            run.row = run.measured()?;
            run.tell(|output, view| output.write(view))
        })
    }

    fn ended(&self) -> bool {
        self.machinery.simulation().is_none_or(Simulation::over) || self.history.satisfied()
    }

    fn step(&mut self) -> Result<()> {
        let Machinery::InTime { simulation, observation } = &mut self.machinery else { return Ok(()) };
        let observation = observation.take().expect("a state is evaluated before its step");
        self.evaluated = false;
        let stepped = simulation.step(&observation, &mut |_, _| {});
        let report = self.or_stop(stepped)?;
        self.statistics.add(&observation, &report);
        let stop = self.signals.as_ref().is_some_and(Signals::stop);
        if self.signals.is_some() && self.world.max(f64::from(stop)) > 0.0 {
            return self.stop();
        }
        Ok(())
    }

    /// Ends as after a step where long work was stopped.
    fn or_stop<T>(&mut self, outcome: Result<T>) -> Result<T> {
        if matches!(outcome, Err(Error::Stopped { .. })) {
            self.stop()?;
        }
        outcome
    }

    fn stop(&mut self) -> Result<()> {
        self.keep(true)?;
        let folder = self.folder.as_ref().map(|folder| folder.path().to_owned());
        Err(Error::Stopped { time: self.state().map_or(0.0, |state| state.time), folder })
    }

    /// Lets a checkpoint be written if it is due.
    fn keep(&mut self, asked: bool) -> Result<()> {
        self.timed(|run| {
            let Machinery::InTime { simulation, .. } = &run.machinery else { return Ok(()) };
            let due = asked || simulation.may_end() || run.history.nearly(ABOUT);
            let before = BeforeStep { world: run.world, simulation, statistics: &run.statistics, due };
            run.outputs.iter_mut().try_for_each(|output| output.keep(&before))
        })
    }

    /// Does what counts as output.
    fn timed(&mut self, write: impl FnOnce(&mut Self) -> Result<()>) -> Result<()> {
        let (_stage, start) = (enter(Stage::Output), Instant::now());
        write(self)?;
        self.statistics.add_output(start.elapsed().as_secs_f64());
        Ok(())
    }

    /// Tells every output of what is seen.
    fn tell(&mut self, mut tell: impl FnMut(&mut dyn Output<D>, &View<D>) -> Result<()>) -> Result<()> {
        let mut outputs = std::mem::take(&mut self.outputs);
        let view = self.view();
        let outcome = outputs.iter_mut().try_for_each(|output| tell(output.as_mut(), &view));
        self.outputs = outputs;
        outcome
    }

    fn view(&self) -> View<'_, D> {
        let mut view = View::new(self.world, &self.scene, &self.history);
        (view.flow, view.viscosity, view.row) = (self.machinery.flow(), self.viscosity, &self.row);
        if let Machinery::InTime { simulation, observation: Some(observation) } = &self.machinery {
            view.motion = Some(MotionView { simulation, observation, statistics: &self.statistics, last: self.ended() });
        }
        view
    }

    /// All quantities of what was evaluated.
    fn measured(&self) -> Result<Vec<SeriesEntry>> {
        let view = self.view();
        let measured = self.quantities.iter().map(|quantity| quantity.measure(&view)).collect::<Result<Vec<_>>>()?;
        Ok(measured.into_iter().flatten().collect())
    }

    /// The numbers of what was evaluated last, or of the start.
    ///
    /// # Errors
    /// As [`advance`](Run::advance).
    pub fn summary(&mut self) -> Result<Summary> {
        if !self.evaluated {
            self.evaluate()?;
        }
        let mut summary = summary(&self.view());
        if let (Some(calibrated), Some(flow)) = (&self.calibrated, self.machinery.flow()) {
            calibrated.attach(&mut summary, flow.solver, flow.solution)?;
        }
        Ok(summary)
    }

    /// Writes what is due at the end.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn finish(mut self) -> Result<Finished> {
        let mut summary = self.summary()?;
        let _stage = enter(Stage::Output);
        let mut files = Vec::new();
        if self.folder.is_some() && self.scene.time.is_none() {
            files.push("scene.toml".to_owned());
            files.extend(self.calibrated.as_ref().map(|_| calibration::FILE.to_owned()));
        }
        summary.motion = self.motion();
        self.tell(|output, view| {
            files.extend(output.finish(view, &mut summary)?);
            // a picture may take more than the run
            summary.measure_memory(view.world);
            Ok(())
        })?;
        if let Some(folder) = &self.folder {
            files.extend(table_of_bodies(&self.view(), &summary, folder.path())?);
        }
        // with the seconds of what was written since
        summary.motion = self.motion();
        if let Some(folder) = &self.folder {
            files.extend(folder.complete(&summary)?);
        }
        let folder = self.folder.as_ref().map(|folder| folder.path().to_owned());
        Ok(Finished { summary, curve: self.history.points().to_vec(), folder, files })
    }

    /// What the steps and the last look cost, in a run in time.
    fn motion(&self) -> Option<MotionSummary> {
        match &self.machinery {
            Machinery::InTime { observation: Some(last), .. } => Some(self.statistics.motion_to(last)),
            _ => None,
        }
    }

    /// Writes the island that was not solved beside the other files, and says so.
    fn keep_island(&self, outcome: Result<bool>) -> Result<bool> {
        match (outcome, &self.folder) {
            (Err(Error::Contact { text, island, step }), Some(folder)) => {
                let path = folder.path().join("contact-island.json");
                self.world.on_first_rank(|| write_whole(&path, island.as_bytes()))?;
                Err(Error::Contact { text: format!("{text}; the problem is in {}", path.display()), island, step })
            }
            (outcome, _) => outcome,
        }
    }
}

impl<const D: usize> Machinery<D> {
    /// Goes on from a checkpoint, if there is one; what was counted until then.
    fn restored(&mut self, world: &World, scene: &Scene, checkpoint: Option<&Checkpoint>) -> Result<RunStatistics> {
        match (checkpoint, self) {
            (Some(checkpoint), Machinery::InTime { simulation, .. }) => {
                let statistics = outputs::restore(world, checkpoint, simulation)?;
                refuse_the_past(scene, simulation.state().time)?;
                Ok(statistics)
            }
            _ => Ok(RunStatistics::new()),
        }
    }

    /// For a scene that says how fine it is, or what a calibration has solved last.
    fn new(session: &Session, resolved: &Scene, solved: Option<Solved<D>>) -> Result<Machinery<D>> {
        match (&resolved.time, solved) {
            (Some(_), solved) => {
                drop(solved);
                Ok(Machinery::InTime { simulation: Box::new(Simulation::new(session, resolved)?), observation: None })
            }
            (None, Some((suspension, solution))) => Ok(Machinery::Instant { solver: Box::new(suspension), solution: Some(solution) }),
            (None, None) => {
                let setup = session.world().agree(Setup::<D>::on(session.world().into(), resolved))?;
                Ok(Machinery::Instant { solver: flow_solver(session, setup)?, solution: None })
            }
        }
    }

    fn evaluate(&mut self, monitor: &mut dyn FnMut(usize, f64)) -> Result<()> {
        match self {
            Machinery::Instant { solution: Some(_), .. } => {}
            Machinery::Instant { solver, solution } => *solution = Some(solver.solve(monitor)?),
            Machinery::InTime { simulation, observation } => *observation = Some(simulation.evaluate(&mut |_, _| {})?),
        }
        Ok(())
    }

    fn simulation(&self) -> Option<&Simulation<D>> {
        match self {
            Machinery::Instant { .. } => None,
            Machinery::InTime { simulation, .. } => Some(simulation),
        }
    }

    fn flow(&self) -> Option<FlowView<'_, D>> {
        match self {
            Machinery::Instant { solver, solution } => Some(FlowView { solver: solver.as_ref(), solution: solution.as_ref()? }),
            Machinery::InTime { simulation, observation } => {
                Some(FlowView { solver: simulation.suspension()?, solution: observation.as_ref()?.solution.as_ref()? })
            }
        }
    }

    fn viscosity(&self) -> Result<Option<Viscosity>> {
        let Some(flow) = self.flow() else { return Ok(None) };
        let contacts = match self {
            Machinery::InTime { observation: Some(observation), .. } => &observation.contacts[..],
            _ => &[],
        };
        observe::viscosity(flow.solver.setup(), flow.solver.grid(), flow.solution, contacts)
    }
}

fn refuse_dimension<const D: usize>(scene: &Scene) -> Result<()> {
    if scene.dimension() == D && !scene.scalar() {
        return Ok(());
    }
    Err(scene.refuse("domain.size", format!("{:?}", scene.domain.size), &format!("is not that of a flow or of bodies in {D}D")))
}

/// The setting that meets a scene's accuracy, and the last solution if it is found now.
fn calibrate<const D: usize>(
    session: &Session,
    scene: &Scene,
    folder: &mut Option<RunFolder>,
    from_start: bool,
) -> Result<(Option<Calibrated>, Option<Solved<D>>)> {
    let world = session.world();
    let path = folder.as_ref().map(|folder| folder.path().to_owned());
    if let Some(calibration) = path.as_deref().and_then(|path| calibration::cached(world, path, scene, !from_start)) {
        return Ok((Some(Calibrated { calibration, cached: true }), None));
    }
    let inertia = scene.flow.model == FlowModel::NavierStokes;
    let sequence = if inertia { None } else { Some(RefinementSequence::<D>::begin(session, scene)?) };
    if let (Some(folder), true) = (folder, from_start) {
        folder.claim(scene)?;
    }
    let (calibration, solved) = match sequence {
        Some(sequence) => sequence.refine_until_met().map(|(calibration, solved)| (calibration, Some(solved)))?,
        None => (refine_whole_runs::<D>(session, scene)?, None),
    };
    let calibrated = Calibrated { calibration, cached: false };
    if let Some(path) = path {
        calibrated.keep(world, &path, scene)?;
    }
    Ok((Some(calibrated), solved))
}

/// A run that goes on cannot end before it does.
fn refuse_the_past(scene: &Scene, time: f64) -> Result<()> {
    if scene.end() >= time * (1.0 - ROUNDING) {
        return Ok(());
    }
    let remedy = format!("the checkpoint is at time {time}; set a later end, or start anew in another folder");
    Err(scene.refuse("time.end", scene.end(), &remedy))
}
