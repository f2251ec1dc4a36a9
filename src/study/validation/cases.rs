//! The cases.

mod random;
mod scalar;

use std::f64::consts::PI;

use nalgebra::{SMatrix, SVector, Vector2, Vector3};

use super::Case;
use crate::{
    body::{Body, Motion, Twist},
    error::{Error, Result},
    flow::{Drive, InverseMethod},
    geometry::{Axis, Ball, Domain},
    observe::{self, Viscosity},
    petsc::Session,
    scene::{ConstraintMethod, Tolerance},
    simulation::{FlowSolver, Setup, Solution, SuspendedBody, Suspension},
};

/// Far below the errors that are measured.
const TOLERANCE: f64 = 1e-8;

const SANGANI: &str = "Sangani & Acrivos 1982, recomputed";
const ZICK: &str = "Zick & Homsy 1982, recomputed";
const SERIES: &str = "exact series, recomputed";

/// A centre in no special place on any grid.
const DISK: [f64; 2] = [0.513, 0.527];
const SPHERE: [f64; 3] = [0.513, 0.527, 0.481];

/// All cases, in the order of the table.
pub fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    for (fraction, name, reference, grids) in [
        (0.1, "drag, square array 0.1", 24.8316752488, [(24, 4, 5e-3), (32, 6, 1e-3), (64, 8, 5e-4)]),
        (0.3, "drag, square array 0.3", 102.881303670, [(16, 4, 5e-3), (32, 8, 5e-4), (64, 8, 2e-4)]),
        (0.5, "drag, square array 0.5", 532.548118463, [(16, 6, 3e-2), (32, 10, 5e-3), (64, 14, 1e-3)]),
    ] {
        all.extend(grids.map(|(cells, order, tolerance)| square_array(name, fraction, reference, cells, order, tolerance)));
    }
    for (fraction, name, reference, grids) in [
        (0.064, "drag, cubic array 0.064", 2.810198125, [(4.0, 3, 1e-2), (6.0, 5, 4e-3)]),
        (0.125, "drag, cubic array 0.125", 4.291589200, [(4.0, 3, 1e-2), (6.0, 5, 4e-3)]),
        (0.216, "drag, cubic array 0.216", 7.44195364, [(4.5, 4, 1e-2), (6.0, 5, 6e-3)]),
    ] {
        all.extend(grids.map(|(cells, order, tolerance)| cubic_array(name, fraction, reference, cells, order, tolerance)));
    }
    all.extend([
        disk_lattice("viscosity increment, square lattice 0.01", 0.01, 0.01988520959),
        disk_lattice("viscosity increment, square lattice 0.1", 0.1, 0.19222418765),
        disk_lattice("viscosity increment, square lattice 0.3", 0.3, 0.59811597742),
        sphere_lattice("viscosity increment, cubic lattice 0.01", 0.01, 0.024813427),
        sphere_lattice("viscosity increment, cubic lattice 0.027", 0.027, 0.066332554),
        couette_spin("spin, free disk in a Couette cell, L = H", 1.0, 0.485564146),
        couette_spin("spin, free disk in a Couette channel", 8.0, 0.48207921),
        couette_viscosity("viscosity from the walls, disk in a Couette cell", true),
        couette_viscosity("viscosity from stresslets, the same", false),
        pair_viscosity(),
        pair_normal_difference(),
        pulled_disk(),
        closed_box_disk(),
        closed_box_sphere(),
    ]);
    all.extend(random::cases());
    all.extend(scalar::cases());
    all
}

fn free<const D: usize>() -> Motion<D> {
    Motion::Free { force: SVector::zeros(), torque: SMatrix::zeros() }
}

fn moving<const D: usize>(velocity: SVector<f64, D>) -> Motion<D> {
    Motion::Prescribed(Twist { velocity, spin: SMatrix::zeros() })
}

fn suspended<const D: usize>(center: impl Into<SVector<f64, D>>, radius: f64, motion: Motion<D>, order: usize) -> SuspendedBody<D> {
    SuspendedBody { body: Body { ball: Ball { center: center.into(), radius }, motion }, order }
}

