//! Shapes of one's own: smooth plane curves, by analytic functions that a scene does not know.

use std::{f64::consts::PI, rc::Rc};

use nalgebra::{Complex, DMatrix, Matrix2, SVector, Vector2};
use turbid::{
    body::Motion,
    flow::{Drive, InverseMethod},
    geometry::{Axis, LeesEdwards},
    interaction::Wrench,
    mechanics::Suspension,
    motion::Simulation,
    petsc::Session,
    scene::{ConstraintMethod, Scheme, Step, TimeSection},
    setup::Setup,
    surface::{Modes, Shape},
    system::BodyState,
};

use crate::{
    Test,
    suspension::{assert_near, couette, fixed, free, periodic_cube, solve, suspended},
};

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_circle_is_a_disk),
        Test::of(ellipses_have_the_drag_of_finite_elements),
        Test::of(a_square_with_round_corners_has_the_drag_of_finite_elements),
        Test::of(an_ellipse_across_a_periodic_side_and_in_other_units_has_the_same_drag),
        Test::of(a_free_ellipse_moves_as_its_drag_says),
        Test::of(an_ellipse_turns_as_jeffery_says),
        Test::of(an_ellipse_tumbles_on_jefferys_orbit),
        Test::of(an_ellipse_at_a_wall_and_beside_a_disk_moves_as_its_mirror_image),
        Test::of(what_only_balls_do_is_refused),
    ]
}

/// The boundary `z = sum of c_j s^j`, `s = exp(i t)`, about its centre.
#[derive(Clone)]
struct Curve(Vec<(i32, Complex<f64>)>);

impl Curve {
    fn turned(terms: &[(i32, f64)], angle: f64) -> Curve {
        Curve(terms.iter().map(|&(power, value)| (power, Complex::from_polar(value, angle))).collect())
    }

    fn ellipse([long, short]: [f64; 2], angle: f64) -> Curve {
        Curve::turned(&[(1, 0.5 * (long + short)), (-1, 0.5 * (long - short))], angle)
    }

    fn at(&self, s: Complex<f64>) -> Complex<f64> {
        self.0.iter().map(|(power, value)| value * s.powi(*power)).sum()
    }

    fn slope(&self, s: Complex<f64>) -> Complex<f64> {
        self.0.iter().map(|(power, value)| value * f64::from(*power) * s.powi(power - 1)).sum()
    }

    /// Conjugate of `z` on the boundary, continued from there.
    fn schwarz(&self, s: Complex<f64>) -> Complex<f64> {
        self.0.iter().map(|(power, value)| value.conj() * s.powi(-power)).sum()
    }

    fn around(count: usize) -> impl Iterator<Item = Complex<f64>> {
        (0..count).map(move |place| Complex::from_polar(1.0, 2.0 * PI * place as f64 / count as f64))
    }

    fn nearest(&self, z: Complex<f64>) -> Complex<f64> {
        let distance = |s: &Complex<f64>| (self.at(*s) - z).norm_sqr();
        Curve::around(1000).min_by(|one, other| distance(one).total_cmp(&distance(other))).unwrap()
    }

    /// Where a point near the boundary comes from.
    fn inverse(&self, z: Complex<f64>) -> Complex<f64> {
        (0..40).fold(self.nearest(z), |s, _| s - (self.at(s) - z) / self.slope(s))
    }

    /// Distance from the nearest of many tangents, positive outside.
    fn height(&self, z: Complex<f64>) -> f64 {
        let s = self.nearest(z);
        let normal = s * self.slope(s);
        ((z - self.at(s)) * normal.conj()).re / normal.norm()
    }

    fn extent(&self) -> [f64; 2] {
        let sizes = || Curve::around(1000).map(|s| self.at(s).norm());
        [sizes().fold(f64::INFINITY, f64::min) * (1.0 - 1e-4), sizes().fold(0.0, f64::max) * (1.0 + 1e-4)]
    }
}

impl Shape<2> for Curve {
    fn signed_distance(&self, offset: &Vector2<f64>) -> f64 {
        self.height(Complex::new(offset.x, offset.y))
    }

    fn bounding_radius(&self) -> f64 {
        self.extent()[1]
    }

    fn volume(&self) -> f64 {
        PI * self.0.iter().map(|(power, value)| f64::from(*power) * value.norm_sqr()).sum::<f64>()
    }

