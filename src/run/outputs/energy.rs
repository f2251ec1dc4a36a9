//! `energy.csv`: the balance of energy of a flow with inertia, a row for each step.

use std::path::{Path, PathBuf};

use super::cell::{Cell, count, real};
use super::context::{Context, Wanted, boxed};
use super::step_table::StepTable;
use crate::{
    error::{Error, Result},
    mechanics::is_moved_at_once,
    motion::Simulation,
    observe::EnergyRates,
    output::{Columns, EnergySummary, Summary},
    parallel::World,
    run::{Output, View},
};

const NAME: &str = "energy.csv";

/// The table of a run.
pub struct EnergyFile {
    folder: PathBuf,
    /// On the first rank.
    table: Option<StepTable>,
    /// What is known after the last row; the same on all ranks.
    balance: Option<Balance>,
}

/// A balance up to a time.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Balance {
    time: f64,
    /// Kinetic energy at the start.
    start: f64,
    rates: EnergyRates,
    /// Done since the start.
    work: f64,
    /// By viscosity since the start.
    dissipated: f64,
    /// By films since the start.
    by_films: f64,
    /// In contacts since the start.
    by_contacts: f64,
}

/// With `output.energy`. Collective.
///
/// # Errors
/// As [`EnergyFile::open`].
pub fn wanted<const D: usize>(context: &Context<D>) -> Wanted<D> {
    let Some(simulation) = context.simulation.filter(|_| context.scene.output.energy) else { return Ok(None) };
    Ok(Some(boxed(EnergyFile::open(context.world, context.folder, simulation)?)))
}

impl EnergyFile {
    /// Opens it for what comes from the state of the simulation on. Collective.
    ///
    /// # Errors
    /// The file cannot be read or written, or rows that are needed to go on are lost.
    fn open<const D: usize>(world: &World, folder: &Path, simulation: &Simulation<D>) -> Result<EnergyFile> {
        let path = folder.join(NAME);
        let (table, kept) = StepTable::open(world, &path, simulation.state().steps)?;
        let known = Balance::read(&world.broadcast(0, &kept));
        if simulation.state().steps > 0 && known.is_none() {
            return Err(Error::refused(format!("{}: has no rows to go on from; put it back, or remove output.energy", path.display())));
        }
        Ok(EnergyFile { folder: folder.to_owned(), table, balance: known })
    }
}

impl Balance {
    fn begin(time: f64, rates: EnergyRates) -> Balance {
        Balance { time, start: rates.kinetic_energy, rates, work: 0.0, dissipated: 0.0, by_films: 0.0, by_contacts: 0.0 }
    }

    /// The balance a step later: rates count with their mean over the step, of which those before it have a part. In a first step with a jump from rest half,
    /// too: what moves things there is its force, an impulse, times the mean of the velocities before and after, half of what it is at the end.
    fn after(self, time: f64, rates: EnergyRates, part: f64) -> Balance {
        let over_step = |before: f64, after: f64| (time - self.time) * (part * before + (1.0 - part) * after);
        let films = |rates: &EnergyRates| rates.films.unwrap_or(0.0);
        Balance {
            time,
            rates,
            work: self.work + over_step(self.rates.power, rates.power),
            dissipated: self.dissipated + over_step(self.rates.viscous, rates.viscous),
            by_films: self.by_films + over_step(films(&self.rates), films(&rates)),
            by_contacts: self.by_contacts + rates.lost_in_contacts,
            ..self
        }
    }

    /// What work brought and nothing took.
    fn unbalanced(&self) -> f64 {
        self.work - self.dissipated - self.by_films - self.by_contacts - (self.rates.kinetic_energy - self.start)
    }

    /// Names and values of the columns beside step and time; none for what a scene does not have.
    fn columns(&self, contacts: bool) -> Vec<(&'static str, Option<f64>)> {
        let films = self.rates.films.is_some();
        vec![
            ("kinetic_energy", Some(self.rates.kinetic_energy)),
            ("power", Some(self.rates.power)),
            ("dissipation", Some(self.rates.viscous)),
            ("dissipation_films", self.rates.films),
            ("work", Some(self.work)),
            ("dissipated", Some(self.dissipated)),
            ("dissipated_films", films.then_some(self.by_films)),
            ("lost_in_contacts", contacts.then_some(self.by_contacts)),
            ("unbalanced", Some(self.unbalanced())),
        ]
    }

