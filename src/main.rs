//! scratch
use nalgebra::*;
use turbid::{body::*, flow::*, geometry::*, petsc::*, simulation::*};
fn array(s: &Session, n: usize, k: usize, phi: f64) {
    let a = (phi / std::f64::consts::PI).sqrt();
    let setup = Setup::<2> {
        domain: Domain { size: SVector::repeat(1.0), axes: [Axis::Periodic; 2] },
        spacing: 1.0 / n as f64,
        viscosity: 1.0,
        drive: Drive::MeanVelocity(Vector2::x()),
        bodies: vec![SuspendedBody {
            body: Body { ball: Ball { center: Vector2::new(0.513, 0.527), radius: a }, motion: Motion::Prescribed(Twist::zero()) },
            order: k,
        }],
        tolerance: 1e-9,
    };
    let mut sim = Simulation::new(s, setup).unwrap();
    let sol = sim.solve(&mut |_, _| {}).unwrap();
    if s.world().rank() == 0 {
        println!(
            "array phi {phi} n {n} K {k}: F {:?} its {} {:?}",
            sol.bodies[0].force,
            sim.cost().krylov.iterations,
            sol.pressure_gradient
        );
    }
}
fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let s = Session::start(&args).unwrap();
    turbid::parallel::abort_on_panic();
    for (n, k) in [(16, 4), (32, 8), (64, 8)] {
        array(&s, n, k, 0.3);
    }
    for phi in [0.01, 0.1, 0.3] {
        lattice(&s, phi, 8.0, 8);
    }
    for l in [1.0, 4.0, 8.0] {
        couette(&s, 8.0, 6, l);
    }
    for (p, ah) in [(0.064, 4.0), (0.125, 4.0), (0.064, 6.0), (0.216, 6.0), (0.45, 5.7)] {
        for l in [3, 5] {
            cubic(&s, p, ah, l);
        }
    }
}
const FREE2: Motion<2> = Motion::Free { force: SVector::<f64, 2>::new(0.0, 0.0), torque: SMatrix::<f64, 2, 2>::new(0.0, 0.0, 0.0, 0.0) };
fn lattice(s: &Session, phi: f64, ah: f64, k: usize) {
    let a = (phi / std::f64::consts::PI).sqrt();
    let setup = Setup::<2> {
        domain: Domain { size: SVector::repeat(1.0), axes: [Axis::Periodic; 2] },
        spacing: a / ah,
        viscosity: 1.0,
        drive: Drive::Shear(1.0),
        bodies: vec![SuspendedBody {
            body: Body { ball: Ball { center: Vector2::new(0.513, 0.527), radius: a }, motion: FREE2 },
            order: k,
        }],
        tolerance: 1e-9,
    };
    let mut sim = Simulation::new(s, setup).unwrap();
    let sol = sim.solve(&mut |_, _| {}).unwrap();
    if s.world().rank() == 0 {
        let b = &sol.bodies[0];
        println!(
            "lattice phi {phi} ah {ah} K {k}: visc {:.6} spin {:.8} V {:?} its {}",
            1.0 + b.stresslet[(0, 1)],
            b.twist.spin[(1, 0)],
            b.twist.velocity,
            sim.cost().krylov.iterations
        );
    }
}
fn couette(s: &Session, ah: f64, k: usize, l: f64) {
    let a = 0.125;
    let w = Axis::Walls { lower: Vector2::new(-0.5, 0.0), upper: Vector2::new(0.5, 0.0) };
    let setup = Setup::<2> {
        domain: Domain { size: Vector2::new(l, 1.0), axes: [Axis::Periodic, w] },
        spacing: a / ah,
        viscosity: 1.0,
        drive: Drive::Rest,
        bodies: vec![SuspendedBody { body: Body { ball: Ball { center: Vector2::new(0.513, 0.5), radius: a }, motion: FREE2 }, order: k }],
        tolerance: 1e-9,
    };
    let mut sim = Simulation::new(s, setup).unwrap();
    let sol = sim.solve(&mut |_, _| {}).unwrap();
    if s.world().rank() == 0 {
        let b = &sol.bodies[0];
        println!(
            "couette L {l} ah {ah} K {k}: visc {:.6} spin {:.8} V {:?} its {}",
            1.0 + b.stresslet[(0, 1)] / l,
            b.twist.spin[(1, 0)],
            b.twist.velocity,
            sim.cost().krylov.iterations
        );
    }
}
fn cubic(s: &Session, phi: f64, ah: f64, l: usize) {
    let a = (phi * 0.75 / std::f64::consts::PI).powf(1.0 / 3.0);
    let setup = Setup::<3> {
        domain: Domain { size: SVector::repeat(1.0), axes: [Axis::Periodic; 3] },
        spacing: a / ah,
        viscosity: 1.0,
        drive: Drive::MeanVelocity(Vector3::x()),
        bodies: vec![SuspendedBody {
            body: Body { ball: Ball { center: Vector3::new(0.513, 0.527, 0.481), radius: a }, motion: Motion::Prescribed(Twist::zero()) },
            order: l,
        }],
        tolerance: 1e-9,
    };
    let mut sim = Simulation::new(s, setup).unwrap();
    let sol = sim.solve(&mut |_, _| {}).unwrap();
    if s.world().rank() == 0 {
        let b = &sol.bodies[0];
        println!(
            "cubic phi {phi} ah {ah} L {l}: K {:.4} {:?} its {}",
            b.force[0] / (6.0 * std::f64::consts::PI * a),
            sim.grid().cells(),
            sim.cost().krylov.iterations
        );
    }
}
