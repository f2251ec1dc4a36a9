//! `probe.csv`: the flow of the end on a lattice of points.

use std::path::PathBuf;

use super::context::{Context, Wanted, boxed};
use crate::{
    error::Result,
    observe::velocity_probe,
    output::Summary,
    run::{Output, View},
};

/// Writes the probe at the end.
pub struct ProbeFile {
    /// Where it goes.
    pub folder: PathBuf,
    /// Points along each axis.
    pub points: usize,
}

/// With `output.probe`.
pub fn wanted<const D: usize>(context: &Context<D>) -> Wanted<D> {
    Ok(context.scene.output.probe.map(|points| boxed(ProbeFile { folder: context.path(), points })))
}

impl<const D: usize> Output<D> for ProbeFile {
    fn finish(&mut self, view: &View<D>, _: &mut Summary) -> Result<Vec<String>> {
        let Some(flow) = view.flow else { return Ok(Vec::new()) };
        let probe = velocity_probe(flow.solver, flow.solution, self.points)?.csv();
        Ok(vec![view.write_file(&self.folder, "probe.csv", probe.as_bytes())?])
    }
}
