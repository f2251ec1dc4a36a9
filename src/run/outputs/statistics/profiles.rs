//! `profiles.csv` and `profiles.svg`: profiles across axes, over the frames of a run in its steady part, or of an instant.
//!
//! The slices of each frame go to `profile-frames.csv` as they come, which a run that goes on continues.

use std::{
    fs,
    path::{Path, PathBuf},
};

use nalgebra::SVector;

use super::configurations::steady_from;
use crate::run::outputs::cell::{Cell, count, finite, real};
use crate::run::outputs::context::{Context, Wanted, boxed};
use crate::run::outputs::frames::frame_due;
use crate::run::outputs::step_table::StepTable;
use crate::{
    contact::{Contact, bodies_of, renamed},
    error::{Error, Result},
    flow::Drive,
    geometry::{Ball, Domain},
    grid::operators::signed,
    observe::{CellCenters, ProfileBody, ProfileContact, ProfileSums, Shear, SliceSample, Slices, inside},
    output::{AXES, ProfileFrames, Summary, row_numbers, write_whole},
    parallel::World,
    run::{FlowView, MotionView, Output, View},
    scene::{ContactModel, Scene},
    setup::ContactHistory,
};

/// The file with the slices of each frame.
const FRAMES: &str = "profile-frames.csv";

/// Measures profiles.
pub struct ProfileFiles {
    folder: PathBuf,
    /// The slices of each frame, on the first rank.
    table: Option<StepTable>,
    axes: Vec<usize>,
    every: f64,
    /// Whether frames have a particle stress.
    stress: bool,
}

/// With `output.profiles`. Collective.
///
/// # Errors
/// As [`ProfileFiles::open`].
pub fn wanted<const D: usize>(context: &Context<D>) -> Wanted<D> {
    if context.scene.output.profiles.is_empty() {
        return Ok(None);
    }
    Ok(Some(boxed(ProfileFiles::open(context.world, context.scene, context.folder, context.time())?)))
}

impl ProfileFiles {
    /// Opens them, without what was measured from a time on. Collective.
    ///
    /// # Errors
    /// What a run that goes on has measured cannot be read or written.
    fn open(world: &World, scene: &Scene, folder: &Path, time: f64) -> Result<ProfileFiles> {
        let (table, _) = StepTable::open_before(world, &folder.join(FRAMES), time)?;
        let stress = !scene.dry() || scene.contact.model != ContactModel::None;
        Ok(ProfileFiles { folder: folder.to_owned(), table, axes: scene.output.profiles.clone(), every: scene.frame_interval(), stress })
    }

    /// The slices across each axis, on every rank. Collective.
    fn measure<const D: usize>(&self, view: &View<D>) -> Result<Vec<(Slices<D>, Vec<SliceSample>)>> {
        let found = Bodies::of(view);
        let cells = view.flow.map(|flow| fluid_cells(&flow, &found)).transpose()?;
        let measured = self.axes.iter().map(|&axis| {
            let grid = view.flow.map(|flow| flow.solver.grid().cells()[axis]);
            let slices = Slices::new(&found.room(view), axis, found.mean_radius(view), grid, found.jump);
            let mut sums = ProfileSums::new(slices.clone());
            found.bodies.iter().for_each(|body| sums.add_body(body));
            found.contacts.iter().for_each(|contact| sums.add_contact(contact));
            cells.iter().flatten().for_each(|(point, velocity)| sums.add_fluid(point, velocity));
            if let Some(motion) = view.motion {
                motion.state().peers(view.world).sum(&mut sums.solid);
            }
            view.world.sum(&mut sums.fluid);
            (slices, sums.samples(self.stress))
        });
        Ok(measured.collect())
    }

    /// Adds the slices of a frame to the file. On the first rank.
    fn store<const D: usize>(&mut self, time: f64, measured: &[(Slices<D>, Vec<SliceSample>)]) -> Result<()> {
        let names = sample_names::<D>(self.stress);
        let row = |slices: &Slices<D>, slice: usize, sample: &SliceSample| {
            let SliceSample { fraction, particles, fluid, stress } = sample;
            let numbers = std::iter::once(fraction).chain(particles).chain(fluid).chain(stress);
            let place = [real("time", time), count("axis", slices.axis), real("position", slices.middle(slice))];
            place.into_iter().chain(names.iter().zip(numbers).map(|(name, &number)| finite(name.clone(), number))).collect::<Vec<Cell>>()
        };
        let slices = measured.iter().flat_map(|(slices, samples)| (0..).zip(samples).map(move |(slice, sample)| (slices, slice, sample)));
        let rows: Vec<Vec<Cell>> = slices.map(|(slices, slice, sample)| row(slices, slice, sample)).collect();
        self.table.as_mut().map_or(Ok(()), |table| table.write_rows(&rows))
    }

