//! The convex law of friction, and a tolerance looser than the usual one, together with what else a scene may have.

use std::{ops::Range, path::Path};

use nalgebra::SVector;
use turbid::{contact::FrictionReport, mechanics::History, motion::Simulation, petsc::Session, scene::Scene};

use crate::{
    Test,
    dry::smallest_gap,
    friction::{step, steps},
    friction_of_tied::{CHAINS, HEAP, RODS, energy},
    friction_with_all::{PULLED, SHEARED, WALLS, proves, scene_text},
};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(rods_and_disks_in_a_flow_obey_the_convex_law),
        Test::only_on(1, chains_and_rings_in_a_flow_obey_the_convex_law),
        Test::only_on(1, clusters_in_space_in_a_flow_obey_the_convex_law),
        Test::of(a_restart_in_a_flow_goes_on_by_the_convex_law),
        Test::of(all_that_is_dry_obeys_the_convex_law),
        Test::of(all_that_is_dry_meets_a_loose_tolerance),
        Test::of(restarts_repeat_dry_runs),
    ]
}

const CONVEX: &str = "friction = { coefficient = 0.5, law = \"convex\" }";

/// A scene in a flow with the convex law in the place of the exact one.
fn convex(text: &str) -> String {
    text.replace("friction = 0.5", CONVEX).replace("step = 0.05", "step = 0.05, scheme = \"euler\"")
}

fn every(beads: usize, bodies: Range<usize>) -> Vec<Range<usize>> {
    bodies.step_by(beads).map(|first| first..first + beads).collect()
}

fn rods_and_disks(force: &str) -> String {
    format!(
        "clusters = [{{ shape = \"rod\", beads = 3, radius = 0.5, count = 6, gap = 0.06{force} }}]\n\
         bodies = [{{ radius = 0.5, count = 8, gap = 0.06{force} }}]"
    )
}

fn rods_and_disks_in_a_flow_obey_the_convex_law(session: &Session) {
    let groups: Vec<_> = every(3, 0..18).into_iter().chain(every(1, 18..26)).collect();
    proves::<2>(session, &convex(&scene_text(WALLS, 4.0, &rods_and_disks(PULLED))), &groups, 5);
    proves::<2>(session, &convex(&scene_text(SHEARED, 4.0, &rods_and_disks(""))).replace("end = 0.6", "end = 1.0"), &groups, 1);
}

fn chains_and_rings_in_a_flow_obey_the_convex_law(session: &Session) {
    let chains = "chains = [{ beads = 4, radius = 0.5, spacing = 1.06, stretch = \"rigid\", bend = 5.0, count = 6, gap = 0.06, force = [0.0, -400.0] }]";
    proves::<2>(session, &convex(&scene_text(WALLS, 4.0, chains)), &every(4, 0..24), 5);
    let ring = "chains = [{ beads = 8, radius = 0.5, spacing = 1.06, stretch = \"rigid\", bend = 5.0, shape = \"ring\", count = 1, \
                force = [0.0, -200.0] }]";
    proves::<2>(session, &convex(&scene_text(WALLS, 4.0, ring)), &every(8, 0..8), 1);
}

fn clusters_in_space_in_a_flow_obey_the_convex_law(session: &Session) {
    let domain =
        "domain = { size = [4.0, 3.2, 3.2], y = { lower = [-1.6, 0.0, 0.0], upper = [1.6, 0.0, 0.0] } }\nflow = { model = \"stokes\" }";
    let bodies = "clusters = [{ shape = \"rod\", beads = 2, radius = 0.6, count = 4, gap = 0.06, force = [0.0, -400.0, 0.0] }]";
    proves::<3>(session, &convex(&scene_text(domain, 3.0, bodies)), &every(2, 0..8), 3);
}

fn simulation<const D: usize>(session: &Session, text: &str) -> Simulation<D> {
    Simulation::new(session, &Scene::parse("pairs", Path::new("."), text, &[]).unwrap()).unwrap()
}

