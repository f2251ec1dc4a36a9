//! The one frame of an instantaneous solve: bodies and the flow around them.

use std::path::PathBuf;

use nalgebra::SMatrix;

use super::context::{Context, Wanted};
use super::fields::FlowFields;
use super::frames::INDICES;
use crate::{
    error::Result,
    geometry::Ball,
    observe::FrameBody,
    output::{Frame, FrameBond, Frames, Summary},
    parallel::World,
    run::{FlowView, Output, View},
};

/// Writes the frame at the end.
pub struct InstantFrame {
    /// Where it goes.
    pub folder: PathBuf,
}

/// Where frames hold fields.
pub fn wanted<const D: usize>(context: &Context<D>) -> Wanted<D> {
    context.when(context.scene.stores_fields(), |context| InstantFrame { folder: context.path() })
}

impl<const D: usize> Output<D> for InstantFrame {
    fn finish(&mut self, view: &View<D>, _: &mut Summary) -> Result<Vec<String>> {
        let Some(flow) = view.flow else { return Ok(Vec::new()) };
        let setup = flow.solver.setup();
        let balls: Vec<Ball<D>> = setup.bodies.iter().map(|suspended| suspended.body.ball).collect();
        let fields = FlowFields::new(view.scene, flow.solver.grid(), &flow.solution.fluid)?.of(flow, &setup.domain, &balls)?;
        let (bodies, bonds) = (bodies(view.world, &flow), bonds(view.world, &flow));
        let frame = Frame {
            time: 0.0,
            step: 0,
            domain: &setup.domain,
            bodies: &bodies,
            contacts: None,
            bonds: bonds.as_deref(),
            membranes: None,
            fields: Some(fields),
        };
        let mut frames = Frames::create(view.world, &self.folder, view.scene.output.vtkhdf)?;
        frames.write(view.world, &frame)?;
        frames.finish(view.world)?;
        Ok(INDICES.into_iter().filter(|name| self.folder.join(name).exists()).map(str::to_owned).collect())
    }
}

/// All bodies, which every rank knows, on the first rank; none elsewhere.
fn bodies<const D: usize>(world: &World, flow: &FlowView<D>) -> Vec<FrameBody<D>> {
    let all = flow.solver.setup().bodies.iter().zip(&flow.solution.bodies).enumerate();
    let body = |(number, (suspended, state)): (usize, (&crate::setup::SuspendedBody<D>, &crate::system::BodyState<D>))| FrameBody {
        number,
        center: state.center,
        radius: suspended.body.ball.radius,
        velocity: state.twist.velocity,
        spin: state.twist.spin,
        rotation: SMatrix::identity(),
        force: state.force,
        torque: state.torque,
        contacts: 0,
    };
    if world.rank() == 0 { all.map(body).collect() } else { Vec::new() }
}

/// All bonds on the first rank, none elsewhere; nothing without any.
fn bonds<const D: usize>(world: &World, flow: &FlowView<D>) -> Option<Vec<FrameBond<D>>> {
    let setup = flow.solver.setup();
    let mut pairs = setup.interactions.bonds();
    if pairs.is_empty() {
        return None;
    }
    pairs.sort_unstable();
    let (chains, center) = (setup.interactions.group_of(), |body: usize| setup.bodies[body].body.ball.center);
    let bond = |bodies: [usize; 2]| FrameBond {
        bodies,
        chain: chains[bodies[0]].expect("what is tied belongs to a chain"),
        from: center(bodies[0]),
        way: setup.domain.nearest_image(center(bodies[1]) - center(bodies[0])),
    };
    Some(if world.rank() == 0 { pairs.into_iter().map(bond).collect() } else { Vec::new() })
}
