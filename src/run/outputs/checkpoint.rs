//! What a checkpoint holds of a simulation: its state, and what the solver starts from, so that a resumed run repeats
//! what the run would have done to the last digit on the same ranks.

use std::{
    collections::HashMap,
    path::{Path, PathBuf},
    time::Instant,
};

use nalgebra::{SMatrix, SVector, Vector2};

use super::context::{Context, Wanted};
use crate::{
    body::{Twist, components, planes, skew},
    contact::{AdhesiveContact, Identity, pack, packed_length, unpack},
    error::{Error, Offer, Refusal, Result},
    fitted::PlaneTwist,
    grid::Grid,
    interaction::Wrench,
    mechanics::{FlowSolver, History, HistoryView, MeshLevel},
    motion::Simulation,
    output::{CHECKPOINT, Checkpoint, CheckpointWriter},
    parallel::World,
    petsc::{Session, Vector},
    run::{BeforeStep, Output, RunStatistics},
    setup::{ContactHistory, FoundShear, Moving, Share, State, WallMotion},
    system::{ExtrapolationHistory, Level, Snapshot},
};

/// Names of the arrays of a solution.
const SNAPSHOTS: [&str; 2] = ["last", "earlier"];

/// Names of the solutions from which a step of a flow with inertia starts.
const LEVELS: [&str; 3] = ["level", "level_before", "first_level"];

/// The name of the statistics.
const STATISTICS: &str = "statistics";

