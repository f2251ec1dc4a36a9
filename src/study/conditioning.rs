//! How hard the linear systems are as the grid is refined: condition numbers, iterations, seconds and memory, beside what theory predicts.
//!
//! The scalar Laplacian with several preconditioners, the multipliers of disks by all methods, and the fluid without bodies.

mod energy;
mod fluid;
mod grids;
mod growth;
mod laplacian;
mod multipliers;
mod preconditioning;
mod report;
mod rigidity;
mod text;

use std::path::{Path, PathBuf};

use self::{
    grids::grids,
    growth::Growth,
    laplacian::{LaplacianSolve, Problem, WANTED},
    multipliers::MultiplierGrowth,
    preconditioning::Preconditioning,
    report::ConditioningReport,
};
use super::command::{Study, count};
use crate::{
    error::Result,
    output::{prepare_folder, say, write_whole},
    petsc::Session,
};

/// Coarsest grids of the Laplacian, in cells per side.
const COARSEST: [usize; 2] = [16, 8];

/// What to study, and where to write it.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct Conditioning {
    /// Finest grid in 2D, in cells per side.
    #[arg(long, default_value_t = 512, value_parser = count(16..=8192))]
    pub finest_2d: usize,
    /// Finest grid in 3D, in cells per side.
    #[arg(long, default_value_t = 96, value_parser = count(8..=512))]
    pub finest_3d: usize,
    /// Folder for conditioning.csv, conditioning.json and the charts (default: none is written).
    #[arg(long)]
    pub out: Option<PathBuf>,
}

impl Study<Session> for Conditioning {
    const NAME: &'static str = "conditioning";
    const ABOUT: &'static str =
        "Condition numbers, iterations, seconds and memory of the linear systems against the grid, and what theory predicts";

    /// Makes the study, prints its tables part by part and writes them.
    fn run(&self, session: &Session) -> Result<()> {
        let world = session.world();
        let say = |text: String| world.on_first_rank(|| say(&(text + "\n")));
        let write = |work: &dyn Fn(&Path) -> Result<()>| match &self.out {
            Some(folder) => world.on_first_rank(|| work(folder)),
            None => Ok(()),
        };
        write(&prepare_folder)?;
        say(text::introduction(world.size()))?;
        let (solves, growth) = self.laplacian(session)?;
        say(text::eigenvalues(&solves))?;
        [2, 3].into_iter().try_for_each(|dimension| say(text::preconditioners(&solves, &growth, dimension)))?;
        let rows = multipliers::constrained(session)?;
        let multiplier_growth = MultiplierGrowth::of(&rows);
        say(text::multipliers(&rows, &multiplier_growth))?;
        let rigidity = rigidity::rigidity(session)?;
        say(text::rigidity(&rigidity))?;
        let fluid = fluid::fluid(session, [self.finest_2d, self.finest_3d])?;
        say(text::fluid(&fluid))?;
        let (ranks, wanted_error) = (world.size(), WANTED);
        let report =
            ConditioningReport { ranks, wanted_error, laplacian: solves, growth, multipliers: rows, multiplier_growth, rigidity, fluid };
        write(&|folder| report.files().iter().try_for_each(|(name, text)| write_whole(&folder.join(name), text.as_bytes())))?;
        if let Some(folder) = &self.out {
            say(format!("files: {}: {}", folder.display(), report.files().map(|(name, _)| name).join(", ")))?;
        }
        Ok(())
    }
}

impl Conditioning {
    /// All grids with all preconditioners, and how they grow.
    fn laplacian(&self, session: &Session) -> Result<(Vec<LaplacianSolve>, Vec<Growth>)> {
        let mut solves = Vec::new();
        for cells in grids(COARSEST[0], self.finest_2d) {
            solves.extend(all_preconditionings::<2>(session, cells)?);
        }
        for cells in grids(COARSEST[1], self.finest_3d) {
            solves.extend(all_preconditionings::<3>(session, cells)?);
        }
        let growth = |dimension: usize| Preconditioning::ALL.map(|method| Growth::of(&solves, dimension, method));
        let growth = [2, 3].into_iter().flat_map(growth).collect();
        Ok((solves, growth))
    }
}

fn all_preconditionings<const D: usize>(session: &Session, cells: usize) -> Result<Vec<LaplacianSolve>> {
    let problem = Problem::<D>::new(session, cells)?;
    Preconditioning::ALL.iter().map(|&method| problem.solve(method)).collect()
}