    fn moment_of_inertia(&self) -> f64 {
        unreachable!("it has no inertia")
    }

    fn contact_point(&self, _: &Vector2<f64>) -> Vector2<f64> {
        unreachable!("it touches nothing")
    }

    fn turned(&self, rotation: &Matrix2<f64>) -> Rc<dyn Shape<2>> {
        let turn = Complex::new(rotation[(0, 0)], rotation[(1, 0)]);
        Rc::new(Curve(self.0.iter().map(|(power, value)| (*power, value * turn)).collect()))
    }

    fn modes(&self, order: usize) -> Box<dyn Modes> {
        Box::new(CurveModes::new(self.clone(), order))
    }
}

/// Tractions `g exp(i m t)` over the parameter, `|m| <= order`, in an orthonormal basis that rigid modes begin.
struct CurveModes {
    curve: Curve,
    order: i32,
    radius: f64,
    lever: f64,
    bounds: [f64; 2],
    /// The basis, a mode a row, in real and imaginary parts of each `g`.
    basis: DMatrix<f64>,
}

impl CurveModes {
    fn new(curve: Curve, order: usize) -> CurveModes {
        let count = 4 * order + 2;
        let row = |coefficient: &dyn Fn(i32) -> Complex<f64>| {
            let mut row = vec![0.0; count];
            for m in -(order as i32)..=order as i32 {
                let place = 2 * (m + order as i32) as usize;
                (row[place], row[place + 1]) = (coefficient(m).re, coefficient(m).im);
            }
            row
        };
        let lever = curve.0.iter().map(|(_, value)| value.norm_sqr()).sum::<f64>().sqrt();
        let of_curve = |m: i32| curve.0.iter().find(|(power, _)| *power == m).map_or(Complex::ZERO, |(_, value)| *value / lever);
        let unit = |wanted: i32, value: Complex<f64>| move |m: i32| if m == wanted { value } else { Complex::ZERO };
        // the first is a pressure inside, which does nothing
        let mut rows = vec![
            row(&|m| of_curve(m) * f64::from(m)),
            row(&unit(0, Complex::ONE)),
            row(&unit(0, Complex::I)),
            row(&|m| of_curve(m) * Complex::I),
        ];
        rows.extend((-(order as i32)..=order as i32).flat_map(|m| [row(&unit(m, Complex::ONE)), row(&unit(m, Complex::I))]));
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for mut row in rows {
            for earlier in basis.iter().chain(&basis) {
                let part: f64 = row.iter().zip(earlier).map(|(one, other)| one * other).sum();
                row.iter_mut().zip(earlier).for_each(|(one, other)| *one -= part * other);
            }
            let size = row.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
            if size > 1e-6 {
                basis.push(row.iter().map(|entry| entry / size).collect());
            }
        }
        assert_eq!(basis.len(), count);
        let basis = DMatrix::from_fn(count - 1, count, |mode, entry| basis[mode + 1][entry]);
        let length = 2.0 * PI * Curve::around(1000).map(|s| curve.slope(s).norm()).sum::<f64>() / 1000.0;
        CurveModes { bounds: curve.extent(), order: order as i32, radius: length / (2.0 * PI), lever, basis, curve }
    }

    /// Sums what real and imaginary parts of each `g` cause.
    fn combine(&self, of: impl Fn(i32, Complex<f64>) -> f64, out: &mut [f64]) {
        let parts = (-self.order..=self.order).flat_map(|m| [of(m, Complex::ONE), of(m, Complex::I)]);
        let parts: Vec<f64> = parts.map(|part| if part.is_finite() { part } else { 0.0 }).collect();
        out.iter_mut()
            .zip(self.basis.row_iter())
            .for_each(|(out, row)| *out = row.iter().zip(&parts).map(|(one, other)| one * other).sum());
    }

    /// `phi'` of a traction.
    fn potential(&self, m: i32, g: Complex<f64>, s: Complex<f64>) -> Complex<f64> {
        let factor = -g * self.radius / 4.0;
        factor * s.powi(m - 1) / self.curve.slope(s)
    }