fn a_restart_in_a_flow_goes_on_by_the_convex_law(session: &Session) {
    let text = convex(&scene_text(WALLS, 4.0, &rods_and_disks(PULLED)));
    let advance = |simulation: &mut Simulation<2>, count: usize| {
        for _ in 0..count {
            let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
            simulation.step(&observation, &mut |_, _| {}).unwrap();
        }
    };
    let (mut whole, mut again) = (simulation::<2>(session, &text), simulation::<2>(session, &text));
    advance(&mut whole, 8);
    assert!(whole.state().contact_history.iter().any(|held| held.tangential != SVector::<f64, 2>::zeros()), "nothing rubs");
    again.restore(whole.state().clone(), History::default()).unwrap();
    advance(&mut whole, 3);
    advance(&mut again, 3);
    let apart = whole.state().bodies.iter().zip(&again.state().bodies).map(|(one, other)| (one.center - other.center).norm());
    let apart = apart.fold(0.0, f64::max);
    assert!(apart < 1e-5, "{apart:e}");
}

const CELL: &str = "seed = 1\ngravity = [0.0, -1.0]\ndomain = { size = [12.0, 8.0], y = \"walls\" }\nflow = { model = \"none\" }\n\
                    cells = [{ count = 1, beads = 24, radius = 0.3, stretch = 2000.0, bend = 5.0, density = 1.0 }]\n\
                    contact = { model = \"inelastic\", friction = 0.5 }\ntime = { end = 100.0, step = 0.02, scheme = \"euler\" }\n";
const SPHERES: &str = "seed = 2\ngravity = [0.3, 0.0, -1.0]\ndomain = { size = [6.0, 6.0, 9.0], z = \"walls\" }\nflow = { model = \"none\" }\n\
                       bodies = [{ radius = 0.5, count = 40, gap = 0.05, density = 1.0 }, { radius = 0.7, count = 20, gap = 0.05, density = 1.0 }]\n\
                       contact = { model = \"inelastic\", friction = 0.5 }\ntime = { end = 100.0, step = 0.05, scheme = \"euler\" }\n";

/// So many steps of a dry scene in which this many contacts rub, at least, in all together: nothing overlaps, each step meets the law to a residual.
fn obeys<const D: usize>(session: &Session, text: &str, (count, least): (usize, usize), residual: f64) -> Simulation<D> {
    let mut simulation = simulation::<D>(session, text);
    let mut rubbed = 0;
    for number in 0..count {
        let report = step(&mut simulation);
        assert!(report.residual < residual, "step {number}: {report:?}");
        rubbed += report.sticking + report.slipping;
    }
    let gap = smallest_gap(&simulation);
    assert!(rubbed >= least && gap > -1e-7, "{rubbed} contacts, smallest gap {gap:e}");
    simulation
}

fn all_that_is_dry_obeys_the_convex_law(session: &Session) {
    let residual = FrictionReport::TOLERANCE;
    for groups in [RODS, CHAINS] {
        let text = format!("{HEAP}{groups}").replace("friction = 0.5", CONVEX);
        let fallen = obeys::<2>(session, &text, (100, 300), 1e-6);
        assert!(energy(&fallen) < 0.5 * energy(&simulation(session, &text)), "{groups}");
    }
    obeys::<2>(session, &CELL.replace("friction = 0.5", CONVEX), (150, 10), 1e-5);
    obeys::<3>(session, &SPHERES.replace("friction = 0.5", CONVEX), (80, 300), residual);
}

fn all_that_is_dry_meets_a_loose_tolerance(session: &Session) {
    let loose = |text: &str| text.replace("friction = 0.5", "friction = 0.5, tolerance = 1e-3");
    let residual = FrictionReport::tolerance_of(1e-3);
    for groups in [RODS, CHAINS] {
        let text = format!("{HEAP}{groups}");
        let [tight, loose] = [text.clone(), loose(&text)].map(|text| energy(&obeys::<2>(session, &text, (120, 500), residual)));
        assert!((loose / tight - 1.0).abs() < 0.05, "{groups}: energy {loose} for {tight}");
    }
    obeys::<2>(session, &loose(CELL), (150, 10), residual);
    obeys::<3>(session, &loose(SPHERES), (100, 500), residual);
}

fn restarts_repeat_dry_runs(session: &Session) {
    let laws = [CONVEX, "friction = 0.5, tolerance = 1e-3"];
    for text in laws.map(|law| SPHERES.replace("friction = 0.5", law)) {
        let start = || simulation::<3>(session, &text);
        let (mut whole, mut first, mut second) = (start(), start(), start());
        steps(&mut whole, 50);
        steps(&mut first, 35);
        second.restore(first.whole_state().into_owned(), History::default()).unwrap();
        steps(&mut second, 15);
        let (one, two) = (whole.whole_state(), second.whole_state());
        assert!(!one.contact_history.is_empty() && *one == *two, "a run that was interrupted is another one");
    }
}
