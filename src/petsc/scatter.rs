//! Copies chosen entries of a distributed vector to the rank that wants them, and adds them back.

use std::{ops::Range, ptr::null_mut};

use super::{Session, Vector, ffi, index, owned::Owned, petsc};
use crate::error::Result;

/// A fixed list of wanted entries with a local place for each.
pub struct Scatter {
    /// Wanted entries of this rank: where each run starts among the places, and which entries it has.
    own: Vec<(usize, Range<usize>)>,
    /// Those of other ranks; none on one rank.
    others: Option<Foreign>,
    places: Vec<f64>,
}

/// Entries of other ranks.
struct Foreign {
    owned: Owned<ffi::VecScatter>,
    values: Vector,
    /// The places of these values.
    places: Vec<usize>,
}

/// Wanted entries that follow each other on one rank.
#[derive(Debug, Clone, Copy)]
pub struct WantedRun {
    /// The place of the first.
    pub place: usize,
    /// Its number on all ranks.
    pub first: usize,
    /// How many there are.
    pub length: usize,
}

impl Scatter {
    /// Plans the exchange of the entries `wanted` (global indices, any rank's) of vectors shaped like `vector`.
    pub fn new(vector: &Vector, wanted: &[usize]) -> Result<Scatter> {
        let single = wanted.iter().enumerate().map(|(place, &first)| WantedRun { place, first, length: 1 });
        Scatter::of_runs(vector, wanted.len(), single)
    }

    /// As [`new`](Self::new), for runs of entries and so many places; places without an entry stay zero.
    pub fn of_runs(vector: &Vector, places: usize, wanted: impl Iterator<Item = WantedRun>) -> Result<Scatter> {
        let (here, session) = (vector.range()?, vector.session());
        let mut own: Vec<(usize, Range<usize>)> = Vec::new();
        let (mut foreign, mut foreign_places) = (Vec::new(), Vec::new());
        for WantedRun { place, first, length } in wanted {
            if !here.contains(&first) {
                foreign.extend((first..first + length).map(index));
                foreign_places.extend(place..place + length);
                continue;
            }
            let entry = first - here.start;
            match own.last_mut() {
                Some((start, run)) if run.end == entry && *start + run.len() == place => run.end += length,
                _ => own.push((place, entry..entry + length)),
            }
        }
        let others = (session.world().size() > 1).then(|| Foreign::new(session, vector, &foreign, foreign_places)).transpose()?;
        Ok(Scatter { own, others, places: vec![0.0; places] })
    }

    /// Fetches the wanted entries of `vector`, in the order in which they were asked for.
    pub fn fetch(&mut self, vector: &Vector) -> Result<&[f64]> {
        let entries = vector.local()?;
        for (place, run) in &self.own {
            self.places[*place..place + run.len()].copy_from_slice(&entries[run.clone()]);
        }
        drop(entries);
        if let Some(others) = &self.others {
            others.exchange(vector.raw(), others.values.raw(), ffi::InsertMode_INSERT_VALUES, ffi::ScatterMode_SCATTER_FORWARD)?;
            others.places.iter().zip(others.values.local()?.iter()).for_each(|(place, value)| self.places[*place] = *value);
        }
        Ok(&self.places)
    }

    /// The local places, zeroed, to fill before [`add_back`](Self::add_back).
    pub fn places(&mut self) -> &mut [f64] {
        self.places.fill(0.0);
        &mut self.places
    }

    /// Adds the local places to the entries of `vector` they stand for.
    pub fn add_back(&mut self, vector: &mut Vector) -> Result<()> {
        let mut entries = vector.local_mut()?;
        for (place, run) in &self.own {
            entries[run.clone()].iter_mut().zip(&self.places[*place..]).for_each(|(entry, value)| *entry += value);
        }
        drop(entries);
        let Some(others) = &mut self.others else { return Ok(()) };
        let mut values = others.values.local_mut()?;
        values.iter_mut().zip(&others.places).for_each(|(value, place)| *value = self.places[*place]);
        drop(values);
        others.exchange(others.values.raw(), vector.raw(), ffi::InsertMode_ADD_VALUES, ffi::ScatterMode_SCATTER_REVERSE)
    }
}

impl Foreign {
    fn new(session: &Session, vector: &Vector, wanted: &[ffi::PetscInt], places: Vec<usize>) -> Result<Foreign> {
        let values = Vector::new_local(session, wanted.len())?;
        let mut set = null_mut();
        let copy = ffi::PetscCopyMode_PETSC_COPY_VALUES;
        petsc!(ISCreateGeneral(session.communicator(), index(wanted.len()), wanted.as_ptr(), copy, &mut set))?;
        let set = Owned::new(session, set);
        let mut raw = null_mut();
        petsc!(VecScatterCreate(vector.raw(), set.raw(), values.raw(), null_mut(), &mut raw))?;
        Ok(Foreign { owned: Owned::new(session, raw), values, places })
    }

    fn exchange(&self, from: ffi::Vec, to: ffi::Vec, insert: ffi::InsertMode, direction: ffi::ScatterMode) -> Result<()> {
        petsc!(VecScatterBegin(self.owned.raw(), from, to, insert, direction))?;
        petsc!(VecScatterEnd(self.owned.raw(), from, to, insert, direction))
    }
}