    fn velocity(&self, m: i32, g: Complex<f64>, s: Complex<f64>, z: Complex<f64>) -> Complex<f64> {
        let factor = -g * self.radius / 4.0;
        let head = if m == 0 { factor * 2.0 * s.norm().ln() } else { factor / f64::from(m) * (s.powi(m) - s.conj().powi(-m)) };
        head - (z - self.curve.schwarz(s).conj()) * self.potential(m, g, s).conj()
    }

    fn fill(&self, offsets: &[f64], out: &mut [f64], of: impl Fn(i32, Complex<f64>, Complex<f64>, Complex<f64>) -> f64) {
        let stride = out.len() / (offsets.len() / 2).max(1);
        for (offset, values) in offsets.chunks_exact(2).zip(out.chunks_exact_mut(stride.max(1))) {
            let z = Complex::new(offset[0], offset[1]);
            let s = self.curve.inverse(z);
            self.combine(|m, g| of(m, g, s, z), &mut values[..self.count()]);
        }
    }
}

impl Modes for CurveModes {
    fn dimension(&self) -> usize {
        2
    }

    fn radius(&self) -> f64 {
        self.radius
    }

    fn bounds(&self) -> [f64; 2] {
        self.bounds
    }

    fn outside(&self, offset: &[f64]) -> bool {
        self.curve.height(Complex::new(offset[0], offset[1])) > 0.0
    }

    fn point(&self, direction: &[f64], out: &mut [f64]) {
        let point = self.curve.at(Complex::new(direction[0], direction[1]));
        out.copy_from_slice(&[point.re, point.im]);
    }

    fn count(&self) -> usize {
        self.basis.nrows()
    }

    fn traction(&self, direction: &[f64], out: &mut [f64]) {
        let s = Complex::new(direction[0], direction[1]);
        let mut along = vec![0.0; self.count()];
        for axis in 0..2 {
            self.combine(|m, g| [(g * s.powi(m)).re, (g * s.powi(m)).im][axis], &mut along);
            along.iter().enumerate().for_each(|(mode, value)| out[2 * mode + axis] = *value);
        }
    }

    fn velocity_jumps(&self, offsets: &[f64], component: usize, out: &mut [f64]) {
        self.fill(offsets, out, |m, g, s, z| {
            let velocity = self.velocity(m, g, s, z);
            [velocity.re, velocity.im][component]
        });
    }

    fn pressure_jumps(&self, offsets: &[f64], out: &mut [f64]) {
        self.fill(offsets, out, |m, g, s, _| -4.0 * self.potential(m, g, s).re);
    }

    /// About: as on a circle.
    fn isolated_mobility(&self, reach: f64) -> DMatrix<f64> {
        let of = |entry: usize| match (entry / 2) as i32 - self.order {
            0 => 0.5 * (reach / self.radius).ln().max(0.5),
            m => 0.25 / f64::from(m.abs()),
        };
        let scaled = DMatrix::from_fn(self.basis.nrows(), self.basis.ncols(), |mode, entry| self.basis[(mode, entry)] * of(entry));
        self.radius * scaled * self.basis.transpose()
    }

    fn torque_factor(&self) -> f64 {
        self.force_factor() * self.lever
    }
}

/// The state of a body of a shape, the first of a setup.
fn solved(session: &Session, setup: Setup<2>, curve: &Curve) -> BodyState<2> {
    let mut suspension = Suspension::with_shapes(session, setup, vec![(0, Rc::new(curve.clone()))]).unwrap();
    suspension.solve(&mut |_, _| {}).unwrap().bodies[0]
}

const CENTER: [f64; 2] = [0.513, 0.527];

fn array(cells: usize, drive: Drive<2>, motion: Motion<2>) -> Setup<2> {
    let setup = periodic_cube(1.0 / cells as f64, drive, vec![suspended(Vector2::from(CENTER), 0.1, motion, 8)]);
    Setup { inverse: InverseMethod::Transform, ..setup }
}

/// Forces on a fixed body of a square array in unit mean flows along x and along y.
fn drag(session: &Session, cells: usize, curve: &Curve) -> [SVector<f64, 2>; 2] {
    [Vector2::x(), Vector2::y()].map(|mean| solved(session, array(cells, Drive::MeanVelocity(mean), fixed()), curve).force)
}

