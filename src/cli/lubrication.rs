//! `turbid lubrication`: what two near bodies, or a body and a wall, resist, what modes see of it, and what is missing.

use clap::Args;

use crate::{
    constraint::lubrication::{FilmTable, FilmTables, Resistance},
    error::{Error, Result},
    output::say,
    parallel::World,
    surface::highest_order,
};

/// Arguments of the command.
#[derive(Debug, Args)]
pub struct LubricationArguments {
    /// Dimension of space
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u8).range(2..=3))]
    dimension: u8,
    /// Order of the modes of the bodies
    #[arg(long, default_value_t = 6)]
    modes: usize,
    /// Radius of the second body over that of the first, at least 1
    #[arg(long, default_value_t = 1.0)]
    ratio: f64,
    /// A wall takes the place of the second body
    #[arg(long)]
    wall: bool,
}

/// Gaps of the table, in radii of the first body.
const GAPS: [f64; 13] = [1e-5, 1e-4, 1e-3, 0.003, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0];

/// Prints the table.
///
/// # Errors
/// [`Error::Refused`] for an order that is not tabulated or a ratio below 1.
pub fn lubrication(world: &World, arguments: &LubricationArguments) -> Result<()> {
    let LubricationArguments { dimension, modes, ratio, wall } = arguments;
    let highest = highest_order(usize::from(*dimension));
    if !(1..=highest).contains(modes) {
        return Err(Error::refused(format!("--modes {modes}: must be from 1 to {highest} in {dimension}D")));
    }
    if !(*ratio >= 1.0 && ratio.is_finite()) {
        return Err(Error::refused(format!("--ratio {ratio}: must be at least 1, the first body is the smaller one")));
    }
    let second = (!wall).then_some((*modes, *ratio));
    let tables = FilmTables::default();
    let table = if *dimension == 2 { tables.of::<2>(*modes, second) } else { tables.of::<3>(*modes, second) };
    world.on_first_rank(|| say(text(&table).trim_end()))
}

fn text(table: &FilmTable) -> String {
    let columns = ["approach", "slip", "cross", "roll"];
    let mut text = format!(
        "Resistance over viscosity, lengths in radii of the first body; lubrication films act below a gap of {:.3}\n\n{:>8}",
        table.reach(),
        "gap"
    );
    columns.iter().for_each(|name| text += &format!(" {name:>12} {:>12} {:>12}", "by modes", "missing"));
    for gap in GAPS {
        let [whole, truncated, missing] =
            [table.exact(gap), table.truncated(gap), table.missing(gap)].map(|resistance| numbers(&resistance));
        text += &format!("\n{gap:>8}");
        (0..columns.len())
            .for_each(|column| text += &format!(" {:>12.6} {:>12.6} {:>12.6}", whole[column], truncated[column], missing[column]));
    }
    text + "\n"
}

fn numbers(resistance: &Resistance) -> [f64; 4] {
    [resistance.approach, resistance.slip, resistance.cross, resistance.roll]
}
