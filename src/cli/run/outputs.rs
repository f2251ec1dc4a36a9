//! What a run in time writes on its way: rows, frames, checkpoints.

use std::{
    collections::BTreeMap,
    io::{Write, stderr},
    path::PathBuf,
    time::Instant,
};

use super::{account::Account, folder::RunFolder};
use crate::{
    contact::{Contact, Identity, Partner, Solver},
    error::Result,
    geometry::{Ball, Domain},
    observe::{self, CellCenters, FrameBody, Viscosity},
    output::{
        self, CHECKPOINT, ContactNumbers, CurvePoint, Frame, FrameContact, FrameFields, Frames, MeanViscosity, ProjectionNumbers, Row, Rows,
    },
    parallel::World,
    petsc::{Stage, enter},
    scene::{ContactModel, Scene, Until},
    simulation::{Effort, Held, Simulation, State, StepReport, View},
};

/// Rounding of a time that is a multiple of the time between frames.
const ROUNDING: f64 = 1e-9;

/// How much wider than wanted an interval is at most before steps that may end the run: these start from a checkpoint.
const ABOUT: f64 = 1.25;

/// The open outputs of a run.
pub struct Outputs<const D: usize> {
    folder: PathBuf,
    texts: Vec<(&'static str, String)>,
    /// On the first rank.
    rows: Option<Rows>,
    frames: Frames,
    every: f64,
    /// Whether the scene asks for frames more often than steps come, and nobody was told yet.
    eager: bool,
    /// Present if frames hold fields; made anew where images slide.
    centers: Option<CellCenters<D>>,
    contact: ContactModel,
    checkpoint_pace: f64,
    until: Option<Until>,
    /// Mean viscosity so far; on the first rank.
    mean: Option<MeanViscosity>,
    /// Whether what ends a run early has come; on all ranks.
    satisfied: bool,
    last_checkpoint: Instant,
    last_row: Instant,
}

impl<const D: usize> Outputs<D> {
    /// Opens them for what comes from the state of the simulation on.
    ///
    /// # Errors
    /// Files of the run so far cannot be read or written.
    pub fn open(world: &World, scene: &Scene, folder: &RunFolder, simulation: &Simulation<D>) -> Result<Outputs<D>> {
        let (steps, time) = (simulation.state().steps, simulation.state().time);
        let rows = world.agree(if world.rank() == 0 { Rows::open(folder.path(), steps).map(Some) } else { Ok(None) })?;
        let (frames, lost) = match steps {
            0 => (Frames::create(world, folder.path())?, Vec::new()),
            _ => Frames::resume(world, folder.path(), time.next_down())?,
        };
        let (rows, lost_rows) = rows.map_or((None, None), |(rows, lost)| (Some(rows), lost));
        lost.iter().chain(&lost_rows).for_each(|lost| tell(lost));
        let centers = match simulation.suspension() {
            Some(suspension) if scene.output.fields => Some(CellCenters::new(suspension.grid(), &suspension.fluid_vector()?)?),
            _ => None,
        };
        Ok(Outputs {
            folder: folder.path().to_owned(),
            texts: folder.texts(scene)?,
            frames,
            every: scene.frame_interval(),
            eager: scene.output.every.is_some() && world.rank() == 0,
            centers,
            contact: scene.contact.model,
            checkpoint_pace: scene.output.checkpoint,
            until: scene.time.as_ref().and_then(|time| time.until),
            mean: MeanViscosity::of(rows.as_ref().map_or(&[], Rows::curve)),
            rows,
            satisfied: false,
            last_checkpoint: Instant::now(),
            last_row: Instant::now(),
        })
    }

    /// Writes what is due of an instant; `last` is the step that led there. Returns the seconds spent. Collective.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(
        &mut self,
        world: &World,
        simulation: &Simulation<D>,
        (view, last): (&View<D>, Option<&StepReport>),
        viscosity: Option<Viscosity>,
    ) -> Result<f64> {
        let (_stage, start) = (enter(Stage::Output), Instant::now());
        let row = self.row(simulation.state(), (view, last), viscosity);
        world.agree(self.rows.as_mut().map_or(Ok(()), |rows| rows.write(&row)))?;
        // only a step that started from a checkpoint may be the last: the run can then be resumed
        let near = self.nearly(ABOUT);
        self.mean = MeanViscosity::of(self.curve());
        if self.until.is_some() {
            self.satisfied = world.max(f64::from(near && self.nearly(1.0))) > 0.0;
        }
        self.tell_of_long_steps(simulation.state());
        if self.frame_is_due(simulation) {
            self.write_frame(world, simulation, view)?;
        }
        Ok(start.elapsed().as_secs_f64())
    }

