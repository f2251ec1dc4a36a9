//! What a flow with inertia brings from earlier times: velocities at the nodes of a mesh, which move along with it.

use nalgebra::Vector2;

use super::plane::rigid;
use crate::{
    error::Result,
    fitted::{DiskInertia, Locator, Mesh, MeshInertia, Momentum, MovingMesh, Place, PlaneTwist, Projection, velocity},
    mechanics::{
        MeshLevel,
        unsteady::{StepWeights, inertia},
    },
    petsc::Session,
    setup::{Setup, SuspendedBody},
    surface::Shape,
};

/// The last solution and those from which its step started, all at the nodes of one mesh.
#[derive(Debug, Default)]
pub struct MeshHistory {
    /// The last solution.
    pub current: Option<MeshLevel>,
    /// Those before it, the last one first.
    pub past: Vec<MeshLevel>,
}

impl MeshHistory {
    /// Makes the last solution a past one, if time has gone on.
    pub fn settle(&mut self, time: f64) {
        if let Some(level) = self.current.take_if(|level| level.time < time) {
            self.past.insert(0, level);
            self.past.truncate(2);
        }
    }

    /// Goes over from one mesh to another.
    ///
    /// # Errors
    /// The meshes do not lie in the same box, or PETSc fails.
    pub fn change_mesh(&mut self, old: &Mesh, new: &mut MovingMesh, session: &Session) -> Result<()> {
        self.past.iter_mut().try_for_each(|level| {
            *level = on_other_mesh(level, old, new, session)?;
            Ok(())
        })
    }

    /// The largest component of the last velocity.
    pub fn fastest(&self) -> f64 {
        self.current.iter().flat_map(|level| &level.velocities).map(|velocity| velocity.amax()).fold(0.0, f64::max)
    }

    /// What a step to a mesh at a time takes of the past; nothing before the first one.
    pub fn inertia<const D: usize>(&self, setup: &Setup<D>, mesh: &Mesh, time: f64) -> Option<MeshInertia> {
        let last = self.past.first()?.time;
        let weights = StepWeights::new(time - last, self.past.get(1).map(|level| last - level.time));
        let ([rate, past @ ..], masses) = (weights.rate, inertia(setup));
        let sum = |weights: &[f64; 2], of: &dyn Fn(&MeshLevel) -> Vector2<f64>| -> Vector2<f64> {
            self.past.iter().zip(weights).map(|(level, weight)| of(level) * *weight).sum()
        };
        let given = |node: usize| match mesh.places[node] {
            Place::Fluid => None,
            Place::Surface(disk) => {
                let motion = setup.bodies[disk].body.given_motion()?;
                Some(rigid(&motion).at(&mesh.arm(disk, &mesh.nodes[node])))
            }
            Place::Wall(walls) => Some(mesh.wall_velocity(walls)),
        };
        let carrying = |node: usize| {
            let of_mesh = rate * mesh.nodes[node] + sum(&past, &|level| level.nodes[node]);
            given(node).unwrap_or_else(|| sum(&weights.extrapolation, &|level| level.velocities[node])) - of_mesh
        };
        let disk = |(disk, suspended): (usize, &SuspendedBody<D>)| {
            let (ball, density) = (&suspended.body.ball, masses.bodies[disk] / setup.viscosity);
            let velocity = sum(&past, &|level| level.motions[disk].velocity);
            let spin = self.past.iter().zip(past).map(|(level, weight)| level.motions[disk].spin * weight).sum();
            DiskInertia {
                mass: density * ball.volume(),
                moment: density * ball.moment_of_inertia(),
                history: PlaneTwist { velocity, spin },
            }
        };
        Some(MeshInertia {
            density: masses.fluid / setup.viscosity,
            rate,
            history: (0..mesh.nodes.len()).map(|node| sum(&past, &|level| level.velocities[node])).collect(),
            carrying: (0..mesh.nodes.len()).map(carrying).collect(),
            disks: setup.bodies.iter().enumerate().map(disk).collect(),
        })
    }
}

/// The same flow on another mesh, where that has its nodes at this time: the nearest one with its momentum.
fn on_other_mesh(level: &MeshLevel, old: &Mesh, new: &mut MovingMesh, session: &Session) -> Result<MeshLevel> {
    let mesh = new.at(session, &level.centers)?;
    let disks = mesh.disks.clone();
    let here = Mesh { nodes: level.nodes.clone(), disks, ..old.clone() };
    let given = |(node, place): (&Vector2<f64>, &Place)| match *place {
        Place::Fluid => None,
        Place::Surface(disk) => Some(level.motions[disk].at(&mesh.arm(disk, node))),
        Place::Wall(walls) => Some(mesh.wall_velocity(walls)),
    };
    let given = mesh.nodes.iter().zip(&mesh.places).map(given).collect();
    let (locator, momentum) = (Locator::new(&here), Momentum::of(&here, &level.velocities)?);
    let at = |point: &Vector2<f64>| velocity(&locator, &level.velocities, |disk, arm| level.motions[disk].at(arm), point);
    let velocities = Projection::new(&mesh, given)?.solve(session, at, &momentum)?;
    Ok(MeshLevel { nodes: mesh.nodes, velocities, centers: level.centers.clone(), motions: level.motions.clone(), ..*level })
}
