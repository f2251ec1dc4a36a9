//! A table of objects: rows at the times of frames, and in between when an object has turned by a quarter since its last row, so that angles are
//! followed over turns however rare frames are.

use std::{borrow::Cow, path::PathBuf};

use nalgebra::SVector;

use super::super::cell::{Cell, absent, count, finite, real};
use super::super::context::{Context, Wanted, boxed};
use super::super::frames::frame_due;
use super::super::step_table::StepTable;
use super::turns::{AngleColumns, Turns};
use crate::{
    error::Result,
    output::{AXES, Summary},
    run::{Output, View},
};

/// A number with the name of its column; one that is not finite leaves its cell empty.
pub type NamedNumber = (Cow<'static, str>, f64);

/// Objects of one kind. All functions are collective.
pub trait Objects<const D: usize> {
    /// The name of their table, and that of its column with their numbers.
    fn names(&self) -> [&'static str; 2];

    /// How many there are.
    fn count(&self) -> usize;

    /// The columns of the angle that is followed; nothing where there is none.
    fn angle(&self) -> Option<AngleColumns>;

    /// This angle of those that this rank knows, each with its place among all that have one; within a turn.
    fn angles(&self, view: &View<D>) -> Vec<(usize, f64)>;

    /// Rows of all of them, on every rank.
    fn rows(&self, view: &View<D>) -> Vec<ObjectRow>;
}

/// What there is to say of an object.
pub struct ObjectRow {
    /// Its number.
    pub number: usize,
    /// What was measured.
    pub entries: Vec<NamedNumber>,
    /// The angle that is followed, within a turn, if it has one.
    pub angle: Option<f64>,
}

/// Names of the components of a vector with the components; those of a place have the names of the axes.
pub fn vector<const D: usize>(name: &str, vector: &SVector<f64, D>) -> Vec<NamedNumber> {
    let named = |axis: &str| if name.is_empty() { axis.to_owned() } else { format!("{name}_{axis}") };
    AXES.into_iter().zip(vector).map(|(axis, &component)| (named(axis).into(), component)).collect()
}

/// The table of some objects.
struct ObjectTable<O> {
    folder: PathBuf,
    objects: O,
    /// On the first rank.
    table: Option<StepTable>,
    /// The same on all ranks.
    turns: Turns,
    /// Time between frames.
    every: f64,
}

/// The table of these objects, for what comes from the state of the simulation on; nothing without any, or where the scene wants none. Collective.
///
/// # Errors
/// The file cannot be read or written.
pub fn opened<const D: usize>(context: &Context<D>, objects: impl Objects<D> + 'static) -> Wanted<D> {
    if objects.count() == 0 {
        return Ok(None);
    }
    let (world, [name, _]) = (context.world, objects.names());
    let (table, kept) = StepTable::open_before(world, &context.folder.join(name), context.time())?;
    let turns = objects.angle().map_or_else(Turns::default, |angle| Turns::read(&kept, angle, objects.count()));
    let turns = Turns::unpack(&world.gather(&turns.pack()));
    Ok(Some(boxed(ObjectTable { folder: context.path(), objects, table, turns, every: context.scene.frame_interval() })))
}

/// The cells of a row at a time, with the angle over turns if it has one.
fn cells(time: f64, kind: &'static str, row: ObjectRow, angle: Option<AngleColumns>, followed: Option<f64>) -> Vec<Cell> {
    let mut cells = vec![real("time", time), count(kind, row.number)];
    cells.extend(row.entries.into_iter().map(|(name, number)| finite(name, number)));
    let some = |name: &'static str, number: Option<f64>| number.map_or_else(|| absent(name), |number| real(name, number));
    if let Some(AngleColumns { followed: name, plain }) = angle {
        cells.extend(plain.map(|plain| some(plain, row.angle)));
        cells.push(some(name, followed));
    }
    cells
}

impl<O> ObjectTable<O> {
    /// Whether one of them has turned by a quarter since the last rows. Collective.
    fn turned<const D: usize>(&self, view: &View<D>) -> bool
    where
        O: Objects<D>,
    {
        let quarter = || self.turns.quarter(&self.objects.angles(view));
        !self.turns.is_empty() && view.world.max(f64::from(quarter())) > 0.0
    }
}

impl<const D: usize, O: Objects<D>> Output<D> for ObjectTable<O> {
    fn write(&mut self, view: &View<D>) -> Result<()> {
        let Some(motion) = view.motion else { return Ok(()) };
        if !frame_due(&motion, self.every) && !self.turned(view) {
            return Ok(());
        }
        let (rows, columns, [_, kind]) = (self.objects.rows(view), self.objects.angle(), self.objects.names());
        let angles: Vec<f64> = rows.iter().filter_map(|row| row.angle).collect();
        let mut followed = self.turns.advance(&angles, columns.is_some_and(|columns| columns.plain.is_some())).iter().copied();
        let time = motion.state().time;
        let cells = |row: ObjectRow| {
            let over_turns = row.angle.and_then(|_| followed.next());
            cells(time, kind, row, columns, over_turns)
        };
        let rows: Vec<Vec<Cell>> = rows.into_iter().map(cells).collect();
        view.world.agree(self.table.as_mut().map_or(Ok(()), |table| table.write_rows(&rows)))
    }

    fn finish(&mut self, view: &View<D>, _: &mut Summary) -> Result<Vec<String>> {
        view.world.agree(self.table.as_ref().map_or(Ok(()), StepTable::refuse_change))?;
        let [name, _] = self.objects.names();
        Ok(vec![name.to_owned()].into_iter().filter(|name| self.folder.join(name).exists()).collect())
    }
}
