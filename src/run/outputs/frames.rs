//! Frames of a run in time: the first instant, the last one, and the first one after each multiple of the time between frames.

use std::{
    borrow::Cow,
    ops::Range,
    path::{Path, PathBuf},
};

use nalgebra::SVector;

use super::context::{Context, Wanted, boxed};
use super::fields::FlowFields;
use super::log::add_to_log_local;
use crate::{
    contact::{Contact, Identity, bodies_of, renamed},
    error::{Error, Result},
    grid::Grid,
    linalg::ROUNDING,
    motion::Simulation,
    output::{Frame, FrameBond, FrameContact, FrameCorner, FrameFace, FrameMembranes, Frames, Summary, note},
    parallel::World,
    petsc::Vector,
    run::{MotionView, Output, View},
    scene::{ContactModel, Scene},
    setup::State,
};

/// Files that show the frames.
pub const INDICES: [&str; 8] =
    ["run.h5", "bodies.xdmf", "contacts.xdmf", "bonds.xdmf", "membranes.xdmf", "fields.xdmf", "bodies.vtkhdf", "fields.vtkhdf"];

/// The frames of a run.
pub struct FrameFiles<const D: usize> {
    folder: PathBuf,
    frames: Frames,
    every: f64,
    /// Whether the scene asks for frames at certain times, and nobody was told yet that they come later.
    eager: bool,
    /// Present if frames hold fields.
    fields: Option<FlowFields<D>>,
    contact: ContactModel,
}

/// Of every run in time. Collective.
///
/// # Errors
/// As [`FrameFiles::open`].
pub fn wanted<const D: usize>(context: &Context<D>) -> Wanted<D> {
    let Some(simulation) = context.simulation else { return Ok(None) };
    Ok(Some(boxed(FrameFiles::open(context.world, context.scene, context.folder, simulation)?)))
}

impl<const D: usize> FrameFiles<D> {
    /// Opens them for what comes from the state of the simulation on. Collective.
    ///
    /// # Errors
    /// Frames of the run so far cannot be read or removed.
    fn open(world: &World, scene: &Scene, folder: &Path, simulation: &Simulation<D>) -> Result<FrameFiles<D>> {
        let frames = match simulation.state().steps {
            0 => Frames::create(world, folder, scene.output.vtkhdf)?,
            _ => {
                let (frames, lost) = Frames::resume(world, folder, simulation.state().time.next_down(), scene.output.vtkhdf)?;
                lost.iter().for_each(|lost| note(&format!("turbid: {lost}")));
                frames
            }
        };
        let suspension = simulation.suspension().filter(|_| scene.stores_fields());
        let fluid = |grid: &Grid<D>| Vector::new(simulation.session(), grid.local_fluid_unknowns());
        let fields = suspension.map(|flow| FlowFields::new(scene, flow.grid(), &fluid(flow.grid())?)).transpose()?;
        let (folder, eager) = (folder.to_owned(), scene.output.every.is_some() && world.rank() == 0);
        Ok(FrameFiles { folder, frames, every: scene.frame_interval(), eager, fields, contact: scene.contact.model })
    }

    /// Says once in the log that frames come later than the scene asks for: with the first step that reaches a multiple of its time between frames.
    fn tell_of_steps(&mut self, state: &State<D>, whole_cells: bool) {
        let (every, time) = (self.every, state.time);
        let late = time - (time / every + ROUNDING).floor() * every;
        if !self.eager || state.steps == 0 || late <= ROUNDING.max(1e-6) * every {
            return;
        }
        self.eager = false;
        let why =
            if whole_cells { "; steps of this sheared box are whole numbers of the time in which its images slide by a cell" } else { "" };
        let often = if state.last_step > every * (1.0 + ROUNDING) { " and no more often than steps" } else { "" };
        let text = format!(
            "output.every = {every}: frames come with the first step at or after each multiple of it{often}, this one at time {time} instead of {}{why}; a \
             time.step that divides output.every keeps it exactly, shorter steps more nearly",
            time - late
        );
        add_to_log_local(&self.folder, &text);
    }
}

/// Whether a frame is due, of frames that are so far apart.
pub fn frame_due<const D: usize>(motion: &MotionView<D>, every: f64) -> bool {
    let state = motion.state();
    let number = |time: f64| (time / every + ROUNDING).floor();
    state.steps == 0 || motion.last || number(state.time) > number(state.time - state.last_step)
}

impl<const D: usize> Output<D> for FrameFiles<D> {
    fn write(&mut self, view: &View<D>) -> Result<()> {
        let Some(motion) = view.motion else { return Ok(()) };
        if !frame_due(&motion, self.every) {
            return Ok(());
        }
        if !motion.last {
            let whole_cells = view.flow.is_some_and(|flow| !flow.solver.grid().may_be_oblique());
            self.tell_of_steps(motion.state(), motion.domain().slide().is_some() && whole_cells);
        }
        let state = motion.state();
        let written = state.written(view.world);
        let contacts = (self.contact != ContactModel::None).then(|| network(&motion, self.contact.gluey(), &written));
        let ties = WrittenTies::of(&motion, &written);
        let (bonds, membranes) = (ties.as_ref().map(WrittenTies::bonds), ties.as_ref().and_then(WrittenTies::membranes));
        let bodies = motion.bodies(written.clone());
        let balls = || state.balls(motion.simulation.radii());
        let fields = match (&mut self.fields, view.flow) {
            (Some(fields), Some(flow)) => Some(fields.of(flow, motion.domain(), &balls())?),
            _ => None,
        };
        let contacts = contacts.as_deref();
        let (time, step, domain, bonds, membranes) = (state.time, state.steps, motion.domain(), bonds.as_deref(), membranes.as_ref());
        self.frames.write(view.world, &Frame { time, step, domain, bodies: &bodies, contacts, bonds, membranes, fields })
    }

