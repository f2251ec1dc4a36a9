//! `series.csv`: a row of numbers for each step; an effect that the scene does not call for has no column.

use std::{
    path::{Path, PathBuf},
    time::Instant,
};

use super::cell::{Cell, absent, count, finite, real};
use super::means::{mean_motion, of_stress, upper_triangle};
use super::step_table::StepTable;
use crate::{
    contact::Solver,
    error::Result,
    mechanics::{EvolutionOnGrid, State},
    motion::Simulation,
    observe::{ChainNumbers, InertialNumbers, MembraneNumbers, Viscosity, mean_orientation},
    output::{CurvePoint, InertiaSummary, Summary},
    parallel::World,
    run::{ContactTotals, Evaluated, EvaluatedFlow, EvaluatedMotion, Output},
    scene::ContactModel,
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
    fn write(&mut self, seen: &Evaluated<D>) -> Result<()> {
        let Some(motion) = &seen.motion else { return Ok(()) };
        let seconds = std::mem::replace(&mut self.last_row, Instant::now()).elapsed().as_secs_f64();
        let totals = motion.contact_totals(seen.world);
        let mut row = cells(motion, (seen.scene.contact.model, totals), seen.viscosity);
        row.extend(of_friction(motion, seen.scene.contact.friction));
        row.extend(seen.flow.map_or(Ok(Vec::new()), |flow| of_inertia(&flow, motion.state()))?);
        row.extend(of_chains(motion.simulation));
        row.extend(of_membranes(motion.simulation));
        row.extend(of_clusters(seen.world, motion.simulation));
        row.extend(mean_motion(seen, motion));
        row.extend(seen.viscosity.map_or(Vec::new(), |viscosity| of_stress::<D>(&viscosity)));
        row.push(real("seconds", seconds));
        seen.world.agree(self.rows.as_mut().map_or(Ok(()), |rows| rows.write(&row)))
    }

    fn finish(&mut self, seen: &Evaluated<D>, summary: &mut Summary) -> Result<Vec<String>> {
        if let Some(flow) = &seen.flow {
            let start = seen.motion.is_none_or(|motion| motion.state().steps == 0);
            let (solver, evolution) = (flow.solver, flow.solver.evolution_on_grid());
            let layer = evolution.map_or(Ok(None), EvolutionOnGrid::thinnest_layer)?.filter(|layer| layer.is_finite());
            let numbers = InertialNumbers::of(solver.setup(), solver.grid(), flow.solution, start)?;
            summary.inertia = numbers.map(|numbers| InertiaSummary::new(numbers, layer, solver.grid().spacing().max()));
        }
        seen.world.agree(self.rows.as_ref().map_or(Ok(()), StepTable::refuse_change))?;
        Ok(vec!["series.csv".to_owned()].into_iter().filter(|name| self.folder.join(name).exists()).collect())
    }
}

/// The cells of a flow with inertia after a step; none without inertia. Collective.
fn of_inertia<const D: usize>(flow: &EvaluatedFlow<D>, state: &State<D>) -> Result<Vec<Cell>> {
    let (setup, grid) = (flow.solver.setup(), flow.solver.grid());
    let Some(numbers) = InertialNumbers::of(setup, grid, flow.solution, state.steps == 0)? else { return Ok(Vec::new()) };
    let evolution = flow.solver.evolution_on_grid();
    let cells = [
        ("kinetic_energy", numbers.kinetic_energy),
        ("reynolds", numbers.reynolds),
        ("stokes", numbers.stokes),
        ("courant", numbers.courant(grid, state.last_step)),
        ("momentum_residual", evolution.map_or(0.0, EvolutionOnGrid::momentum_residual)),
    ];
    let layer = evolution.map_or(Ok(None), EvolutionOnGrid::thinnest_layer)?.map(|layer| finite("boundary_layer", layer));
    Ok(cells.into_iter().map(|(name, value)| real(name, value)).chain(layer).collect())
}

/// The cells of friction in the step that led here; none without friction.
fn of_friction<const D: usize>(motion: &EvaluatedMotion<D>, coefficient: f64) -> Vec<Cell> {
    if coefficient == 0.0 {
        return Vec::new();
    }
    let kept = motion.statistics.last().and_then(|last| last.kkt_report).and_then(|kept| kept.friction).unwrap_or_default();
    vec![
        real("friction_residual", kept.residual),
        count("sticking", kept.sticking),
        count("slipping", kept.slipping),
        real("contact_work", kept.work),
        count("friction_sweeps", kept.sweeps),
        count("friction_iterations", kept.iterations),
    ]
}

/// The cells of chains; none without chains. Collective.
fn of_chains<const D: usize>(simulation: &Simulation<D>) -> Vec<Cell> {
    if simulation.interactions().chains().is_empty() {
        return Vec::new();
    }
    const NAMES: [&str; 6] = [
        "chain_orientation_xx",
        "chain_orientation_xy",
        "chain_orientation_xz",
        "chain_orientation_yy",
        "chain_orientation_yz",
        "chain_orientation_zz",
    ];
    let cells = |numbers: ChainNumbers<D>| {
        let own = [
            ("bond_energy", numbers.bond_energy),
            ("end_to_end", numbers.end_to_end),
            ("gyration", numbers.gyration),
            ("curvature", numbers.curvature),
        ];
        // chains without a bead between two others have no curvature
        let columns = own.into_iter().filter(|(_, value)| value.is_finite()).chain(upper_triangle(&NAMES, &numbers.orientation));
        columns.map(|(name, value)| real(name, value)).collect::<Vec<_>>()
    };
    ChainNumbers::of(simulation.interactions(), &simulation.whole_state().centers()).map(cells).unwrap_or_default()
}

