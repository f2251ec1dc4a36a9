//! The ranks: sums, extremes, gathering, broadcasting and agreeing. Everything here is collective.

mod age;
mod machine;
mod memory;
mod routes;
mod sparse;

use std::{cell::Cell, ops::Range};

use mpi::{
    collective::SystemOperation,
    datatype::{Equivalence, PartitionMut},
    ffi::MPI_Comm,
    point_to_point::{Destination, Source},
    request,
    topology::SimpleCommunicator,
    traits::{AsRaw, Communicator, CommunicatorCollectives, Root},
};
use serde::Serialize;

use crate::error::{Error, Result};
pub use age::{process_seconds, processor_seconds};
pub use machine::Machine;
pub use memory::{free_memory_bytes, memory_in_words, peak_memory_bytes};
pub use routes::Routes;

/// What tells ranks that bodies in contact could not be kept apart; no exit code.
const CONTACT: i32 = -1;

/// What tells ranks that a step is too long; no exit code.
const STEP: i32 = -2;

/// All ranks of this run.
pub struct World {
    communicator: SimpleCommunicator,
    log: TrafficLog,
    /// Parity of the exchanges of letters so far.
    exchanges: Cell<usize>,
}

/// What is told of the traffic of this rank.
#[derive(Clone, Copy)]
pub(crate) struct TrafficLog {
    /// The bytes that it contributes to a collective.
    pub collective: fn(usize),
    /// The bytes that come to it in a gathering.
    pub gathered: fn(usize),
    /// Number and bytes of the messages that it sends to single ranks.
    pub messages: fn(usize, usize),
}

/// The ranks that share something out among them: all of a run, or this process alone, which needs no MPI.
#[derive(Clone, Copy)]
pub enum Peers<'a> {
    /// This process has it all.
    Alone,
    /// Each rank has a part.
    All(&'a World),
}

/// How the entries of a buffer are shared out among the ranks, one rank's after the other's.
struct Shares {
    counts: Vec<i32>,
    starts: Vec<i32>,
}

impl Shares {
    /// Shares of `counts` entries, one count a rank.
    fn new(counts: Vec<i32>) -> Shares {
        let starts = counts.iter().scan(0, |sum, &count| Some(std::mem::replace(sum, *sum + count))).collect();
        Shares { counts, starts }
    }

    /// Entries of all ranks.
    fn total(&self) -> usize {
        self.counts.iter().sum::<i32>() as usize
    }
}

/// The share of a rank, one of so many, in things that are numbered: all ranks together have each of them once.
pub fn share(count: usize, rank: usize, ranks: usize) -> Range<usize> {
    rank * count / ranks..(rank + 1) * count / ranks
}

impl World {
    pub(crate) fn new(communicator: SimpleCommunicator, log: TrafficLog) -> World {
        World { communicator, log, exchanges: Cell::new(0) }
    }

    pub(crate) fn raw(&self) -> MPI_Comm {
        self.communicator.as_raw()
    }

    pub(crate) fn raw_self(&self) -> MPI_Comm {
        SimpleCommunicator::self_comm().as_raw()
    }

    /// Number of this rank, from 0.
    pub fn rank(&self) -> usize {
        self.communicator.rank() as usize
    }

    /// Number of ranks.
    pub fn size(&self) -> usize {
        self.communicator.size() as usize
    }

    /// The share of this rank in so many things that are numbered.
    pub fn share(&self, count: usize) -> Range<usize> {
        share(count, self.rank(), self.size())
    }

    /// Sums each entry over the ranks.
    pub fn sum(&self, values: &mut [f64]) {
        self.reduce(values, SystemOperation::sum());
    }

    /// Largest value over the ranks.
    pub fn max(&self, value: f64) -> f64 {
        let mut values = [value];
        self.reduce(&mut values, SystemOperation::max());
        values[0]
    }

    /// Logs a collective to which this rank contributes values.
    fn count<T>(&self, values: &[T]) {
        if self.size() > 1 {
            (self.log.collective)(size_of_val(values));
        }
    }

    fn reduce(&self, values: &mut [f64], operation: SystemOperation) {
        let local = values.to_vec();
        self.count(values);
        self.communicator.all_reduce_into(&local[..], values, operation);
    }

