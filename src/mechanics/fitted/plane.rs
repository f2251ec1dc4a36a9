//! What a setup is on a mesh, in two dimensions and per unit viscosity, and back.

use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

use crate::{
    body::{Motion, Twist, components, skew},
    error::Result,
    fitted::{DiskMotion, EdgeLengths, Load, Mesh, MeshInertia, PlaneTwist, StokesNumbering, StokesProblem, generate},
    flow::Drive,
    geometry::{Axis, Ball, Domain},
    setup::Setup,
    system::BodyState,
};

/// Numbers of triangles and unknowns of a setup with its bodies where they start.
///
/// # Errors
/// No mesh fits.
pub fn size<const D: usize>(setup: &Setup<D>) -> Result<(usize, usize)> {
    let disks: Vec<Ball<2>> = setup.bodies.iter().map(|suspended| flat_disk(&suspended.body.ball)).collect();
    let (domain, motions) = (plane(&setup.domain), motions(setup));
    let mesh = generate(&domain, &disks, edge_lengths(setup))?;
    Ok((mesh.triangles.len(), StokesNumbering::new(&problem(setup, &mesh, &motions, None)).unknowns()))
}

/// The edges of a setup's mesh: with inertia, every step takes new factors, and edges grow where no disk is near.
pub fn edge_lengths<const D: usize>(setup: &Setup<D>) -> EdgeLengths {
    let growing = setup.inertia.is_some() && !setup.bodies.is_empty();
    if growing { EdgeLengths::growing(setup.spacing, &flat(&setup.domain.size)) } else { setup.spacing.into() }
}

/// A ball in two dimensions.
pub fn flat_disk<const D: usize>(ball: &Ball<D>) -> Ball<2> {
    Ball { center: flat(&ball.center), radius: ball.radius }
}

/// What a setup is on a mesh, in a step with this inertia.
pub fn problem<'a, const D: usize>(
    setup: &Setup<D>,
    mesh: &'a Mesh,
    motions: &'a [DiskMotion],
    inertia: Option<&'a MeshInertia>,
) -> StokesProblem<'a> {
    let (drive, domain, viscosity) = (&setup.drive, &setup.domain, setup.viscosity);
    let background = match drive {
        Drive::Shear(rate) => Matrix2::new(0.0, *rate, 0.0, 0.0),
        _ => Matrix2::zeros(),
    };
    let uniform = drive.uniform_force();
    let mean_velocity = [0, 1].map(|axis| match drive {
        Drive::MeanVelocity(velocity) if domain.periodic(axis) => Some(velocity[axis]),
        Drive::Rest | Drive::Shear(_) if domain.fully_periodic() => Some(0.0),
        _ => None,
    });
    StokesProblem {
        mesh,
        motions,
        background,
        on_fluid: flat(&uniform) / viscosity,
        on_disks: flat(&(uniform - drive.force_on_fluid_alone())) / viscosity,
        mean_velocity,
        inertia,
    }
}

/// How the bodies of a setup move, per unit viscosity.
pub fn motions<const D: usize>(setup: &Setup<D>) -> Vec<DiskMotion> {
    setup.bodies.iter().map(|suspended| disk_motion(&suspended.body.motion, setup.viscosity)).collect()
}

/// A vector in two dimensions.
pub fn flat<const D: usize>(vector: &SVector<f64, D>) -> Vector2<f64> {
    Vector2::new(vector[0], vector[1])
}

/// A vector of the plane in the dimension of the scene.
pub fn spatial<const D: usize>(vector: &Vector2<f64>) -> SVector<f64, D> {
    SVector::from_fn(|axis, _| vector[axis])
}

/// The box in two dimensions.
pub fn plane<const D: usize>(domain: &Domain<D>) -> Domain<2> {
    let axis = |axis: usize| match domain.axes[axis] {
        Axis::Periodic => Axis::Periodic,
        Axis::Sheared(slide) => Axis::Sheared(slide),
        Axis::Walls { lower, upper } => Axis::Walls { lower: flat(&lower), upper: flat(&upper) },
        Axis::MovingWalls { upper, time } => Axis::MovingWalls { upper, time },
        Axis::Open(inflow) => Axis::Open(inflow),
    };
    Domain { size: flat(&domain.size), axes: [axis(0), axis(1)] }
}

fn disk_motion<const D: usize>(motion: &Motion<D>, viscosity: f64) -> DiskMotion {
    match motion {
        Motion::Free { force, torque } => DiskMotion::Free { force: flat(force) / viscosity, torque: components(torque)[0] / viscosity },
        Motion::Prescribed(twist) => DiskMotion::Given(rigid(twist)),
    }
}

/// A motion in two dimensions.
pub fn rigid<const D: usize>(twist: &Twist<D>) -> PlaneTwist {
    PlaneTwist { velocity: flat(&twist.velocity), spin: components(&twist.spin)[0] }
}

/// What is found for a body.
pub fn state<const D: usize>(disk: &Ball<2>, rigid: &PlaneTwist, load: &Load, viscosity: f64) -> BodyState<D> {
    BodyState {
        center: spatial(&disk.center),
        twist: Twist { velocity: spatial(&rigid.velocity), spin: skew(&[rigid.spin]) },
        force: spatial(&(viscosity * load.force)),
        torque: skew(&[viscosity * load.torque]),
        stresslet: SMatrix::from_fn(|row, column| viscosity * load.stresslet[(row, column)]),
    }
}
