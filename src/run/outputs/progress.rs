//! The progress line as an output.

use crate::{
    error::Result,
    output::Summary,
    run::{Output, Progress, TimeProgress, View},
};

impl<const D: usize> Output<D> for Progress {
    fn iterate(&mut self, iteration: usize, residual: f64) {
        self.show(iteration, residual);
    }

    fn write(&mut self, _: &View<D>) -> Result<()> {
        self.end();
        Ok(())
    }
}

impl<const D: usize> Output<D> for TimeProgress {
    fn write(&mut self, view: &View<D>) -> Result<()> {
        if let Some(motion) = &view.motion {
            self.show(motion.state().time, motion.state().steps, view.history.mean());
        }
        Ok(())
    }

    fn finish(&mut self, _: &View<D>, _: &mut Summary) -> Result<Vec<String>> {
        self.end();
        Ok(Vec::new())
    }
}