/// The checkpoint of a run.
pub struct CheckpointFile {
    path: PathBuf,
    /// Texts by name, such as that of the scene.
    texts: Vec<(&'static str, String)>,
    /// Seconds between checkpoints.
    interval: f64,
    last: Instant,
}

/// Of every run in time.
pub fn wanted<const D: usize>(context: &Context<D>) -> Wanted<D> {
    context.when(true, |context| CheckpointFile::new(context.folder, context.texts.to_vec(), context.scene.output.checkpoint))
}

impl CheckpointFile {
    /// None yet.
    fn new(folder: &Path, texts: Vec<(&'static str, String)>, interval: f64) -> CheckpointFile {
        CheckpointFile { path: folder.join(CHECKPOINT), texts, interval, last: Instant::now() }
    }

    /// Writes it; if that fails, an older one is untouched.
    fn store<const D: usize>(&self, before: &BeforeStep<D>) -> Result<()> {
        let (world, simulation) = (before.world, before.simulation);
        let mut writer = CheckpointWriter::create(world, &self.path)?;
        self.texts.iter().try_for_each(|(name, text)| writer.text(name, text))?;
        // seconds differ from rank to rank
        writer.text(STATISTICS, &world.broadcast(0, &before.statistics.text()))?;
        store_state(&mut writer, world, simulation)?;
        if let Some(suspension) = simulation.suspension() {
            store_history(&mut writer, suspension.grid(), &suspension.history(simulation.state().time))?;
        }
        writer.finish()
    }
}

impl<const D: usize> Output<D> for CheckpointFile {
    fn keep(&mut self, before: &BeforeStep<D>) -> Result<()> {
        let due = before.due || self.last.elapsed().as_secs_f64() >= self.interval;
        let due = before.world.max(f64::from(due)) > 0.0;
        if due && before.simulation.on_the_way() {
            self.store(before)?;
            self.last = Instant::now();
        }
        Ok(())
    }
}

/// Brings a simulation to the state of a checkpoint and returns the statistics of the run. Collective.
///
/// # Errors
/// [`Error::Refused`] when the checkpoint cannot be used.
pub fn restore<const D: usize>(world: &World, checkpoint: &Checkpoint, simulation: &mut Simulation<D>) -> Result<RunStatistics> {
    let statistics = RunStatistics::read(&checkpoint.text(STATISTICS)?)?;
    let mut state = read_state(world, checkpoint, simulation.state().count())?;
    if simulation.domain().protocol().is_some_and(|protocol| protocol.stresses().is_some()) {
        let [strain, rate] = checkpoint.shared("shear")?[..] else { return Err(misfit("shear")) };
        state.shear = FoundShear { strain, rate };
    }
    if let Some(wall) = simulation.state().wall {
        let numbers = checkpoint.shared("wall")?;
        let (&[position, velocity], force) =
            numbers.split_first_chunk().filter(|(_, force)| force.len() == D).ok_or_else(|| misfit("wall"))?;
        state.wall = Some(WallMotion { position, velocity, force: SVector::from_column_slice(force), ..wall });
    }
    let read = |suspension| read_history(checkpoint, simulation.session(), suspension, state.steps);
    let history = simulation.suspension().map(read).transpose()?;
    simulation.restore(state, history.unwrap_or_default())?;
    Ok(statistics)
}

fn store_history<const D: usize>(writer: &mut CheckpointWriter, grid: &Grid<D>, history: &HistoryView<D>) -> Result<()> {
    store_past(writer, grid, history.past)?;
    LEVELS.into_iter().zip(&history.levels).try_for_each(|(name, level)| store_level(writer, grid, name, level))?;
    LEVELS.into_iter().zip(&history.mesh_levels).try_for_each(|(name, level)| store_mesh_level(writer, name, level))
}

/// The history of a solver after so many steps.
fn read_history<const D: usize>(
    checkpoint: &Checkpoint,
    session: &Session,
    suspension: &dyn FlowSolver<D>,
    steps: usize,
) -> Result<History<D>> {
    let (shape, grid) = (suspension.history(0.0).shape, suspension.grid());
    let fluid = || Vector::new(session, grid.local_fluid_unknowns());
    let (names, bodies) = (|most: usize| LEVELS[..steps.min(most)].iter(), suspension.setup().bodies.len());
    Ok(History {
        past: read_past(checkpoint, grid, shape.fluid.then(fluid).transpose()?.as_ref())?,
        levels: names(shape.levels).map(|name| read_level(checkpoint, grid, fluid()?, &shape.multipliers, name)).collect::<Result<_>>()?,
        mesh_levels: names(shape.mesh_levels).map(|name| read_mesh_level(checkpoint, bodies, name)).collect::<Result<_>>()?,
    })
}

fn store_mesh_level(writer: &mut CheckpointWriter, name: &str, level: &MeshLevel) -> Result<()> {
    let MeshLevel { time, centers, motions, nodes, velocities } = level;
    let motions: Vec<f64> = motions.iter().flat_map(|rigid| [rigid.velocity.x, rigid.velocity.y, rigid.spin]).collect();
    writer.shared(&format!("{name}_time"), &[*time])?;
    writer.shared(&format!("{name}_centers"), &flat(centers))?;
    writer.shared(&format!("{name}_motions"), &motions)?;
    writer.shared(&format!("{name}_nodes"), &flat(nodes))?;
    writer.shared(&format!("{name}_velocities"), &flat(velocities))
}

fn read_mesh_level(checkpoint: &Checkpoint, bodies: usize, name: &str) -> Result<MeshLevel> {
    let vectors = |what: &str| -> Result<Vec<Vector2<f64>>> {
        Ok(checkpoint.shared(&format!("{name}_{what}"))?.chunks_exact(2).map(Vector2::from_column_slice).collect())
    };
    let motion = |numbers: &[f64]| PlaneTwist { velocity: Vector2::new(numbers[0], numbers[1]), spin: numbers[2] };
    let motions: Vec<PlaneTwist> = checkpoint.shared(&format!("{name}_motions"))?.chunks_exact(3).map(motion).collect();
    let &[time] = &checkpoint.shared(&format!("{name}_time"))?[..] else { return Err(misfit("time")) };
    let level = MeshLevel { time, centers: vectors("centers")?, motions, nodes: vectors("nodes")?, velocities: vectors("velocities")? };
    let fits = level.centers.len() == bodies && level.motions.len() == bodies && level.velocities.len() == level.nodes.len();
    if fits { Ok(level) } else { Err(misfit("velocities")) }
}

fn store_level<const D: usize>(writer: &mut CheckpointWriter, grid: &Grid<D>, name: &str, level: &Level<D>) -> Result<()> {
    store_fluid(writer, grid, name, &level.fluid)?;
    writer.shared(&format!("{name}_time"), &[level.time])?;
    writer.shared(&format!("{name}_multipliers"), &level.multipliers.concat())?;
    writer.shared(&format!("{name}_smooth"), &level.smooth.concat())?;
    writer.shared(&format!("{name}_slow"), &level.slow.concat())?;
    writer.shared(&format!("{name}_lagging"), &level.lagging.concat())?;
    writer.shared(&format!("{name}_centers"), &flat(&level.centers))?;
    let twists: Vec<f64> = level.twists.iter().flat_map(|twist| [twist.velocity.as_slice(), &components(&twist.spin)].concat()).collect();
    writer.shared(&format!("{name}_twists"), &twists)?;
    writer.shared(&format!("{name}_spin_ups"), &level.spin_ups.concat())?;
    let impulses: Vec<f64> =
        level.impulses.iter().flat_map(|impulse| [impulse.force.as_slice(), &components(&impulse.torque)].concat()).collect();
    writer.shared(&format!("{name}_impulses"), &impulses)?;
    writer.shared(&format!("{name}_resolved"), &[level.resolved])
}

fn read_level<const D: usize>(
    checkpoint: &Checkpoint,
    grid: &Grid<D>,
    mut fluid: Vector,
    multipliers: &[usize],
    name: &str,
) -> Result<Level<D>> {
    read_fluid(checkpoint, grid, name, &mut fluid)?;
    let bodies = multipliers.len();
    let numbers = |what: &str, width: usize| {
        let found = checkpoint.shared(&format!("{name}_{what}"))?;
        if found.len() == bodies * width { Ok(found) } else { Err(misfit(what)) }
    };
    let planes = planes::<D>().len();
    let by_body = |what: &str| {
        let flat = checkpoint.shared(&format!("{name}_{what}"))?;
        let mut rest = &flat[..];
        let own = multipliers.iter().map(|&count| rest.split_off(..count).map(<[f64]>::to_vec)).collect::<Option<Vec<_>>>();
        own.filter(|_| rest.is_empty()).ok_or_else(|| misfit(what))
    };
    let twist = |numbers: &[f64]| Twist { velocity: SVector::from_column_slice(&numbers[..D]), spin: skew(&numbers[D..]) };
    let impulse = |numbers: &[f64]| Wrench { force: SVector::from_column_slice(&numbers[..D]), torque: skew(&numbers[D..]) };
    let number = |what: &str| checkpoint.shared(&format!("{name}_{what}"))?.first().copied().ok_or_else(|| misfit(what));
    let (time, resolved) = (number("time")?, number("resolved")?);
    Ok(Level {
        time,
        fluid,
        multipliers: by_body("multipliers")?,
        smooth: by_body("smooth")?,
        slow: by_body("slow")?,
        lagging: by_body("lagging")?,
        centers: numbers("centers", D)?.chunks(D).map(SVector::from_column_slice).collect(),
        twists: numbers("twists", D + planes)?.chunks(D + planes).map(twist).collect(),
        spin_ups: numbers("spin_ups", planes)?.chunks(planes).map(<[f64]>::to_vec).collect(),
        impulses: numbers("impulses", D + planes)?.chunks(D + planes).map(impulse).collect(),
        resolved,
    })
}

fn flat<const D: usize>(points: &[SVector<f64, D>]) -> Vec<f64> {
    points.iter().flat_map(|point| point.iter().copied()).collect()
}

fn store_fluid<const D: usize>(writer: &mut CheckpointWriter, grid: &Grid<D>, name: &str, fluid: &Vector) -> Result<()> {
    (0..=D).try_for_each(|field| writer.lattice(&format!("{name}_{field}"), grid, field, &fluid.local()?[grid.local_range(field)]))
}

fn read_fluid<const D: usize>(checkpoint: &Checkpoint, grid: &Grid<D>, name: &str, fluid: &mut Vector) -> Result<()> {
    for field in 0..=D {
        let values = checkpoint.lattice(&format!("{name}_{field}"), grid, field)?;
        fluid.local_mut()?[grid.local_range(field)].copy_from_slice(&values);
    }
    Ok(())
}

fn store_state<const D: usize>(writer: &mut CheckpointWriter, world: &World, simulation: &Simulation<D>) -> Result<()> {
    let state = simulation.state();
    let (history, adhesive) = (state.written_contact_history(world), state.written_adhesive_contacts(world));
    let not_zero = |vector: &Vec<f64>| vector.iter().any(|entry| *entry != 0.0);
    let of_history = |vector: &dyn Fn(&ContactHistory<D>) -> Vec<f64>| -> Vec<(Identity<D>, Vec<f64>)> {
        history.iter().map(|contact| (contact.identity(), vector(contact))).filter(|(_, vector)| not_zero(vector)).collect()
    };
    let tangential = of_history(&|contact| contact.tangential.as_slice().to_vec());
    let couples = of_history(&|contact| components(&contact.couple));
    let mut counts = [adhesive.len() as f64, tangential.len() as f64, couples.len() as f64];
    world.sum(&mut counts);
    let mut numbers = vec![state.time, state.steps as f64, state.last_step];
    // how many, so that a list that is lost is missed
    let last = counts.iter().rposition(|count| *count > 0.0);
    numbers.extend(&counts[..last.map_or(0, |last| last + 1)]);
    if counts[0] > 0.0 {
        store_contacts(writer, state.count(), "stuck", adhesive)?;
    }
    if counts[1] > 0.0 {
        store_vectors(writer, state.count(), "tangential", &tangential)?;
    }
    if counts[2] > 0.0 {
        store_vectors(writer, state.count(), "couples", &couples)?;
    }
    writer.shared("time", &numbers)?;
    if state.shear != FoundShear::default() {
        writer.shared("shear", &[state.shear.strain, state.shear.rate])?;
    }
    if let Some(wall) = state.wall {
        writer.shared("wall", &[&[wall.position, wall.velocity], wall.force.as_slice()].concat())?;
    }
    let rows = state.written(world).flat_map(|place| [&[state.number(place) as f64], &state.bodies[place].pack()[..]].concat());
    writer.rows("bodies", state.count(), Moving::<D>::LENGTH, rows.collect())?;
    writer.shared("carried", &flat(&state.carried))?;
    store_contacts(writer, state.count(), "contacts", history.iter().map(|contact| (contact.identity(), contact.force)).collect())
}

/// Stores contacts of so many bodies, each with a number, as rows of their first bodies.
fn store_contacts<const D: usize>(
    writer: &mut CheckpointWriter,
    bodies: usize,
    name: &str,
    contacts: Vec<(Identity<D>, f64)>,
) -> Result<()> {
    let rows = contacts.into_iter().flat_map(|(identity, number)| [&[identity.0 as f64], &pack(identity, number)[..]].concat());
    writer.rows(name, bodies, packed_length::<D>(), rows.collect())
}

/// Stores vectors of one length by contact, of contacts of so many bodies, as rows of their first bodies.
fn store_vectors<const D: usize>(
    writer: &mut CheckpointWriter,
    bodies: usize,
    name: &str,
    vectors: &[(Identity<D>, Vec<f64>)],
) -> Result<()> {
    let row = |(identity, vector): &(Identity<D>, Vec<f64>)| [&[identity.0 as f64], &pack(*identity, vector[0])[..], &vector[1..]].concat();
    writer.rows(name, bodies, packed_length::<D>() + vector_length::<D>(name) - 1, vectors.iter().flat_map(row).collect())
}

/// How many numbers the vectors of this name have: couples as many as there are planes.
fn vector_length<const D: usize>(name: &str) -> usize {
    if name == "couples" { D * (D - 1) / 2 } else { D }
}

/// So many vectors of this name, by contact.
fn read_vectors<const D: usize>(checkpoint: &Checkpoint, name: &str, count: f64) -> Result<HashMap<Identity<D>, Vec<f64>>> {
    let numbers = if count > 0.0 { checkpoint.shared(name)? } else { Vec::new() };
    let length = packed_length::<D>() + vector_length::<D>(name) - 1;
    if numbers.len() as f64 != count * length as f64 {
        return Err(misfit(name));
    }
    let row = |numbers: &[f64]| {
        let (identity, first) = unpack(numbers);
        (identity, [&[first], &numbers[packed_length::<D>()..]].concat())
    };
    Ok(numbers.chunks(length).map(row).collect())
}

/// The contacts of this name, each with a number.
fn read_contacts<const D: usize>(checkpoint: &Checkpoint, name: &str) -> Result<Vec<(Identity<D>, f64)>> {
    let numbers = checkpoint.shared(name)?;
    if numbers.len() % packed_length::<D>() != 0 {
        return Err(misfit(name));
    }
    Ok(numbers.chunks(packed_length::<D>()).map(unpack).collect())
}

fn read_state<const D: usize>(world: &World, checkpoint: &Checkpoint, bodies: usize) -> Result<State<D>> {
    let numbers = checkpoint.shared("time")?;
    let (&[time, steps, last_step], counts) = numbers.split_first_chunk().ok_or_else(|| misfit("time"))?;
    let [sticking, sliding, turning] = [0, 1, 2].map(|place| counts.get(place).copied().unwrap_or(0.0));
    let adhesive = if sticking > 0.0 { read_contacts(checkpoint, "stuck")? } else { Vec::new() };
    if adhesive.len() as f64 != sticking || counts.len() > 3 {
        return Err(misfit("stuck"));
    }
    let flat = world.gather(&checkpoint.rows("bodies", bodies, Moving::<D>::LENGTH)?.ok_or_else(|| misfit("bodies"))?);
    let (tangential, couples) = (read_vectors(checkpoint, "tangential", sliding)?, read_vectors(checkpoint, "couples", turning)?);
    let history = |(identity, force): (Identity<D>, f64)| {
        let (body, partner, image) = identity;
        let tangential = tangential.get(&identity).map_or_else(SVector::zeros, |vector| SVector::from_column_slice(vector));
        let couple = couples.get(&identity).map_or_else(SMatrix::zeros, |vector| skew(vector));
        ContactHistory { body, partner, image, force, tangential, couple }
    };
    Ok(State {
        time,
        steps: steps as usize,
        last_step,
        shear: FoundShear::default(),
        wall: None,
        share: Share::Whole,
        bodies: flat.chunks(Moving::<D>::LENGTH).map(Moving::unpack).collect(),
        contact_history: read_contacts(checkpoint, "contacts")?.into_iter().map(history).collect(),
        adhesive_contacts: adhesive.into_iter().map(AdhesiveContact::from).collect(),
        carried: checkpoint.shared("carried")?.chunks(D).map(SVector::from_column_slice).collect(),
    })
}

fn misfit(name: &str) -> Error {
    Refusal::from(format!("the checkpoint's {name} do not fit the scene; resume from another checkpoint")).offering(Offer::Anew)
}

fn store_past<const D: usize>(writer: &mut CheckpointWriter, grid: &Grid<D>, past: Option<&ExtrapolationHistory<D>>) -> Result<()> {
    let interval = past.and_then(|past| past.earlier.as_ref()).map_or(0.0, |(_, interval)| *interval);
    writer.shared("past", &past.map_or(vec![], |past| vec![past.time, interval]))?;
    let Some(past) = past else { return Ok(()) };
    let snapshots = [Some(&past.last), past.earlier.as_ref().map(|(earlier, _)| earlier)];
    for (name, snapshot) in SNAPSHOTS.into_iter().zip(snapshots) {
        let Some(snapshot) = snapshot else { continue };
        if let Some(fluid) = &snapshot.fluid {
            store_fluid(writer, grid, name, fluid)?;
        }
        let counts: Vec<f64> = snapshot.multipliers.iter().map(|multipliers| multipliers.len() as f64).collect();
        writer.shared(&format!("{name}_modes"), &counts)?;
        writer.shared(&format!("{name}_multipliers"), &snapshot.multipliers.concat())?;
        writer.shared(&format!("{name}_centers"), &flat(&snapshot.centers))?;
        writer.shared(&format!("{name}_closure"), &snapshot.mean_flow)?;
    }
    Ok(())
}

fn read_past<const D: usize>(checkpoint: &Checkpoint, grid: &Grid<D>, shape: Option<&Vector>) -> Result<Option<ExtrapolationHistory<D>>> {
    let [time, interval] = checkpoint.shared("past")?[..] else { return Ok(None) };
    let last = read_snapshot(checkpoint, grid, shape, SNAPSHOTS[0])?;
    let earlier = if interval > 0.0 { Some((read_snapshot(checkpoint, grid, shape, SNAPSHOTS[1])?, interval)) } else { None };
    Ok(Some(ExtrapolationHistory { time, last, earlier }))
}

fn read_snapshot<const D: usize>(checkpoint: &Checkpoint, grid: &Grid<D>, shape: Option<&Vector>, name: &str) -> Result<Snapshot<D>> {
    let mut fluid = shape.map(Vector::like).transpose()?;
    if let Some(fluid) = &mut fluid {
        read_fluid(checkpoint, grid, name, fluid)?;
    }
    let counts = checkpoint.shared(&format!("{name}_modes"))?;
    let flat = checkpoint.shared(&format!("{name}_multipliers"))?;
    if counts.iter().sum::<f64>() != flat.len() as f64 {
        return Err(misfit("multipliers"));
    }
    let mut rest = &flat[..];
    let take = |count: &f64| rest.split_off(..*count as usize).unwrap_or_default().to_vec();
    let multipliers = counts.iter().map(take).collect();
    let centers = checkpoint.shared(&format!("{name}_centers"))?.chunks(D).map(SVector::from_column_slice).collect();
    Ok(Snapshot { fluid, multipliers, centers, mean_flow: checkpoint.shared(&format!("{name}_closure"))? })
}
