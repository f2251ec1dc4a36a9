//! `picture.svg`, or `picture.png` of a dry scene: the end of a run.

use std::path::PathBuf;

use super::context::{Context, Wanted};
use crate::{
    error::Result,
    observe::{Plane, picture, species_of},
    output::Summary,
    run::{Output, View},
    scene::Colour,
};

/// Width in pixels of the picture of dry bodies.
const WIDTH: usize = 800;

/// Draws the picture at the end.
pub struct PictureFile {
    /// Where it goes.
    pub folder: PathBuf,
}

/// With `output.picture`.
pub fn wanted<const D: usize>(context: &Context<D>) -> Wanted<D> {
    context.when(context.scene.output.picture, |context| PictureFile { folder: context.path() })
}

impl<const D: usize> Output<D> for PictureFile {
    fn finish(&mut self, view: &View<D>, _: &mut Summary) -> Result<Vec<String>> {
        let (name, bytes) = match (&view.flow, &view.motion) {
            (Some(flow), _) => {
                let lines = view.motion.as_ref().map_or(Vec::new(), |motion| motion.force_lines());
                let time = view.motion.as_ref().map(|motion| motion.state().time);
                let cut = picture(view.scene, flow.solver, flow.solution, time, &lines)?;
                ("picture.svg", cut.svg().into_bytes())
            }
            (None, Some(motion)) => {
                let plane = Plane::of(view.scene);
                let bodies = motion.bodies_on_first_rank(view.world);
                let groups = match view.scene.output.colour {
                    Colour::Species => species_of(&bodies.iter().map(|body| body.radius).collect::<Vec<_>>()),
                    _ => motion.simulation.interactions().group_of(),
                };
                let mut still = plane.frame(motion.state().time, motion.domain().shift(), bodies, &groups, None);
                still.wall = plane.wall(view.scene, motion.domain().size.as_slice());
                if D == 2 {
                    still.contacts = motion.lines_on_first_rank(view.world, plane.axes());
                }
                ("picture.png", plane.film(view.scene).apng(WIDTH, 1.0, vec![still]))
            }
            (None, None) => return Ok(Vec::new()),
        };
        Ok(vec![view.write_file(&self.folder, name, &bytes)?])
    }
}