    /// Frames from a time on, axis by axis.
    fn read<const D: usize>(&self, begin: f64) -> Result<Vec<ProfileFrames>> {
        let path = self.folder.join(FRAMES);
        let text = fs::read_to_string(&path).map_err(|source| Error::File { path, source })?;
        let mut all: Vec<ProfileFrames> =
            self.axes.iter().map(|&axis| ProfileFrames { axis, places: Vec::new(), frames: Vec::new() }).collect();
        let mut last = vec![f64::NAN; self.axes.len()];
        for line in text.lines().skip(1) {
            let cells: Vec<f64> = row_numbers(line).collect();
            let Some(number) = self.axes.iter().position(|&axis| axis as f64 == cells[1]).filter(|_| cells[0] >= begin) else { continue };
            let own = &mut all[number];
            if cells[0] != last[number] {
                own.frames.push(Vec::new());
                last[number] = cells[0];
            }
            if own.frames.len() == 1 {
                own.places.push(cells[2]);
            }
            let (particles, rest) = cells[4..].split_at(D);
            let (fluid, stress) = rest.split_at(D);
            let sample = SliceSample { fraction: cells[3], particles: particles.to_vec(), fluid: fluid.to_vec(), stress: stress.to_vec() };
            own.frames.last_mut().expect("a frame was begun").push(sample);
        }
        Ok(all)
    }
}

impl<const D: usize> Output<D> for ProfileFiles {
    fn write(&mut self, view: &View<D>) -> Result<()> {
        let Some(motion) = view.motion.filter(|motion| frame_due(motion, self.every)) else { return Ok(()) };
        let measured = self.measure(view)?;
        view.world.on_first_rank(|| self.store(motion.state().time, &measured))
    }

    fn finish(&mut self, view: &View<D>, _: &mut Summary) -> Result<Vec<String>> {
        let setup = view.flow.map(|flow| flow.solver.setup());
        let begin = match view.motion {
            Some(motion) => {
                let shear = setup.and_then(|setup| Shear::of(&setup.domain, &setup.drive));
                steady_from(view.world, shear.as_ref(), motion.state().time, view.history.mean())
            }
            None => {
                let measured = self.measure(view)?;
                view.world.on_first_rank(|| self.store(0.0, &measured))?;
                0.0
            }
        };
        let title = view.scene.shown_title();
        view.world.on_first_rank(|| {
            let frames = self.read::<D>(begin)?;
            write_whole(&self.folder.join("profiles.csv"), ProfileFrames::csv(&frames).as_bytes())?;
            write_whole(&self.folder.join("profiles.svg"), ProfileFrames::svg(title, &frames).as_bytes())
        })?;
        Ok([FRAMES, "profiles.csv", "profiles.svg"].map(str::to_owned).to_vec())
    }
}

/// Bodies and contacts that this rank tells of.
struct Bodies<const D: usize> {
    domain: Domain<D>,
    jump: SVector<f64, D>,
    bodies: Vec<ProfileBody<D>>,
    contacts: Vec<ProfileContact<D>>,
}

impl<const D: usize> Bodies<D> {
    /// The box that is cut into slices: where a wall moves along its normal, that of the start, so that a slice stays in its place.
    fn room(&self, view: &View<D>) -> Domain<D> {
        let mut room = self.domain.clone();
        if view.motion.is_some_and(|motion| motion.state().wall.is_some()) {
            room.size = SVector::from_column_slice(&view.scene.domain.size);
        }
        room
    }

