//! Islands with known answers, and against the solvers of another program.

use std::rc::Rc;

use clarabel::algebra::CscMatrix;
use nalgebra::SVector;

use super::{
    FrictionLaw,
    cone::{ContactState, tangential_size},
    medium::Medium,
    program::{FrictionIsland, FrictionProgram},
    row_block::{NONE, RowBlock},
    secant::MobilityMode,
    solver::{
        exact::{Found, solve_exactly},
        interior_point::follow,
        sweeps::Sweeps,
    },
};
use crate::{
    body::{Twist, skew},
    contact::{Contact, FRICTION_TOLERANCE, candidates, solver::clarabel::solve_general},
    geometry::{Axis, Ball, Domain},
};

/// Bodies of density 1, each moving before it is pulled down.
struct Pile<const D: usize> {
    domain: Domain<D>,
    balls: Vec<Ball<D>>,
    masses: Vec<[f64; 2]>,
    twists: Vec<Twist<D>>,
    step: f64,
    contacts: Vec<Contact<D>>,
}

impl<const D: usize> Pile<D> {
    /// Balls between walls across the last axis, of which those count as contacts that are nearer than `reach`.
    fn new(balls: Vec<Ball<D>>, twists: Vec<Twist<D>>, (step, reach): (f64, f64)) -> Pile<D> {
        let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        let domain =
            Domain { size: [100.0; D].into(), axes: std::array::from_fn(|axis| if axis + 1 == D { wall } else { Axis::Periodic }) };
        let contacts = candidates(&domain, &balls, &vec![1.0; balls.len()], reach);
        let mass = |ball: &Ball<D>| {
            let [volume, part] = if D == 2 { [std::f64::consts::PI, 0.5] } else { [4.0 / 3.0 * std::f64::consts::PI, 0.4] };
            let mass = volume * ball.radius.powi(D as i32);
            [mass, part * mass * ball.radius.powi(2)]
        };
        Pile { masses: balls.iter().map(mass).collect(), domain, balls, twists, step, contacts }
    }

    fn program<const W: usize>(&self, coefficient: f64) -> FrictionProgram<D, W> {
        let Pile { domain, balls, masses, twists, step, contacts } = self;
        FrictionIsland {
            domain,
            balls,
            masses,
            twists,
            step: *step,
            contacts,
            laws: &vec![FrictionLaw::plain(coefficient); contacts.len()],
            duration: *step,
            wall: None,
        }
        .program()
    }

    /// Impulses in units of momentum.
    fn impulses<const W: usize>(program: &FrictionProgram<D, W>, found: &Found<D>) -> Vec<[f64; D]> {
        let impulse = |(row_block, force): (&RowBlock<D, W>, &[f64; D])| std::array::from_fn(|axis| force[axis] / row_block.norms[axis]);
        program.row_blocks.iter().zip(&found.forces).map(impulse).collect()
    }

    /// Kinetic energy after the impulses.
    fn energy<const W: usize>(&self, program: &FrictionProgram<D, W>, forces: &[[f64; D]]) -> f64 {
        // every body is in a contact, in its place
        let motion = program.motion(forces);
        let of_body = |((twist, [mass, inertia]), change): ((&Twist<D>, &[f64; 2]), &[f64; W])| {
            let velocity: f64 = (0..D).map(|axis| (twist.velocity[axis] + change[axis] / mass.sqrt()).powi(2)).sum();
            let spin = twist.spin + skew::<D>(&change[D..].iter().map(|change| change / inertia.sqrt()).collect::<Vec<_>>());
            0.5 * (mass * velocity + 0.5 * inertia * spin.norm_squared())
        };
        self.twists.iter().zip(&self.masses).zip(&motion).map(of_body).sum()
    }
}

/// Disks in layers that fall on a floor and spin.
fn disks() -> Pile<2> {
    let number = |body: usize| body as f64;
    let place = |body: usize| [2.02 * number(body % 4) + 1.3 + number(body / 4 % 2), 1.0 + 1.72 * number(body / 4)];
    let ball = |body: usize| Ball { center: place(body).into(), radius: 1.0 - 0.01 * number(body * 7 % 5) };
    let twist = |body: usize| Twist {
        velocity: [(3.0 * number(body)).sin(), -1.0 + 0.3 * (5.0 * number(body)).cos()].into(),
        spin: skew(&[(2.0 * number(body)).sin()]),
    };
    Pile::new((0..12).map(ball).collect(), (0..12).map(twist).collect(), (0.1, 0.1))
}