    /// The values of all ranks, one after the other, on every rank; numbers of values may differ.
    pub fn gather<T: Equivalence + Clone + Default>(&self, local: &[T]) -> Vec<T> {
        let count = local.len() as i32;
        let mut counts = vec![0; self.size()];
        self.count(&[count]);
        self.communicator.all_gather_into(&count, &mut counts[..]);
        let shares = Shares::new(counts);
        let mut all = vec![T::default(); shares.total()];
        self.count(local);
        (self.log.gathered)(size_of_val(&all[..]) - size_of_val(local));
        self.communicator.all_gather_varcount_into(local, &mut PartitionMut::new(&mut all[..], shares.counts, shares.starts));
        all
    }

    /// Sends to some ranks a part each, and receives a part from each of some; nothing to or from itself.
    pub fn transfer<T: Equivalence>(&self, sent: &[(usize, &[T])], received: Vec<(usize, &mut [T])>) {
        (self.log.messages)(sent.len(), sent.iter().map(|(_, part)| size_of_val(*part)).sum());
        let process = |rank: usize| self.communicator.process_at_rank(rank as i32);
        request::multiple_scope(sent.len() + received.len(), |scope, requests| {
            for (rank, part) in received {
                requests.add(process(rank).immediate_receive_into(scope, part));
            }
            for &(rank, part) in sent {
                requests.add(process(rank).immediate_send(scope, part));
            }
            requests.wait_all(&mut Vec::new());
        });
    }

    /// The text of rank `root`, on every rank.
    pub fn broadcast(&self, root: usize, text: &str) -> String {
        let process = self.communicator.process_at_rank(root as i32);
        let mut length = text.len() as u64;
        self.count(&[length]);
        process.broadcast_into(&mut length);
        let mut bytes = text.as_bytes().to_vec();
        bytes.resize(length as usize, 0);
        self.count(&bytes);
        process.broadcast_into(&mut bytes[..]);
        String::from_utf8_lossy(&bytes).into_owned()
    }

    /// Makes one outcome of the ranks' outcomes: success if all succeeded, else everywhere the error of the first rank that failed.
    pub fn agree<T>(&self, outcome: Result<T>) -> Result<T> {
        let failed = self.gather(&[outcome.is_err()]);
        let Some(first) = failed.iter().position(|&failed| failed) else { return outcome };
        let (text, code) = match &outcome {
            Err(Error::Refused(refusal)) => (serde_json::to_string(refusal).expect("a refusal is plain text"), 2),
            Err(Error::Contact { text, island, step }) => (texts(&(text, island, step.map(f64::to_bits))), CONTACT),
            Err(Error::StepTooLong { text, step }) => (texts(&(text, step.to_bits())), STEP),
            Err(error) => (error.to_string(), error.exit_code()),
            Ok(_) => (String::new(), 0),
        };
        let code = self.gather(&[code])[first];
        let text = self.broadcast(first, &text);
        match outcome {
            Err(error) if self.rank() == first => Err(error),
            // a file of that rank is told as text
            _ if code == 2 => Err(serde_json::from_str(&text).map_or_else(|_| Error::refused(text), Error::Refused)),
            _ if code == CONTACT => {
                let (text, island, step): (_, _, Option<u64>) = serde_json::from_str(&text).expect("these values were sent");
                Err(Error::Contact { text, island, step: step.map(f64::from_bits) })
            }
            _ if code == STEP => {
                let (text, step) = serde_json::from_str(&text).expect("these values were sent");
                Err(Error::StepTooLong { text, step: f64::from_bits(step) })
            }
            _ => Err(Error::Elsewhere { rank: first, text }),
        }
    }

    /// Acts on the first rank and makes its outcome known: its value there and a default elsewhere, or its error everywhere.
    pub fn on_first_rank<T: Default>(&self, act: impl FnOnce() -> Result<T>) -> Result<T> {
        self.agree(if self.rank() == 0 { act() } else { Ok(T::default()) })
    }

    /// Memory that is free to use on all machines of this run together, in bytes.
    pub fn available_memory_bytes(&self) -> f64 {
        let (machines, free) = (self.gather(&[machine()]), self.gather(&[free_memory_bytes()]));
        let first = |&(place, machine): &(usize, &u64)| !machines[..place].contains(machine);
        machines.iter().enumerate().filter(first).map(|(place, _)| free[place]).sum()
    }