/// A box with sides of length 1 (along x: `length`); `walls` bound the axes that are named.
fn setup<const D: usize>(length: f64, axes: [Axis<D>; D], spacing: f64, drive: Drive<D>, bodies: Vec<SuspendedBody<D>>) -> Setup<D> {
    let size = SVector::from_fn(|axis, _| if axis == 0 { length } else { 1.0 });
    Setup {
        domain: Domain { size, axes },
        spacing,
        viscosity: 1.0,
        drive,
        bodies,
        constraint: ConstraintMethod::Sharp,
        interactions: crate::interaction::Interactions::default(),
        inverse: InverseMethod::Hypre,
        tolerance: Tolerance::Fixed(TOLERANCE),
    }
}

fn solve<const D: usize>(session: &Session, setup: Setup<D>) -> Result<(Suspension<D>, Solution<D>)> {
    let mut suspension = Suspension::new(session, setup)?;
    let solution = suspension.solve(&mut |_, _| {})?;
    Ok((suspension, solution))
}

fn measured_viscosity<const D: usize>(session: &Session, setup: Setup<D>) -> Result<Viscosity> {
    let (suspension, solution) = solve(session, setup)?;
    let viscosity = observe::viscosity(suspension.setup(), suspension.grid(), &solution, &[])?;
    viscosity.ok_or_else(|| Error::Diverged("a case of the validation is not sheared".into()))
}

fn square_array(name: &'static str, fraction: f64, reference: f64, cells: usize, order: usize, tolerance: f64) -> Case {
    let radius = (fraction / PI).sqrt();
    let solve = move |session: &Session| {
        let disk = suspended(DISK, radius, moving(Vector2::zeros()), order);
        let drive = Drive::MeanVelocity(Vector2::x());
        Ok(solve(session, setup(1.0, [Axis::Periodic; 2], 1.0 / cells as f64, drive, vec![disk]))?.1.bodies[0].force[0])
    };
    let resolution = format!("{cells} x {cells}, a/h = {:.1}, K = {order}", radius * cells as f64);
    Case { name, source: SANGANI, resolution, reference, tolerance, solve: Box::new(solve) }
}

fn cubic_array(name: &'static str, fraction: f64, reference: f64, cells_per_radius: f64, order: usize, tolerance: f64) -> Case {
    let radius = (0.75 * fraction / PI).cbrt();
    let solve = move |session: &Session| {
        let sphere = suspended(SPHERE, radius, moving(Vector3::zeros()), order);
        let drive = Drive::MeanVelocity(Vector3::x());
        let (_, solution) = solve(session, setup(1.0, [Axis::Periodic; 3], radius / cells_per_radius, drive, vec![sphere]))?;
        Ok(solution.bodies[0].force[0] / (6.0 * PI * radius))
    };
    let resolution = format!("a/h = {cells_per_radius:.1}, L = {order}");
    Case { name, source: ZICK, resolution, reference, tolerance, solve: Box::new(solve) }
}

fn disk_lattice(name: &'static str, fraction: f64, reference: f64) -> Case {
    let radius = (fraction / PI).sqrt();
    let solve = move |session: &Session| {
        let disk = suspended(DISK, radius, free(), 8);
        let sheared = setup(1.0, [Axis::Periodic; 2], radius / 8.0, Drive::Shear(1.0), vec![disk]);
        Ok(measured_viscosity(session, sheared)?.relative() - 1.0)
    };
    Case { name, source: SERIES, resolution: "a/h = 8, K = 8".into(), reference, tolerance: 3e-3, solve: Box::new(solve) }
}

fn sphere_lattice(name: &'static str, fraction: f64, reference: f64) -> Case {
    let radius = (0.75 * fraction / PI).cbrt();
    let solve = move |session: &Session| {
        let sphere = suspended(SPHERE, radius, free(), 4);
        let sheared = setup(1.0, [Axis::Periodic; 3], radius / 5.0, Drive::Shear(1.0), vec![sphere]);
        Ok(measured_viscosity(session, sheared)?.relative() - 1.0)
    };
    Case {
        name,
        source: "Nunan & Keller 1984, recomputed",
        resolution: "a/h = 5, L = 4".into(),
        reference,
        tolerance: 1e-2,
        solve: Box::new(solve),
    }
}

/// Walls at the ends of the second axis that move at -1/2 and 1/2 along the first.
fn sliding() -> [Axis<2>; 2] {
    [Axis::Periodic, Axis::Walls { lower: Vector2::x() * -0.5, upper: Vector2::x() * 0.5 }]
}

