//! The seconds that a run will take, from a sample of it that is solved on the spot.
//!
//! The sample has at most forty of the scene's bodies at its fraction, its kinds of axes and its inverse, and a coarse grid if it has all
//! the bodies or would have many cells; a box that is still too large or too long is cut. Set-up and what an iteration does on the grid take
//! seconds in proportion to its unknowns (Fourier transforms also by the lengths of the axes, some of which suit them badly), what it does on
//! surfaces in proportion to multipliers; the number of iterations grows little with that of bodies. It does not know how a run ends: steps are
//! counted at the speeds of the sample.

use std::time::Instant;

use nalgebra::SVector;
use rustfft::{FftPlanner, num_complex::Complex};

use crate::{
    body::pack,
    error::{Error, Result},
    flow::InverseMethod,
    geometry::Domain,
    petsc::Session,
    scene::{Scene, Scheme, Step, TimeSection},
    simulation::{BodyState, Configuration, FlowSolver, Setup, Solution, SuspendedBody, flow_solver},
};

/// Bodies of a sample.
const SAMPLE: usize = 40;

/// Cells per radius of a sample that has all bodies.
const COARSE: f64 = 4.0;

/// Most cells of a sample, and the most times that its longest side is as long as its shortest.
const MOST_CELLS: f64 = 1e5;
const SLENDER: f64 = 16.0;

/// Least side of a sample that was cut, in diameters of its largest body.
const ROOM: f64 = 1.5;

/// Gap between the bodies of a sample, in radii.
const GAP: f64 = 0.02;

/// By how much the box of a sample grows when its bodies do not fit, and how often.
const WIDER: f64 = 1.1;
const TRIES: usize = 12;

/// Iterations grow with this power of the number of bodies.
///
/// Measured on disks at fraction 0.4: 34, 47 and 51 iterations for 10, 100 and 300 of them.
const GROWTH: f64 = 0.12;

/// The same where near pairs and pores precondition films. Measured on disks at 0.5: 18, 20 and 22 iterations for 100, 1,000 and 10,000 of them,
/// on spheres at 0.4 20, 22 and 24 for 100, 300 and 1,000.
const GROWTH_IN_FILMS: f64 = 0.06;

/// Numbers in each transform that is timed, at least.
const TRANSFORMED: usize = 1 << 16;

/// Cells by which the bodies of a sample are displaced: next to none, for beside walls there may be no room.
const DISPLACEMENT: f64 = 1e-6;

/// Iterations of a step in time over those of an instant: steps start from the solutions before them.
const WARM: f64 = 0.5;

/// What a run is expected to take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forecast {
    /// Seconds of set-up, once.
    pub setup: f64,
    /// Seconds of a solve at an instant, jump corrections included.
    pub solve: f64,
    /// Its iterations.
    pub iterations: usize,
    /// Solves of a run in time; nothing at an instant.
    pub solves: Option<f64>,
}

impl Forecast {
    /// Of a scene of dimension `D` with a flow and a resolution; nothing if no sample of it can be solved. Collective.
    ///
    /// # Errors
    /// The scene cannot be built, or PETSc fails.
    pub fn of<const D: usize>(session: &Session, scene: &Scene, (grid, multipliers): (usize, usize)) -> Result<Option<Forecast>> {
        let setup = session.world().agree(Setup::<D>::of(scene))?;
        let Some(sample) = sample(&setup) else { return Ok(None) };
        let speed = |velocity: f64| session.world().max(velocity);
        let solved = flow_solver(session, sample).and_then(|mut suspension| {
            suspension.solve(&mut |_, _| {})?;
            // once more, elsewhere: tables for each kind of pair are made once a run
            let first = suspension.cost().assembly;
            let solution = elsewhere(suspension.as_mut())?;
            Ok((suspension, solution, first))
        });
        let (suspension, solution, first) = match solved {
            Ok(solved) => solved,
            // a sample need not have the steady flow that the scene has
            Err(Error::Refused(_) | Error::Diverged(_)) => return Ok(None),
            Err(error) => return Err(error),
        };
        let cost = suspension.cost();
        let times = grid as f64 / cost.grid_unknowns as f64;
        let growth = if setup.interactions.resist() { GROWTH_IN_FILMS } else { GROWTH };
        let more = (setup.bodies.len() as f64 / SAMPLE as f64).max(1.0).powf(growth);
        let bodies = multipliers.max(1) as f64 / cost.multiplier_unknowns.max(1) as f64;
        let [setup_seconds, assembly, krylov, surfaces] =
            [cost.setup, cost.assembly, cost.krylov.seconds, cost.stages.bodies].map(|seconds| session.world().max(seconds));
        let suited = if setup.inverse == InverseMethod::Transform { transforms(&setup, suspension.setup()) } else { 1.0 };
        let smallest = setup.bodies.iter().map(|suspended| suspended.body.ball.radius).fold(f64::INFINITY, f64::min);
        let fastest = speed(solution.bodies.iter().map(|body| felt_speed(&setup, body, smallest)).fold(0.0, f64::max));
        Ok(Some(Forecast {
            setup: setup_seconds * times + session.world().max(first - assembly).max(0.0),
            solve: assembly * bodies + ((krylov - surfaces).max(0.0) * times * suited + surfaces * bodies) * more,
            iterations: (cost.krylov.iterations as f64 * more).round() as usize,
            solves: scene.time.as_ref().map(|time| solves(time, fastest, smallest)),
        }))
    }

    /// All seconds.
    pub fn seconds(&self) -> f64 {
        self.setup + self.solves.map_or(self.solve, |solves| self.solve * (1.0 + WARM * (solves - 1.0).max(0.0)))
    }
}