/// Those of red cells; none without any. Collective.
fn of_membranes<const D: usize>(simulation: &Simulation<D>) -> Vec<Cell> {
    if simulation.interactions().conserved().is_empty() {
        return Vec::new();
    }
    let cells = |numbers: MembraneNumbers| {
        let error = |name: &str| match name {
            "enclosed_volume" => "volume_error",
            "surface" => "surface_error",
            _ => "area_error",
        };
        let kept = numbers.kept.iter().flat_map(|&(name, mean, worst)| [real(name, mean), real(error(name), worst)]);
        kept.chain([real("inclination", numbers.inclination), real("tread", numbers.tread)]).collect::<Vec<_>>()
    };
    MembraneNumbers::of(simulation.interactions(), &simulation.whole_state().centers()).map(cells).unwrap_or_default()
}

/// The upper triangle of the mean orientation of rigid clusters; none without any. Collective.
fn of_clusters<const D: usize>(world: &World, simulation: &Simulation<D>) -> Vec<Cell> {
    const NAMES: [&str; 6] = ["orientation_xx", "orientation_xy", "orientation_xz", "orientation_yy", "orientation_yz", "orientation_zz"];
    let cells = |mean| upper_triangle(&NAMES, &mean).map(|(name, value)| real(name, value)).collect();
    mean_orientation(world, simulation.interactions(), simulation.state()).map_or(Vec::new(), cells)
}

/// The cells of the row of an instant and of the step that led there.
fn cells<const D: usize>(
    motion: &EvaluatedMotion<D>,
    (contact, totals): (ContactModel, ContactTotals),
    viscosity: Option<Viscosity>,
) -> Vec<Cell> {
    let (state, last) = (motion.state(), motion.statistics.last());
    let mut cells = vec![count("step", state.steps), real("time", state.time), real("last_step", state.last_step)];
    if let Some(viscosity) = viscosity {
        let point = CurvePoint::of(&viscosity, state.time, contact != ContactModel::None);
        cells.extend(point.columns().into_iter().map(|(name, value)| real(name, value)));
        cells.extend(viscosity.from_walls.map(|walls| real("viscosity_from_walls", walls)));
    }
    if contact != ContactModel::None {
        let kept = last.and_then(|last| last.kkt_report);
        cells.push(count("contacts", totals.held));
        cells.extend(contact.gluey().then(|| count("stuck", totals.stuck)));
        cells.push(gap(kept.map_or(f64::INFINITY, |kept| kept.smallest_gap)));
        if matches!(contact, ContactModel::Inelastic | ContactModel::Gluey { .. }) {
            cells.push(real("kkt_residual", kept.map_or(0.0, |kept| kept.kkt_residual)));
            cells.push(real("contact_force", kept.map_or(0.0, |kept| kept.total_force)));
            cells.push(count("contact_iterations", kept.map_or(0, |kept| kept.iterations)));
            // 0 by a formula, 1 along the sparse central path, 2 by the general interior point
            cells.push(count("contact_solver", kept.map_or(Solver::Formula, |kept| kept.solver) as usize));
        }
    }
    if motion.observation.solution.is_some() {
        let effort = motion.observation.effort + last.map_or_else(Default::default, |last| last.effort);
        cells.extend([count("solves", effort.solves), count("iterations", effort.iterations)]);
    }
    cells
}

/// Readers of CSV take an empty cell for a number that is not there, but few know infinity.
fn gap(value: f64) -> Cell {
    if value == f64::INFINITY { absent("smallest_gap") } else { real("smallest_gap", value) }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use nalgebra::SMatrix;

    use super::*;
    use crate::observe::{NormalStresses, Part, Parts};

    fn point(step: usize) -> CurvePoint {
        let normal = NormalStresses { first: -0.5, second: None, pressure: Some(0.25), contact_pressure: 0.125 };
        let viscosity = Viscosity {
            rate: 1.0,
            parts: Parts::of(|part| match part {
                Part::Hydrodynamic => Some(1.5),
                Part::Contact => Some(0.25),
                _ => None,
            }),
            stress: SMatrix::zeros(),
            normal,
            from_walls: None,
        };
        CurvePoint::of(&viscosity, 0.1 * step as f64, false)
    }

    fn row(step: usize) -> Vec<Cell> {
        let viscosity = point(step).columns().into_iter().map(|(name, value)| real(name, value));
        [count("step", step), real("time", 0.1 * step as f64)].into_iter().chain(viscosity).chain([real("seconds", 0.5)]).collect()
    }

    #[test]
    fn what_is_kept_of_a_series_gives_back_its_viscosity() {
        let folder = std::env::temp_dir().join(format!("turbid-series-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let mut rows = StepTable::begin(&folder.join("series.csv"), 0).unwrap().table;
        (0..5).for_each(|step| rows.write(&row(step)).unwrap());
        let kept = StepTable::begin(&folder.join("series.csv"), 3).unwrap().kept;
        let written: Vec<CurvePoint> = (0..3).map(point).collect();
        assert_eq!(CurvePoint::read(&kept), written, "what is read back is not what was written");
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_gap_that_is_not_there_is_an_empty_cell() {
        assert_eq!([f64::INFINITY, 0.25].map(|value| gap(value).1), ["", "0.25"]);
    }
}