/// Spheres in two layers that do the same.
fn spheres() -> Pile<3> {
    let number = |body: usize| body as f64;
    let aside = |body: usize| 1.3 + 0.9 * number(body / 4 % 2);
    let place =
        |body: usize| [2.02 * number(body % 2) + aside(body), 2.02 * number(body / 2 % 2) + aside(body), 1.0 + 1.5 * number(body / 4)];
    let ball = |body: usize| Ball { center: place(body).into(), radius: 1.0 - 0.01 * number(body * 7 % 5) };
    let twist = |body: usize| {
        let body = number(body);
        Twist {
            velocity: [(3.0 * body).sin(), (7.0 * body).cos(), -1.0 + 0.3 * (5.0 * body).cos()].into(),
            spin: skew(&[(2.0 * body).sin(), (4.0 * body).sin(), (2.0 * body).cos()]),
        }
    };
    Pile::new((0..8).map(ball).collect(), (0..8).map(twist).collect(), (0.1, 0.1))
}

/// Energy after the step, and the sum of normal impulses, by another program (the same law, its own sweeps and factors; to 1e-12).
fn agrees<const D: usize, const W: usize>(pile: &Pile<D>, coefficient: f64, [energy, normal]: [f64; 2]) {
    let program = pile.program::<W>(coefficient);
    let found = solve_exactly(&program, vec![[0.0; D]; program.row_blocks.len()], FRICTION_TOLERANCE);
    assert!(found.residual <= FRICTION_TOLERANCE && found.iterations < 10, "{found:?}");
    let sum: f64 = Pile::impulses(&program, &found).iter().map(|impulse| impulse[0]).sum();
    let after = pile.energy(&program, &found.forces);
    assert!((after - energy).abs() < 1e-8 * energy && (sum - normal).abs() < 1e-8 * normal, "mu {coefficient}: {after:.12}, {sum:.12}");
    assert!(after < pile.energy(&program, &vec![[0.0; D]; found.forces.len()]));
}

#[test]
fn disks_and_spheres_fall_on_a_floor_as_in_another_program() {
    agrees::<2, 3>(&disks(), 0.1, [15.350_959_767_343, 28.075_499_371_089]);
    agrees::<2, 3>(&disks(), 0.5, [11.967_484_942_563, 33.470_238_142_324]);
    agrees::<2, 3>(&disks(), 1.0, [10.781_867_624_867, 36.125_450_436_780]);
    agrees::<3, 6>(&spheres(), 0.1, [17.367_078_064_677, 32.339_413_531_693]);
    agrees::<3, 6>(&spheres(), 0.5, [14.743_534_208_497, 32.202_370_755_238]);
}

#[test]
fn the_interior_point_needs_no_guess_and_takes_a_good_one() {
    let program = disks().program::<3>(0.5);
    let cold = follow(&program, &vec![[0.0; 2]; program.row_blocks.len()], 1.0, 1e-11);
    assert!(cold.residual <= FRICTION_TOLERANCE && cold.iterations <= 12, "{} {:e}", cold.iterations, cold.residual);
    let mut sweeps = Sweeps::new(&program, vec![[0.0; 2]; program.row_blocks.len()]);
    sweeps.run(1e-3, 1000);
    let warm = follow(&program, &sweeps.forces, 1e-2, 1e-11);
    assert!(warm.residual <= FRICTION_TOLERANCE && warm.iterations < cold.iterations, "{} {:e}", warm.iterations, warm.residual);
    let motions = [cold.forces, warm.forces].map(|forces| program.motion(&forces));
    let apart = motions[0].as_flattened().iter().zip(motions[1].as_flattened()).map(|(one, two)| (one - two).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-8, "{apart:e}");
}

/// Rows of `u_N +- mu u_T`.
fn half_planes(program: &FrictionProgram<2, 3>) -> CscMatrix<f64> {
    let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for (row_block, sign) in program.row_blocks.iter().flat_map(|row_block| [(row_block, 1.0), (row_block, -1.0)]) {
        let mut sides: Vec<_> = row_block.sides().collect();
        sides.sort_unstable_by_key(|side| side.0);
        for (body, [normal, tangent]) in sides {
            rows.extend(3 * body..3 * body + 3);
            values.extend(normal.iter().zip(tangent).map(|(normal, tangent)| normal + sign * row_block.friction * tangent));
        }
        starts.push(rows.len());
    }
    CscMatrix::new(3 * program.bodies, 2 * program.row_blocks.len(), starts, rows, values)
}

fn farthest<const W: usize>(one: &[[f64; W]], other: &[[f64; W]]) -> f64 {
    one.as_flattened().iter().zip(other.as_flattened()).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
}