    /// The balance of the last row of a table, if it has one.
    fn read(text: &str) -> Option<Balance> {
        let table = Columns::parse(text);
        let last = table.rows().checked_sub(1)?;
        let at_end = |name: &str| table.number(name, last);
        let rates = EnergyRates {
            kinetic_energy: at_end("kinetic_energy")?,
            power: at_end("power")?,
            viscous: at_end("dissipation")?,
            films: at_end("dissipation_films"),
            lost_in_contacts: 0.0,
        };
        Some(Balance {
            time: at_end("time")?,
            start: table.number("kinetic_energy", 0)?,
            rates,
            work: at_end("work")?,
            dissipated: at_end("dissipated")?,
            by_films: at_end("dissipated_films").unwrap_or(0.0),
            by_contacts: at_end("lost_in_contacts").unwrap_or(0.0),
        })
    }
}

impl<const D: usize> Output<D> for EnergyFile {
    fn write(&mut self, view: &View<D>) -> Result<()> {
        let (Some(motion), Some(flow)) = (&view.motion, &view.flow) else { return Ok(()) };
        let contacts = &motion.observation.contacts;
        let Some(rates) = EnergyRates::of(flow.solver, flow.solution, contacts, view.viscosity)? else { return Ok(()) };
        let (steps, time) = (motion.state().steps, motion.state().time);
        // the force of a jump is an impulse, which the step after it does not have
        let part = if steps == 2 && is_moved_at_once(flow.solver.setup()) { 0.0 } else { 0.5 };
        let balance = self.balance.map_or_else(|| Balance::begin(time, rates), |before| before.after(time, rates, part));
        self.balance = Some(balance);
        let touching = flow.solver.setup().interactions.touch().is_some();
        let cell = |(name, value): (&'static str, Option<f64>)| value.map(|value| real(name, value));
        let cells = balance.columns(touching).into_iter().filter_map(cell);
        let row: Vec<Cell> = [count("step", steps), real("time", time)].into_iter().chain(cells).collect();
        view.world.agree(self.table.as_mut().map_or(Ok(()), |table| table.write(&row)))
    }

    fn finish(&mut self, view: &View<D>, summary: &mut Summary) -> Result<Vec<String>> {
        view.world.agree(self.table.as_ref().map_or(Ok(()), StepTable::refuse_change))?;
        summary.energy = self.balance.map(|balance| EnergySummary {
            work: balance.work,
            dissipated: balance.dissipated,
            dissipated_films: balance.rates.films.map(|_| balance.by_films),
            lost_in_contacts: balance.by_contacts,
            gained: balance.rates.kinetic_energy - balance.start,
            unbalanced: balance.unbalanced(),
        });
        Ok(vec![NAME.to_owned()].into_iter().filter(|name| self.folder.join(name).exists()).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rates(kinetic_energy: f64, power: f64, viscous: f64) -> EnergyRates {
        EnergyRates { kinetic_energy, power, viscous, films: None, lost_in_contacts: 0.125 }
    }

    fn balance() -> Balance {
        Balance::begin(0.0, rates(1.0, 2.0, 0.5)).after(0.5, rates(1.25, 3.0, 0.75), 0.5).after(1.0, rates(2.0, 5.0, 1.25), 0.5)
    }

    #[test]
    fn rates_count_over_steps_and_what_is_left_shows() {
        let found = balance();
        assert_eq!((found.work, found.dissipated, found.by_contacts), (1.25 + 2.0, 0.3125 + 0.5, 0.25));
        assert_eq!(found.unbalanced(), 3.25 - 0.8125 - 0.25 - 1.0);
        let after_a_jump =
            Balance::begin(0.0, rates(0.0, 0.0, 0.0)).after(0.5, rates(1.0, 8.0, 0.5), 0.5).after(1.0, rates(1.0, 1.0, 0.5), 0.0);
        assert_eq!((after_a_jump.work, after_a_jump.dissipated), (2.0 + 0.5, 0.125 + 0.25));
    }

    #[test]
    fn a_balance_goes_on_from_its_last_row() {
        let rows = [Balance::begin(0.0, rates(1.0, 2.0, 0.5)), balance()];
        let columns = |row: &Balance| row.columns(true).into_iter().filter_map(|(name, value)| Some((name, value?))).collect::<Vec<_>>();
        let names: Vec<&str> = columns(&rows[0]).iter().map(|(name, _)| *name).collect();
        let line = |row: &Balance| columns(row).iter().map(|(_, value)| format!(",{:?}", value + 0.0)).collect::<String>();
        let text = format!("step,time,{}\n0,0.0{}\n2,1.0{}\n", names.join(","), line(&rows[0]), line(&rows[1]));
        let expected = Balance { rates: EnergyRates { lost_in_contacts: 0.0, ..rows[1].rates }, ..rows[1] };
        assert_eq!(Balance::read(&text), Some(expected));
        assert_eq!(Balance::read("step,time\n"), None);
    }
}