    /// Waits for all ranks.
    pub fn barrier(&self) {
        self.communicator.barrier();
    }

    /// Stops all ranks at once.
    pub fn abort(&self, code: i32) -> ! {
        self.communicator.abort(code)
    }
}

impl<'a> From<&'a World> for Peers<'a> {
    fn from(world: &'a World) -> Peers<'a> {
        if world.size() > 1 { Peers::All(world) } else { Peers::Alone }
    }
}

impl Peers<'_> {
    /// How many.
    pub fn count(&self) -> usize {
        self.world().map_or(1, World::size)
    }

    /// Number of this one, from 0.
    pub fn rank(&self) -> usize {
        self.world().map_or(0, World::rank)
    }

    fn world(&self) -> Option<&World> {
        match self {
            Peers::Alone => None,
            Peers::All(world) => Some(world),
        }
    }

    /// Largest value over all.
    pub fn max(&self, value: f64) -> f64 {
        self.world().map_or(value, |world| world.max(value))
    }

    /// Smallest value over all.
    pub fn min(&self, value: f64) -> f64 {
        -self.max(-value)
    }

    /// Whether it is so for any.
    pub fn any(&self, so: bool) -> bool {
        self.max(f64::from(so)) > 0.0
    }

    /// Sums each entry over all.
    pub fn sum(&self, values: &mut [f64]) {
        if let Some(world) = self.world() {
            world.sum(values);
        }
    }

    /// The values of all, one after the other.
    pub fn gather<T: Equivalence + Clone + Default>(&self, local: &[T]) -> Vec<T> {
        self.world().map_or_else(|| local.to_vec(), |world| world.gather(local))
    }

    /// See [`World::send`].
    pub fn send<T: Equivalence + Clone + Default>(&self, sent: &[T], counts: &[usize]) -> (Vec<T>, Vec<usize>) {
        self.world().map_or_else(|| (sent.to_vec(), counts.to_vec()), |world| world.send(sent, counts))
    }

    /// Sends each its letter and gives all that came, one after the other.
    pub fn deliver(&self, letters: &[Vec<f64>]) -> Vec<f64> {
        let counts: Vec<usize> = letters.iter().map(Vec::len).collect();
        self.send(&letters.concat(), &counts).0
    }

    /// See [`World::agree`].
    pub fn agree<T>(&self, outcome: Result<T>) -> Result<T> {
        match self {
            Peers::Alone => outcome,
            Peers::All(world) => world.agree(outcome),
        }
    }
}

/// Values as a text; numbers go as their bits, which every rank reads alike.
fn texts(values: &impl Serialize) -> String {
    serde_json::to_string(values).expect("plain values")
}

/// Set in the environment of every rank by Open MPI, by PMIx and by Slurm's or MPICH's own starter.
const MARKS: [&str; 3] = ["OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"];

/// The number of this rank as its launcher tells it before MPI is there to ask; nothing without a launcher.
fn launched_rank() -> Option<String> {
    MARKS.iter().find_map(|mark| std::env::var(mark).ok())
}

/// Whether a launcher has started this process as one of several ranks.
pub fn launched() -> bool {
    launched_rank().is_some()
}

/// Whether this process speaks for all ranks before MPI is there to tell.
pub fn first_of_launched() -> bool {
    launched_rank().is_none_or(|rank| rank == "0")
}

/// Ends a process that has not started MPI, if it is a rank together with the others.
///
/// A launcher ends all ranks as soon as one of them ends with a code, also the first one while it still speaks.
pub fn end_together(code: i32) -> ! {
    if launched()
        && let Some(universe) = mpi::initialize()
    {
        SimpleCommunicator::world().barrier();
        drop(universe);
    }
    std::process::exit(code)
}

/// Stops all ranks when one of them panics, instead of leaving the others to wait for ever.
pub fn abort_on_panic() {
    let report = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        report(panic);
        if mpi::environment::is_initialized() {
            SimpleCommunicator::world().abort(101);
        }
    }));
}

/// A number that tells machines apart.
fn machine() -> u64 {
    let name = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let mut hasher = std::hash::DefaultHasher::new();
    std::hash::Hash::hash(&name, &mut hasher);
    std::hash::Hasher::finish(&hasher)
}