/// By the convex law one program says all: interior point and sweeps end at its motion, and what slips opens.
#[test]
fn by_the_convex_law_motions_are_those_of_one_program() {
    fn solved<const D: usize, const W: usize>(mut program: FrictionProgram<D, W>) -> (FrictionProgram<D, W>, Vec<[f64; D]>) {
        program.row_blocks.iter_mut().for_each(|row_block| row_block.dilation = row_block.friction);
        let none = vec![[0.0; D]; program.row_blocks.len()];
        let end = follow(&program, &none, 1.0, 1e-11);
        assert!(end.residual <= FRICTION_TOLERANCE && end.iterations <= 25, "{:e} after {}", end.residual, end.iterations);
        let mut sweeps = Sweeps::new(&program, none);
        sweeps.run(1e-10, 100_000);
        assert!(farthest(&program.motion(&end.forces), &program.motion(&sweeps.forces)) < 1e-7);
        let velocities = program.velocities_by(&end.forces);
        let slipping = |place: &usize| program.state(*place, &end.forces, &velocities) == ContactState::Slipping;
        let slips: Vec<usize> = (0..velocities.len()).filter(slipping).collect();
        assert!(slips.len() > 3);
        for place in slips {
            let slip = tangential_size(&velocities[place]);
            assert!((velocities[place][0] - program.row_blocks[place].friction * slip).abs() < 1e-8 && slip > 1e-3);
        }
        (program, end.forces)
    }
    solved(spheres().program::<6>(0.5));
    for coefficient in [0.1, 0.5, 1.0] {
        let (program, forces) = solved(disks().program::<3>(coefficient));
        let offsets = program
            .row_blocks
            .iter()
            .flat_map(|row_block| [1.0, -1.0].map(|sign| row_block.offset[0] + sign * row_block.friction * row_block.offset[1]));
        let found = solve_general(&half_planes(&program), &[], &offsets.collect::<Vec<_>>()).unwrap().multipliers;
        let both = found.as_chunks::<2>().0.iter().zip(&program.row_blocks);
        let by_program: Vec<[f64; 2]> =
            both.map(|([plus, minus], row_block)| [plus + minus, row_block.friction * (plus - minus)]).collect();
        let apart = farthest(&program.motion(&forces), &program.motion(&by_program));
        assert!(apart < 1e-6, "{coefficient}: {apart:e}");
    }
}

/// The cone of each contact is two half-planes in two dimensions; that it opens by `mu |u_T|` if it slips is put right from program to program (Acary et
/// al. 2011, doi:10.1002/zamm.201000073).
#[test]
fn programs_of_convex_cones_end_at_the_same_motion() {
    let program = disks().program::<3>(0.1);
    let matrix = half_planes(&program);
    let mut forces = vec![[0.0; 2]; program.row_blocks.len()];
    for _ in 0..30 {
        let velocities = program.velocities(&program.motion(&forces));
        let opened = program.row_blocks.iter().zip(&velocities).flat_map(|(row_block, velocity)| {
            [1.0, -1.0].map(|sign| row_block.offset[0] + row_block.friction * (velocity[1].abs() + sign * row_block.offset[1]))
        });
        let found = solve_general(&matrix, &[], &opened.collect::<Vec<_>>()).unwrap().multipliers;
        let both = found.as_chunks::<2>().0.iter().zip(&program.row_blocks);
        forces = both.map(|([plus, minus], row_block)| [plus + minus, row_block.friction * (plus - minus)]).collect();
    }
    assert!(program.residual(&forces) < 1e-6, "{:e}", program.residual(&forces));
    let exact = program.motion(&solve_exactly(&program, vec![[0.0; 2]; forces.len()], FRICTION_TOLERANCE).forces);
    let apart =
        exact.as_flattened().iter().zip(program.motion(&forces).as_flattened()).map(|(one, two)| (one - two).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-6, "{apart:e}");
}

/// From forces that one contact makes wrong a loose tolerance is met by sweeps alone, near the motion of the law.
#[test]
fn a_loose_tolerance_is_met_by_sweeps() {
    let mut program = disks().program::<3>(0.5);
    let known = solve_exactly(&program, vec![[0.0; 2]; program.row_blocks.len()], FRICTION_TOLERANCE).forces;
    program.row_blocks[0].offset[0] -= 0.3 * program.unit;
    assert!(program.residual(&known) > 1e-2);
    let [loose, tight] = [1e-3, FRICTION_TOLERANCE].map(|tolerance| solve_exactly(&program, known.clone(), tolerance));
    assert!(loose.residual <= 1e-3 && loose.residual > FRICTION_TOLERANCE && loose.iterations == 0 && loose.sweeps > 0, "{loose:?}");
    assert!((program.residual(&loose.forces) - loose.residual).abs() < 1e-9 && tight.residual <= FRICTION_TOLERANCE);
    let apart = farthest(&program.motion(&loose.forces), &program.motion(&tight.forces));
    assert!(apart < 2e-2 * program.unit, "{apart:e} of {:e}", program.unit);
}