/// Seconds that transforms of a grid take for each cell, over those of a sample's.
fn transforms<const D: usize>(setup: &Setup<D>, sample: &Setup<D>) -> f64 {
    let of_grid = |setup: &Setup<D>| {
        let periodic = (0..D).filter(|&axis| setup.domain.periodic(axis));
        periodic.map(|axis| transform((setup.domain.size[axis] / setup.spacing).round() as usize)).sum::<f64>()
    };
    let (one, other) = (of_grid(setup), of_grid(sample));
    if other > 0.0 { one / other } else { 1.0 }
}

/// Seconds that a Fourier transform of so many numbers takes for each.
fn transform(length: usize) -> f64 {
    let length = length.max(1);
    let plan = FftPlanner::<f64>::new().plan_fft_forward(length);
    let mut numbers = vec![Complex::new(1.0, 0.0); length * TRANSFORMED.div_ceil(length)];
    let mut once = || {
        let start = Instant::now();
        plan.process(&mut numbers);
        start.elapsed().as_secs_f64() / numbers.len() as f64
    };
    once().min(once())
}

/// Solves with all bodies displaced by a part of a cell.
fn elsewhere<const D: usize>(suspension: &mut dyn FlowSolver<D>) -> Result<Solution<D>> {
    let setup = suspension.setup();
    let centers: Vec<SVector<f64, D>> =
        setup.bodies.iter().map(|suspended| suspended.body.ball.center + SVector::repeat(DISPLACEMENT * setup.spacing)).collect();
    let time = setup.domain.slide().map_or(0.0, |slide| slide.time);
    let tolerance = setup.tolerance.at_an_instant();
    let moment = Configuration { centers: &centers, time, pressed: &[], step: 0.0, pushes: &[], tolerance };
    suspension.solve_at(&moment, &mut |_, _| {})
}

/// The speed of a body that limits steps: where images slide, not that of the shear in which all take part, but what it does to neighbours.
fn felt_speed<const D: usize>(setup: &Setup<D>, body: &BodyState<D>, radius: f64) -> f64 {
    match setup.domain.shear_rate().abs() {
        0.0 => body.twist.velocity.norm(),
        strain => (body.twist.velocity - setup.drive.background(&body.center)).norm() + strain * radius,
    }
}

/// Solves of a run at a speed.
fn solves(time: &TimeSection, speed: f64, radius: f64) -> f64 {
    let steps = match time.step {
        Step::Fixed(step) => time.end / step,
        Step::Auto => time.end * speed / (time.travel * radius),
    };
    let solves = if time.scheme == Scheme::Midpoint { 2.0 } else { 1.0 };
    solves * steps.ceil() + 1.0
}

/// A part of a setup that is solved soon; nothing if its bodies find no room or still take too many cells.
fn sample<const D: usize>(setup: &Setup<D>) -> Option<Setup<D>> {
    let all = setup.bodies.len();
    if all <= SAMPLE && small(setup.domain.size, coarse(setup).spacing) {
        return Some(coarse(setup));
    }
    let part = (SAMPLE as f64 / all as f64).min(1.0).powf(1.0 / D as f64);
    let given = Setup { domain: Domain { size: setup.domain.size * part, ..setup.domain.clone() }, ..setup.clone() };
    let part = if small(given.domain.size, given.spacing) { given } else { coarse(&given) };
    let size = shrunk(&part)?;
    let kept = (all as f64 * size.product() / setup.domain.volume()).round().clamp(all.min(1) as f64, SAMPLE as f64) as usize;
    let chosen: Vec<SuspendedBody<D>> = (0..kept).map(|place| part.bodies[place * all / kept]).collect();
    let radii: Vec<f64> = chosen.iter().map(|suspended| suspended.body.ball.radius).collect();
    (0..TRIES).find_map(|wider| {
        let domain = Domain { size: size * WIDER.powi(wider as i32), axes: setup.domain.axes };
        let centers = pack(&domain, &[], &radii, GAP, 1).ok()?;
        let mut bodies = chosen.clone();
        bodies.iter_mut().zip(centers).for_each(|(suspended, center)| suspended.body.ball.center = center);
        Some(Setup { domain, bodies, ..part.clone() })
    })
}

/// Whether a box has few cells, and not many more along one axis than along another.
fn small<const D: usize>(size: SVector<f64, D>, spacing: f64) -> bool {
    (size / spacing).product() <= MOST_CELLS && size.max() <= SLENDER * size.min()
}

/// The size of a box with its longest sides cut until it is small; nothing if its largest body then has no room.
fn shrunk<const D: usize>(setup: &Setup<D>) -> Option<SVector<f64, D>> {
    let widest = setup.bodies.iter().map(|suspended| 2.0 * suspended.body.ball.radius).fold(0.0, f64::max);
    let mut size = setup.domain.size;
    while !small(size, setup.spacing) {
        let longest = size.imax();
        size[longest] *= 0.5;
        if size[longest] < ROOM * widest {
            return None;
        }
    }
    Some(size)
}

/// The setup on a grid that is coarse for its smallest body.
fn coarse<const D: usize>(setup: &Setup<D>) -> Setup<D> {
    let smallest = setup.bodies.iter().map(|suspended| suspended.body.ball.radius).fold(f64::INFINITY, f64::min);
    let spacing = if smallest.is_finite() { setup.spacing.max(smallest / COARSE) } else { setup.spacing };
    let carried = |suspended: &SuspendedBody<D>| {
        let order = suspended.order.min((suspended.body.ball.radius / spacing) as usize);
        SuspendedBody { order, ..*suspended }
    };
    Setup { spacing, bodies: setup.bodies.iter().map(carried).collect(), ..setup.clone() }
}