fn a_circle_is_a_disk(session: &Session) {
    let radius = (0.1_f64 / PI).sqrt();
    let [curve, _] = drag(session, 32, &Curve::ellipse([radius; 2], 0.3));
    let disk = suspended(Vector2::from(CENTER), radius, fixed(), 8);
    let setup = Setup { bodies: vec![disk], ..array(32, Drive::MeanVelocity(Vector2::x()), fixed()) };
    let (_, ball) = solve(session, setup);
    // its modes end at others than those of a disk do
    assert_near("drag of a circle", curve.x, ball.bodies[0].force.x, 5e-5);
    assert_near("drag of a square array", curve.x, 24.8316752488, 2e-4);
}

/// Finite elements of degree 7: numerics of smooth bodies, two cells across the radius of the tip and more.
fn ellipses_have_the_drag_of_finite_elements(session: &Session) {
    let turned = Curve::ellipse([0.3, 0.15], PI / 6.0);
    for (cells, tolerance) in [(32, 2e-3), (48, 4e-4)] {
        let [along, across] = drag(session, cells, &turned);
        assert_near("Kxx", along.x, 30.94513, tolerance);
        assert_near("Kyy", across.y, 50.66243, tolerance);
        assert_near("Kxy", along.y, -7.02347, 4.0 * tolerance);
        assert_near("Kyx", across.x, along.y, 4.0 * tolerance);
    }
    let [along, across] = drag(session, 96, &Curve::ellipse([0.3, 0.1], 0.0));
    assert_near("Kxx", along.x, 17.62950, 1.2e-3);
    assert_near("Kyy", across.y, 64.78689, 1.2e-3);
}

fn a_square_with_round_corners_has_the_drag_of_finite_elements(session: &Session) {
    let [along, across] = drag(session, 64, &Curve::turned(&[(1, 0.25), (-3, -0.02)], 0.2));
    assert_near("K", along.x, 49.0185, 1e-3);
    assert_near("K", across.y, 49.0185, 1e-3);
}

/// Half a box away, by whole cells, and in micrometres; a force a length in 2D is the same in any unit of length.
fn an_ellipse_across_a_periodic_side_and_in_other_units_has_the_same_drag(session: &Session) {
    let curve = |unit: f64| Curve::ellipse([0.3 * unit, 0.15 * unit], PI / 6.0);
    let scene = |unit: f64, center: Vector2<f64>| {
        let mut setup = array(32, Drive::MeanVelocity(Vector2::x()), fixed());
        (setup.domain.size, setup.spacing) = (setup.domain.size * unit, setup.spacing * unit);
        setup.bodies[0].body.ball.center = center * unit;
        solved(session, setup, &curve(unit)).force
    };
    let here = scene(1.0, Vector2::from(CENTER));
    for (unit, shift) in [(1.0, 0.5), (1e-6, 0.0), (1e3, 0.5)] {
        let there = scene(unit, Vector2::from(CENTER) + Vector2::repeat(shift));
        assert!((there - here).norm() < 1e-7 * here.norm(), "{unit}, {shift}: {there} and {here}");
    }
}

/// Stokes flow is linear: the velocity under a force times the drag is that force.
fn a_free_ellipse_moves_as_its_drag_says(session: &Session) {
    let curve = Curve::ellipse([0.3, 0.15], PI / 6.0);
    let [along, across] = drag(session, 48, &curve);
    let motion = Motion::Free { force: Vector2::new(2.0, -1.0), torque: Wrench::zero().torque };
    let state = solved(session, array(48, Drive::MeanVelocity(Vector2::zeros()), motion), &curve);
    let velocity = state.twist.velocity;
    let force = along * velocity.x + across * velocity.y;
    assert!((force - Vector2::new(2.0, -1.0)).norm() < 1e-3, "{force}");
    assert!(state.twist.spin.norm() < 2e-4 * velocity.norm(), "{}", state.twist.spin);
}

/// A body in a sheared box that is large beside it.
fn sheared(center: [f64; 2]) -> Setup<2> {
    let (size, body) = (4.0, suspended(Vector2::from(center), 0.1, free(), 8));
    let mut setup = Setup { spacing: size / 120.0, bodies: vec![body], ..array(16, Drive::Shear(1.0), free()) };
    setup.domain.size = Vector2::repeat(size);
    setup.domain.axes[1] = Axis::Sheared(LeesEdwards::steady(0.0, size, 0.0));
    setup
}