    fn interrupted(&mut self, _: &Error) {
        // what went wrong before is what matters
        let _ = self.frames.settle_local();
    }

    fn finish(&mut self, view: &View<D>, _: &mut Summary) -> Result<Vec<String>> {
        self.frames.finish(view.world)?.iter().for_each(|lost| note(&format!("turbid: {lost}")));
        Ok(INDICES.into_iter().filter(|name| self.folder.join(name).exists()).map(str::to_owned).collect())
    }
}

/// Contacts that bear a force or stick, of those that this rank writes of, as frames hold them. Collective.
fn network<const D: usize>(motion: &MotionView<D>, gluey: bool, written: &Range<usize>) -> Vec<FrameContact<D>> {
    let (state, domain, history) = (motion.state(), motion.domain(), motion.contact_history());
    let friction = motion.simulation.interactions().friction().is_some();
    let active = history.iter().map(|contact| (contact.identity(), contact.force, 0.0, contact.tangential));
    let adhesive = state.adhesive_contacts.iter().map(|contact| (contact.identity(), 0.0, contact.gamma, SVector::zeros()));
    let mut all: Vec<(Identity<D>, f64, f64, SVector<f64, D>)> =
        active.chain(adhesive).filter(|((body, ..), ..)| writes(motion, written, *body)).collect();
    all.sort_by_key(|&(identity, ..)| identity);
    // a contact that bears a force and sticks
    all.dedup_by(|(again, force, gamma, _), (identity, of_both, memory, _)| {
        let same = again == identity;
        if same {
            (*of_both, *memory) = (*of_both + *force, *memory + *gamma);
        }
        same
    });
    let (halo, balls) = motion.simulation.halo_of(all.iter().flat_map(|(identity, ..)| bodies_of(*identity)));
    let place = |number: usize| halo.place(number).expect("bodies of contacts are seen");
    let contact = |(identity, force, gamma, tangential): (Identity<D>, f64, f64, SVector<f64, D>)| {
        let placed = Contact::again(domain, &balls, renamed(identity, place));
        let (body, partner, _) = identity;
        FrameContact {
            body,
            partner,
            gamma: gluey.then_some(gamma),
            friction: friction.then_some(tangential),
            ..FrameContact::of(&placed, &balls, force)
        }
    };
    all.into_iter().map(contact).collect()
}

/// What ties bodies, with the places of all of them.
struct WrittenTies<'a, const D: usize> {
    motion: &'a MotionView<'a, D>,
    written: &'a Range<usize>,
    whole: Cow<'a, State<D>>,
    /// Of each body the number of its chain, cell or cluster.
    chain_of: Vec<Option<usize>>,
}

impl<'a, const D: usize> WrittenTies<'a, D> {
    /// Nothing without any. Collective.
    fn of(motion: &'a MotionView<'a, D>, written: &'a Range<usize>) -> Option<WrittenTies<'a, D>> {
        let interactions = motion.simulation.interactions();
        let tied = !interactions.bonds().is_empty();
        tied.then(|| WrittenTies { motion, written, whole: motion.simulation.whole_state(), chain_of: interactions.group_of() })
    }

    fn center(&self, body: usize) -> SVector<f64, D> {
        self.whole.bodies[body].center
    }

    fn chain(&self, body: usize) -> usize {
        self.chain_of[body].expect("what is tied belongs to a chain")
    }

    /// Bonds of chains, cells and clusters of which this rank writes the first body.
    fn bonds(&self) -> Vec<FrameBond<D>> {
        let mut pairs = self.motion.simulation.interactions().bonds();
        pairs.retain(|[one, _]| writes(self.motion, self.written, *one));
        pairs.sort_unstable();
        let bond = |bodies: [usize; 2]| FrameBond {
            bodies,
            chain: self.chain(bodies[0]),
            from: self.center(bodies[0]),
            way: self.motion.domain().nearest_image(self.center(bodies[1]) - self.center(bodies[0])),
        };
        pairs.into_iter().map(bond).collect()
    }

    /// Membranes of cells, of which this rank writes the bodies that it writes and the faces of cells whose first body it writes; nothing
    /// without any.
    fn membranes(&self) -> Option<FrameMembranes<D>> {
        let mut cells = self.motion.simulation.interactions().conserved();
        // of a cell in space volume and surface have the same triangles
        cells.dedup_by(|one, other| one.bodies == other.bodies);
        let (mut corners, mut faces, mut place) = (Vec::new(), Vec::new(), 0);
        for cell in &cells {
            let first = cell.bodies.start;
            let into_box = self.motion.domain().wrap(self.center(first)) - self.center(first);
            let corner = |body: usize| FrameCorner { body, chain: self.chain(body), point: self.center(body) + into_box };
            corners.extend(cell.bodies.clone().filter(|body| writes(self.motion, self.written, *body)).map(corner));
            if writes(self.motion, self.written, first) {
                let face = |face: Vec<usize>| FrameFace { first, corners: face.into_iter().map(|corner| place + corner).collect() };
                faces.extend(cell.measure.faces(cell.bodies.len()).into_iter().map(face));
            }
            place += cell.bodies.len();
        }
        (!cells.is_empty()).then_some(FrameMembranes { corners, faces })
    }
}

/// Whether this rank writes a body.
fn writes<const D: usize>(motion: &MotionView<D>, written: &Range<usize>, body: usize) -> bool {
    motion.state().place(body).is_some_and(|place| written.contains(&place))
}