    /// Those of an instant. Collective.
    fn of(view: &View<D>) -> Bodies<D> {
        let setup = view.flow.map(|flow| flow.solver.setup());
        let domain = match (view.motion, setup) {
            (Some(motion), _) => motion.domain().clone(),
            (None, setup) => setup.expect("an instant is one of a flow").domain.clone(),
        };
        let jump = match setup.map(|setup| setup.drive) {
            Some(Drive::Shear(rate)) => SVector::from_fn(|axis, _| if axis == 0 { rate * domain.size[1] } else { 0.0 }),
            _ => domain.sliding(),
        };
        let stresslet = |place: usize| view.flow.map_or_else(nalgebra::SMatrix::zeros, |flow| flow.solution.bodies[place].stresslet);
        let bodies = match (view.motion, view.flow) {
            (Some(motion), _) => {
                let balls = motion.state().balls(motion.simulation.radii()).into_iter().zip(&motion.observation.twists).enumerate();
                let body = |(place, (ball, twist)): (usize, (Ball<D>, &crate::body::Twist<D>))| ProfileBody {
                    ball,
                    velocity: twist.velocity,
                    spin: twist.spin,
                    stresslet: stresslet(place),
                };
                balls.map(body).collect()
            }
            (None, Some(flow)) => {
                let radii = flow.solver.setup().bodies.iter().map(|own| own.body.ball.radius);
                let body = |(state, radius): (&crate::system::BodyState<D>, f64)| ProfileBody {
                    ball: Ball { center: state.center, radius },
                    velocity: state.twist.velocity,
                    spin: state.twist.spin,
                    stresslet: state.stresslet,
                };
                flow.solution.bodies.iter().zip(radii).map(body).collect()
            }
            (None, None) => Vec::new(),
        };
        let contacts = view.motion.map_or(Vec::new(), |motion| contacts(&motion, &domain));
        Bodies { domain, jump, bodies, contacts }
    }

    /// The mean radius of the bodies of all ranks; nothing without any. Collective.
    fn mean_radius(&self, view: &View<D>) -> Option<f64> {
        let mut sums = [self.bodies.iter().map(|body| body.ball.radius).sum::<f64>(), self.bodies.len() as f64];
        if let Some(motion) = view.motion {
            motion.state().peers(view.world).sum(&mut sums);
        }
        (sums[1] > 0.0).then(|| sums[0] / sums[1])
    }
}

/// Contacts that bear a force and are this rank's to tell. Collective.
fn contacts<const D: usize>(motion: &MotionView<D>, domain: &Domain<D>) -> Vec<ProfileContact<D>> {
    let history = motion.contact_history();
    let own = || history.iter().filter(|contact| motion.state().reports(contact.body));
    let (halo, balls) = motion.simulation.halo_of(own().flat_map(|contact| bodies_of(contact.identity())));
    let place = |number: usize| halo.place(number).expect("bodies of contacts are seen");
    let contact = |history: &ContactHistory<D>| {
        let Contact { body, normal, separation, .. } = Contact::again(domain, &balls, renamed(history.identity(), place));
        ProfileContact { from: balls[body].center, normal, separation, force: normal * history.force + history.tangential }
    };
    own().map(contact).collect()
}

/// Centres and velocities of the cells of this rank that no body holds. Collective.
fn fluid_cells<const D: usize>(flow: &FlowView<D>, bodies: &Bodies<D>) -> Result<Vec<(SVector<f64, D>, SVector<f64, D>)>> {
    let (grid, setup, fluid) = (flow.solver.grid(), flow.solver.setup(), &flow.solution.fluid);
    let velocities = CellCenters::new(grid, fluid)?.velocity(fluid)?;
    let held = inside(grid, &bodies.bodies.iter().map(|body| body.ball).collect::<Vec<_>>());
    let cells = grid.block(D).indices().zip(velocities).zip(held).filter(|(_, held)| *held == 0.0);
    Ok(cells
        .map(|((cell, velocity), _)| {
            let point = grid.upright_center(signed(cell));
            (point, velocity + setup.drive.background(&point))
        })
        .collect())
}

/// Names of the numbers of a slice.
fn sample_names<const D: usize>(stress: bool) -> Vec<String> {
    let axes = &AXES[..D];
    let mut names = vec!["fraction".to_owned()];
    names.extend(axes.iter().map(|axis| format!("particle_velocity_{axis}")));
    names.extend(axes.iter().map(|axis| format!("fluid_velocity_{axis}")));
    if stress {
        names.extend(axes.iter().flat_map(|row| axes.iter().map(move |column| format!("particle_stress_{row}{column}"))));
    }
    names
}
