//! `series.csv`: a row of numbers for each step; an effect that the scene does not call for has no column.

use std::{
    path::{Path, PathBuf},
    time::Instant,
};

use super::cell::{Cell, real};
use super::step_table::StepTable;
use crate::{
    error::Result,
    mechanics::EvolutionOnGrid,
    output::{Columns, CurvePoint, InertiaSummary, SteadyMean, Summary},
    parallel::World,
    run::{Output, SeriesEntry, View, quantities::seconds},
};

/// The series of a run.
pub struct SeriesFile {
    folder: PathBuf,
    /// On the first rank.
    rows: Option<StepTable>,
    last_row: Instant,
}

impl SeriesFile {
    /// Opens it for the rows from `step` on, and gives the viscosity of those before it. Collective.
    ///
    /// # Errors
    /// As [`StepTable::open`].
    pub fn open(world: &World, folder: &Path, step: usize) -> Result<(SeriesFile, Vec<CurvePoint>)> {
        let (rows, kept) = StepTable::open(world, &folder.join("series.csv"), step)?;
        Ok((SeriesFile { folder: folder.to_owned(), rows, last_row: Instant::now() }, CurvePoint::read(&kept)))
    }
}

impl<const D: usize> Output<D> for SeriesFile {
    fn write(&mut self, view: &View<D>) -> Result<()> {
        if view.motion.is_none() {
            return Ok(());
        }
        let passed = std::mem::replace(&mut self.last_row, Instant::now()).elapsed().as_secs_f64();
        let cell = |SeriesEntry { column, number }: &SeriesEntry| (column.name.clone().into(), number.text());
        let row: Vec<Cell> = view.row.iter().map(cell).chain([real(seconds().name.clone(), passed)]).collect();
        view.world.agree(self.rows.as_mut().map_or(Ok(()), |rows| rows.write(&row)))
    }

    fn finish(&mut self, view: &View<D>, summary: &mut Summary) -> Result<Vec<String>> {
        if let Some(flow) = &view.flow {
            let (solver, evolution) = (flow.solver, flow.solver.evolution_on_grid());
            let layer = evolution.map_or(Ok(None), EvolutionOnGrid::thinnest_layer)?.filter(|layer| layer.is_finite());
            summary.inertia = view.inertia()?.map(|numbers| InertiaSummary::new(numbers, layer, solver.grid().spacing().max()));
        }
        view.world.agree(self.rows.as_ref().map_or(Ok(()), StepTable::refuse_change))?;
        let path = self.folder.join("series.csv");
        // a mean over all strains of a shear that changes means nothing
        let steady = view.scene.changing_shear().is_none();
        let mut means = || Columns::read(&path).map(|series| SteadyMean::attach(&mut summary.quantities, &series));
        view.world.agree(if steady && view.world.rank() == 0 && path.exists() { means() } else { Ok(()) })?;
        Ok(vec!["series.csv".to_owned()].into_iter().filter(|name| self.folder.join(name).exists()).collect())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::observe::{Part, Parts};

    #[test]
    fn what_is_kept_of_a_series_gives_back_its_viscosity() {
        let rows = ["0,-0.0,1.5,-0.5,", "1,-0.1,1.75,-0.25,0.125", "2,-0.2,1.625,0.0,0.25"].join("\n");
        let text = format!("step,strain,viscosity_hydrodynamic,first_normal_difference,particle_pressure\n{rows}\n");
        let kept = CurvePoint::read(&text);
        let expected = CurvePoint {
            strain: -0.1,
            parts: Parts::of(|part| (part == Part::Hydrodynamic).then_some(1.75)),
            first_normal_difference: -0.25,
            second_normal_difference: None,
            particle_pressure: Some(0.125),
        };
        assert_eq!((kept.len(), kept[1]), (3, expected));
        assert_eq!(CurvePoint::read("step,time\n0,0.0\n"), []);
    }
}