fn couette_spin(name: &'static str, length: f64, reference: f64) -> Case {
    let solve = move |session: &Session| {
        let disk = suspended([0.513, 0.5], 0.125, free(), 6);
        Ok(-solve(session, setup(length, sliding(), 1.0 / 64.0, Drive::Rest, vec![disk]))?.1.bodies[0].twist.spin[(1, 0)])
    };
    Case { name, source: SERIES, resolution: "a/h = 8, K = 6".into(), reference, tolerance: 3e-3, solve: Box::new(solve) }
}

fn couette_viscosity(name: &'static str, from_walls: bool) -> Case {
    let solve = move |session: &Session| {
        let disk = suspended([0.513, 0.5], 0.2, free(), 8);
        let viscosity = measured_viscosity(session, setup(1.0, sliding(), 1.0 / 40.0, Drive::Rest, vec![disk]))?;
        Ok(if from_walls { viscosity.from_walls.unwrap_or(f64::NAN) } else { viscosity.relative() })
    };
    let resolution = "a/h = 8, K = 8".into();
    Case { name, source: SERIES, resolution, reference: 1.291011445, tolerance: 2e-3, solve: Box::new(solve) }
}

fn pair_viscosity() -> Case {
    let solve = |session: &Session| {
        let disks = [[0.3, 0.4], [0.65, 0.62]].map(|center| suspended(center, 0.15, free(), 9));
        Ok(measured_viscosity(session, setup(1.0, sliding(), 1.0 / 60.0, Drive::Rest, disks.to_vec()))?.relative())
    };
    Case {
        name: "viscosity, two disks in a Couette cell",
        source: SERIES,
        resolution: "a/h = 9, K = 9".into(),
        reference: 1.3813693532,
        tolerance: 2e-3,
        solve: Box::new(solve),
    }
}

fn pair_normal_difference() -> Case {
    let solve = |session: &Session| {
        let disks = [[0.3, 0.4], [0.65, 0.62]].map(|center| suspended(center, 0.15, free(), 10));
        Ok(measured_viscosity(session, setup(1.0, [Axis::Periodic; 2], 1.0 / 64.0, Drive::Shear(1.0), disks.to_vec()))?.normal.first)
    };
    Case {
        name: "first normal stress difference, two disks in a periodic box",
        source: SERIES,
        resolution: "a/h = 9.6, K = 10".into(),
        reference: 0.074669119,
        tolerance: 1e-2,
        solve: Box::new(solve),
    }
}

fn still<const D: usize>() -> Axis<D> {
    Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() }
}

fn pulled_disk() -> Case {
    let solve = |session: &Session| {
        let disk = suspended([0.513, 0.5], 0.125, moving(Vector2::x()), 8);
        let drive = Drive::MeanVelocity(Vector2::zeros());
        Ok(-solve(session, setup(1.0, [Axis::Periodic, still()], 1.0 / 64.0, drive, vec![disk]))?.1.bodies[0].force[0])
    };
    Case {
        name: "drag, disk pulled along a channel, zero flux",
        source: SERIES,
        resolution: "a/h = 8, K = 8".into(),
        reference: 21.9145884,
        tolerance: 5e-3,
        solve: Box::new(solve),
    }
}

fn closed_box_disk() -> Case {
    let solve = |session: &Session| {
        let disk = suspended([0.5, 0.5], 0.2, moving(Vector2::x()), 8);
        Ok(-solve(session, setup(1.0, [still(); 2], 1.0 / 48.0, Drive::Rest, vec![disk]))?.1.bodies[0].force[0])
    };
    Case {
        name: "drag, disk in a closed box",
        source: SERIES,
        resolution: "a/h = 9.6, K = 8".into(),
        reference: 55.04312168,
        tolerance: 5e-3,
        solve: Box::new(solve),
    }
}

fn closed_box_sphere() -> Case {
    let solve = |session: &Session| {
        let sphere = suspended([0.5; 3], 0.2, moving(Vector3::x()), 4);
        let (_, solution) = solve(session, setup(1.0, [still(); 3], 1.0 / 25.0, Drive::Rest, vec![sphere]))?;
        Ok(-solution.bodies[0].force[0] / (6.0 * PI * 0.2))
    };
    Case {
        name: "drag over Stokes drag, sphere in a closed box",
        source: SERIES,
        resolution: "a/h = 5, L = 4".into(),
        reference: 3.12345,
        tolerance: 1e-2,
        solve: Box::new(solve),
    }
}
