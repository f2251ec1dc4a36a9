//! The mean settling speed of a run, read off its series.

use std::{
    fs::File,
    io::{BufRead, BufReader},
    path::{Path, PathBuf},
};

use super::context::{Context, Wanted};
use crate::{
    error::Result,
    output::{Columns, Summary},
    run::{Output, View},
};

/// Columns of the mean velocity of free bodies.
const COLUMNS: [&str; 3] = ["body_velocity_x", "body_velocity_y", "body_velocity_z"];

/// Finds the mean at the end.
pub struct MeanSettling {
    /// Where the series is.
    pub folder: PathBuf,
}

/// Where there is gravity.
pub fn wanted<const D: usize>(context: &Context<D>) -> Wanted<D> {
    context.when(context.scene.gravity.is_some(), |context| MeanSettling { folder: context.path() })
}

impl<const D: usize> Output<D> for MeanSettling {
    fn finish(&mut self, view: &View<D>, summary: &mut Summary) -> Result<Vec<String>> {
        let settling = summary.velocities.as_mut().and_then(|velocities| velocities.settling.as_mut());
        if let (0, Some(settling), Some(gravity)) = (view.world.rank(), settling, &view.scene.gravity)
            && let Some(curve) = speed_over_time(&self.folder, gravity)
        {
            settling.attach(&curve);
        }
        Ok(Vec::new())
    }
}

/// Times and mean velocities along gravity; nothing if the series has no columns of them.
fn speed_over_time(folder: &Path, gravity: &[f64]) -> Option<Vec<(f64, f64)>> {
    let file = File::open(folder.join("series.csv")).ok()?;
    along(BufReader::new(file).lines().map_while(std::io::Result::ok), gravity)
}

fn along(lines: impl Iterator<Item = String>, gravity: &[f64]) -> Option<Vec<(f64, f64)>> {
    let names = &COLUMNS[..gravity.len()];
    let table = Columns::chosen(lines, |name| name == "time" || names.contains(&name));
    let (times, columns) = (table.column("time")?, names.iter().map(|name| table.column(name)).collect::<Option<Vec<_>>>()?);
    let strength = gravity.iter().map(|component| component * component).sum::<f64>().sqrt();
    let speed = |row: usize| columns.iter().zip(gravity).map(|(column, component)| column[row] * component / strength).sum::<f64>();
    Some(times.iter().enumerate().map(|(row, time)| (*time, speed(row))).filter(|(_, speed)| speed.is_finite()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_speed_is_that_along_gravity() {
        let lines = |text: &'static str| text.lines().map(str::to_owned);
        let text = "step,time,body_velocity_x,body_velocity_y\n0,0.0,1.0,-2.0\n1,0.5,1.0,-3.0\n";
        assert_eq!(along(lines(text), &[0.0, -4.0]), Some(vec![(0.0, 2.0), (0.5, 3.0)]));
        assert_eq!(along(lines("step,time\n0,0.0\n"), &[0.0, -4.0]), None);
    }
}