    /// Writes a checkpoint if its pace or the run asks for one. Returns the seconds spent. Collective.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn checkpoint(&mut self, world: &World, simulation: &Simulation<D>, (account, asked): (&Account, bool)) -> Result<f64> {
        let due = asked || self.last_checkpoint.elapsed().as_secs_f64() >= self.checkpoint_pace;
        let due = due || simulation.may_end() || self.nearly(ABOUT);
        let due = world.max(f64::from(due)) > 0.0;
        let (_stage, start) = (enter(Stage::Output), Instant::now());
        if due && simulation.on_the_way() && simulation.state().steps > 0 {
            output::store(world, &self.folder.join(CHECKPOINT), (&self.texts, &account.numbers()), simulation)?;
            self.last_checkpoint = Instant::now();
        }
        Ok(start.elapsed().as_secs_f64())
    }

    /// Makes sure at the end that all that was written is there. Collective.
    ///
    /// # Errors
    /// Rows have gone; that frames have is told.
    pub fn finish(&mut self, world: &World) -> Result<()> {
        world.agree(self.rows.as_ref().map_or(Ok(()), Rows::refuse_change))?;
        self.frames.finish(world)?.iter().for_each(|lost| tell(lost));
        Ok(())
    }

    /// The viscosity so far; on the first rank.
    pub fn curve(&self) -> &[CurvePoint] {
        self.rows.as_ref().map_or(&[], Rows::curve)
    }

    /// The mean viscosity so far, once there is one; on the first rank.
    pub fn mean(&self) -> Option<&MeanViscosity> {
        self.mean.as_ref()
    }

    /// Whether the viscosity is known as well as the scene asks for, and the run may end.
    pub fn satisfied(&self) -> bool {
        self.satisfied
    }

    /// Whether the viscosity is known but for a factor; on the first rank.
    fn nearly(&self, factor: f64) -> bool {
        let (Some(until), Some(mean)) = (self.until, &self.mean) else { return false };
        let [from, to] = mean.strains;
        factor * (to - from) >= until.strain && mean.half_width() <= factor * until.viscosity_interval * mean.relative.abs()
    }

    fn row(&mut self, state: &State<D>, (view, last): (&View<D>, Option<&StepReport>), viscosity: Option<Viscosity>) -> Row {
        let certificate = last.and_then(|report| report.certificate);
        let projected = matches!(self.contact, ContactModel::Inelastic | ContactModel::Gluey { .. });
        let projection = ProjectionNumbers {
            kkt_residual: certificate.map_or(0.0, |certificate| certificate.kkt_residual),
            total_force: certificate.map_or(0.0, |certificate| certificate.total_force),
            iterations: certificate.map_or(0, |certificate| certificate.iterations),
            solver: certificate.map_or(Solver::Formula, |certificate| certificate.solver),
        };
        let contact = (self.contact != ContactModel::None).then(|| ContactNumbers {
            active: held(state, view).len(),
            stuck: gluey(self.contact).then_some(state.stuck.len()),
            smallest_gap: certificate.map_or(f64::INFINITY, |certificate| certificate.smallest_gap),
            projection: projected.then_some(projection),
        });
        let seconds = std::mem::replace(&mut self.last_row, Instant::now()).elapsed().as_secs_f64();
        Row {
            step: state.steps,
            time: state.time,
            last_step: state.last_step,
            viscosity,
            contact,
            flow: view.solution.is_some(),
            effort: view.effort + last.map_or(Effort::default(), |report| report.effort),
            seconds,
        }
    }

    /// The first instant, the last one, and the first one after each multiple of the time between frames.
    fn frame_is_due(&self, simulation: &Simulation<D>) -> bool {
        let state = simulation.state();
        let number = |time: f64| (time / self.every + ROUNDING).floor();
        state.steps == 0 || simulation.over() || self.satisfied || number(state.time) > number(state.time - state.last_step)
    }

    /// Says once that frames cannot come as often as the scene asks for.
    fn tell_of_long_steps(&mut self, state: &State<D>) {
        let (every, step) = (self.every, state.last_step);
        if self.eager && step > every * (1.0 + ROUNDING) {
            self.eager = false;
            tell(&format!(
                "output.every = {every}: the step to time {} is {step} long, and frames come no more often than steps; \
                 shorten them by time.step or time.travel for more",
                state.time
            ));
        }
    }

    fn write_frame(&mut self, world: &World, simulation: &Simulation<D>, view: &View<D>) -> Result<()> {
        let (state, domain) = (simulation.state(), simulation.domain());
        let balls = state.balls(simulation.radii());
        let bodies = frame_bodies(state, simulation.radii(), view);
        let contacts = network((state, view), (domain, &balls), gluey(self.contact));
        let contacts = (self.contact != ContactModel::None).then_some(&contacts[..]);
        let fields = match (&mut self.centers, &view.solution, simulation.suspension()) {
            (Some(centers), Some(solution), Some(suspension)) => {
                let (grid, setup) = (suspension.grid(), suspension.setup());
                if domain.slide().is_some() {
                    *centers = CellCenters::new(grid, &solution.fluid)?;
                }
                let mut velocity = centers.velocity(&solution.fluid)?;
                for (index, velocity) in grid.block(D).indices().zip(&mut velocity) {
                    *velocity += setup.drive.background(&grid.position(D, crate::grid::operators::signed(index)));
                }
                let pressure = &solution.fluid.local()?[grid.local_range(D)];
                let pressure = pressure.iter().map(|pressure| pressure * setup.viscosity).collect();
                Some(FrameFields { grid, velocity, pressure, inside: observe::inside(grid, &balls) })
            }
            _ => None,
        };
        self.frames.write(world, &Frame { time: state.time, step: state.steps, domain, bodies: &bodies, contacts, fields })
    }
}