/// Jeffery 1922 in the plane: the long axis turns at `-rate (a^2 sin^2 + b^2 cos^2) / (a^2 + b^2)`.
fn an_ellipse_turns_as_jeffery_says(session: &Session) {
    for angle in [0.0, 0.7, 0.5 * PI] {
        let state = solved(session, sheared([2.013, 2.027]), &Curve::ellipse([0.3, 0.15], angle));
        let expected = -(0.09 * angle.sin().powi(2) + 0.0225 * angle.cos().powi(2)) / (0.09 + 0.0225);
        let turning = state.twist.spin[(1, 0)];
        assert!((turning - expected).abs() < 0.015, "{angle}: {turning} and {expected}");
    }
}

/// The same over time, `tan(angle) = b/a tan(phase)`, whose phase falls by `a b / (a^2 + b^2)` a strain; and on from the middle, from what a checkpoint holds.
fn an_ellipse_tumbles_on_jefferys_orbit(session: &Session) {
    let simulation = || {
        let shapes: Vec<(usize, Rc<dyn Shape<2>>)> = vec![(0, Rc::new(Curve::ellipse([0.3, 0.15], 0.5 * PI)))];
        let suspension = Suspension::with_shapes(session, sheared([2.013, 2.0]), shapes).unwrap();
        Simulation::flowing(
            session,
            Box::new(suspension),
            TimeSection { scheme: Scheme::TwoStep, step: Step::Fixed(0.1), ..TimeSection::to(4.0) },
        )
    };
    let step = |simulation: &mut Simulation<2>| {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    };
    let angle = |simulation: &Simulation<2>| {
        let rotation = simulation.state().bodies[0].rotation;
        0.5 * PI + rotation[(1, 0)].atan2(rotation[(0, 0)])
    };
    let (mut whole, mut later) = (simulation(), simulation());
    for count in 1..=40 {
        step(&mut whole);
        if count == 20 {
            later.restore(whole.state().clone(), Default::default()).unwrap();
        }
        if count > 20 {
            step(&mut later);
        }
        let phase = 0.5 * PI - 0.4 * whole.state().time;
        let expected = (0.5 * phase.sin()).atan2(phase.cos());
        assert!((angle(&whole) - expected).abs() < 0.02, "at {}: {} and {expected}", whole.state().time, angle(&whole));
    }
    assert!((angle(&whole) - angle(&later)).abs() < 1e-6, "{} and {}", angle(&whole), angle(&later));
}

/// A shear that is mirrored with all in it turns bodies the other way; a disk and a wall near a curve are met as near disks are.
fn an_ellipse_at_a_wall_and_beside_a_disk_moves_as_its_mirror_image(session: &Session) {
    let spins = [1.0, -1.0].map(|side| {
        let place = |x: f64, y: f64| Vector2::new(0.75 + side * (x - 0.75), y);
        let bodies = vec![suspended(place(0.6, 0.29), 0.1, free(), 6), suspended(place(0.93, 0.42), 0.12, free(), 6)];
        let setup = Setup { inverse: InverseMethod::Transform, ..couette(1.5, 1.0 / 64.0, side, bodies) };
        let mut suspension = Suspension::with_shapes(session, setup, vec![(0, Rc::new(Curve::ellipse([0.2, 0.12], side * 0.4)))]).unwrap();
        let solution = suspension.solve(&mut |_, _| {}).unwrap();
        assert!(solution.bodies.iter().all(|state| state.force.norm() < 1e-6 && state.torque.norm() < 1e-6));
        solution.bodies.iter().map(|state| side * state.twist.spin[(1, 0)]).collect::<Vec<f64>>()
    });
    let [one, mirrored] = &spins;
    one.iter().zip(mirrored).for_each(|(one, mirrored)| assert!((one - mirrored).abs() < 2e-3 * one.abs(), "{one} and {mirrored}"));
}

fn what_only_balls_do_is_refused(session: &Session) {
    let setup = Setup { constraint: ConstraintMethod::Distributed, ..array(32, Drive::MeanVelocity(Vector2::x()), fixed()) };
    let refusal = Suspension::with_shapes(session, setup, vec![(0, Rc::new(Curve::ellipse([0.3, 0.15], 0.0)))]).err().unwrap().to_string();
    assert!(refusal.contains("bodies that are no balls"), "{refusal}");
}