/// A rod that slides on one end (mass 1, length 2): from some friction on there is no bounded force by rigid body accelerations, or more than one. Impulses
/// of a step exist all the same.
#[test]
fn a_rod_of_painleve_has_an_impulse() {
    for angle in [0.6_f64, 1.1] {
        let (inertia, arm) = (1.0 / 3.0_f64, [-angle.cos(), -angle.sin()]);
        let limit = (1.0 + 3.0 * angle.cos().powi(2)) / (3.0 * angle.sin() * angle.cos());
        for (part, slip) in [0.9, 1.1, 2.0].into_iter().flat_map(|part| [(part, 1.0), (part, -1.0)]) {
            let rows = [[0.0, 1.0, arm[0] / inertia.sqrt()], [1.0, 0.0, -arm[1] / inertia.sqrt()]];
            let offset = [-0.01, slip];
            let row_block =
                RowBlock { ends: [0, NONE], rows: [rows, [[0.0; 3]; 2]], offset, friction: part * limit, dilation: 0.0, norms: [1.0; 2] };
            let program = FrictionProgram {
                bodies: 1,
                row_blocks: vec![row_block],
                bounds: Vec::new(),
                unit: 1.0,
                medium: Rc::new(Medium::none()),
                modes: Vec::new(),
            };
            let end = follow(&program, &[[0.0; 2]], 1.0, FRICTION_TOLERANCE);
            assert!(end.residual <= FRICTION_TOLERANCE, "angle {angle}, {part} of the limit, slip {slip}: {:e}", end.residual);
        }
    }
}

/// What corrects the mobility makes it that of contacts which all give way more, and the law holds with it.
#[test]
fn the_interior_point_solves_with_modes_of_the_mobility() {
    fn solves<const D: usize, const W: usize>(mut program: FrictionProgram<D, W>) {
        let count = program.row_blocks.len();
        let wave = |phase: f64| (0..count).map(|place| std::array::from_fn(|axis| (phase * (D * place + axis) as f64).sin())).collect();
        program.modes = [(0.3, 0.7), (0.1, 1.9)].map(|(gain, phase)| MobilityMode { gain, rates: wave(phase) }).to_vec();
        let end = follow(&program, &vec![[0.0; D]; count], 1.0, FRICTION_TOLERANCE);
        assert!(end.residual <= FRICTION_TOLERANCE && end.iterations < 40, "{:e} after {}", end.residual, end.iterations);
        program.modes.clear();
        assert!(program.residual(&end.forces) > 1e-3);
    }
    solves(disks().program::<3>(0.3));
    solves(spheres().program::<6>(0.3));
}

#[test]
fn contacts_that_open_bear_nothing() {
    let mut pile = disks();
    pile.twists.iter_mut().for_each(|twist| (twist.velocity[1], twist.spin) = (10.0, skew(&[0.0])));
    pile.contacts.retain(|contact| contact.other().is_none());
    let program = pile.program::<3>(0.5);
    let found = solve_exactly(&program, vec![[1.0, 0.5]; program.row_blocks.len()], FRICTION_TOLERANCE);
    assert_eq!((found.residual, found.sweeps, program.residual(&found.forces)), (0.0, 0, 0.0));
    assert!(found.forces.iter().all(|force| *force == [0.0; 2]));
}

/// Disks or spheres in a row between two walls that come nearer, or that part: contacts leave no way, or do.
#[test]
fn contacts_that_must_close_are_jammed_and_others_are_not() {
    fn squeezed<const D: usize, const W: usize>(speed: f64, coefficient: f64) -> Option<bool> {
        let center = |body: usize| SVector::<f64, D>::from_fn(|axis, _| if axis + 1 == D { 1.0 + 2.0 * body as f64 } else { 50.0 });
        let balls: Vec<Ball<D>> = (0..3).map(|body| Ball { center: center(body), radius: 1.0 }).collect();
        let mut twists = vec![Twist::zero(); 3];
        twists[2].velocity[D - 1] = speed;
        let mut pile = Pile::new(balls, twists, (0.1, 0.1));
        // the last one is moved by hand
        pile.masses[2] = [f64::INFINITY; 2];
        pile.program::<W>(coefficient).is_jammed()
    }
    for coefficient in [0.0, 0.5, 2.0] {
        assert_eq!([-1e-3, 1e-3].map(|speed| squeezed::<2, 3>(speed, coefficient)), [Some(true), Some(false)]);
        assert_eq!([-1e-3, 1e-3].map(|speed| squeezed::<3, 6>(speed, coefficient)), [Some(true), Some(false)]);
    }
    assert_eq!(disks().program::<3>(0.5).is_jammed(), Some(false));
    assert_eq!(spheres().program::<6>(0.5).is_jammed(), Some(false));
}