/// Says what the user did not ask for; that nobody listens is no reason to stop.
fn tell(text: &str) {
    let _ = writeln!(stderr(), "turbid: {text}");
}

/// Contacts that bear a force: of this instant in a flow, of the last step in a dry run.
pub fn held<const D: usize>(state: &State<D>, view: &View<D>) -> Vec<Held<D>> {
    match view.solution {
        Some(_) => view.contacts.iter().filter(|pressed| pressed.force != 0.0).map(Held::of).collect(),
        None => state.held.clone(),
    }
}

fn gluey(contact: ContactModel) -> bool {
    matches!(contact, ContactModel::Gluey { .. })
}

/// Contacts that bear a force or stick, as frames hold them.
fn network<const D: usize>(
    (state, view): (&State<D>, &View<D>),
    (domain, balls): (&Domain<D>, &[Ball<D>]),
    gluey: bool,
) -> Vec<FrameContact<D>> {
    let mut all: BTreeMap<Identity<D>, (f64, f64)> = held(state, view).iter().map(|held| (held.identity(), (held.force, 0.0))).collect();
    state.stuck.iter().for_each(|stuck| all.entry(stuck.identity()).or_default().1 = stuck.gamma);
    let contact = |(identity, (force, gamma)): (Identity<D>, (f64, f64))| {
        FrameContact::of(&Contact::again(domain, balls, identity), balls, (force, gluey.then_some(gamma)))
    };
    all.into_iter().map(contact).collect()
}

/// The bodies as frames hold them.
pub fn frame_bodies<const D: usize>(state: &State<D>, radii: &[f64], view: &View<D>) -> Vec<FrameBody<D>> {
    let balls = state.balls(radii);
    let mut contacts = vec![0; balls.len()];
    for held in held(state, view) {
        contacts[held.body] += 1;
        if let Partner::Body(partner) = held.partner {
            contacts[partner] += 1;
        }
    }
    let body = |(number, ball): (usize, &Ball<D>)| {
        let by_fluid = view.solution.as_ref().map(|solution| &solution.bodies[number]);
        FrameBody {
            center: ball.center,
            radius: ball.radius,
            velocity: view.twists[number].velocity,
            spin: view.twists[number].spin,
            rotation: state.bodies[number].rotation,
            force: by_fluid.map_or_else(nalgebra::SVector::zeros, |state| state.force),
            torque: by_fluid.map_or_else(nalgebra::SMatrix::zeros, |state| state.torque),
            contacts: contacts[number],
        }
    };
    balls.iter().enumerate().map(body).collect()
}
