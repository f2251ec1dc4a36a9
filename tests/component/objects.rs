//! Tables of chains, cells and rigid clusters: what they say of objects that are followed step by step, across restarts and in any unit.

use std::{
    cell::RefCell,
    collections::BTreeSet,
    f64::consts::TAU,
    fs,
    io::Write,
    ops::Range,
    path::{Path, PathBuf},
    rc::Rc,
};

use nalgebra::{Rotation3, SVector, Vector2};
use turbid::{
    error::Result,
    output::Columns,
    petsc::Session,
    run::{NewRun, Options, Output, Run, RunFolder, View},
    scene::Scene,
};

use crate::Test;

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_ring_treads_as_far_as_its_beads_go_around_in_a_shear),
        Test::of(clusters_that_a_sheared_box_carries_along_have_places_and_angles_over_many_turns),
        Test::of(clusters_in_space_turn_about_their_vectors),
        Test::of(a_resumed_run_has_the_tables_of_the_whole_one),
        Test::of(lengths_of_tables_go_with_the_unit_and_angles_do_not),
        Test::of(tables_are_off_where_the_scene_says_so),
    ]
}

fn scene(text: &str) -> Scene {
    Scene::parse("objects", Path::new("."), text, &[]).unwrap()
}

/// Where bodies were at each step of a run.
#[derive(Default)]
struct Seen<const D: usize> {
    /// The balls of each cluster.
    clusters: Vec<Range<usize>>,
    /// Times with the centres of all bodies.
    steps: Vec<(f64, Vec<SVector<f64, D>>)>,
}

impl<const D: usize> Seen<D> {
    fn at(&self, time: f64) -> usize {
        self.steps.iter().position(|(own, _)| *own == time).unwrap()
    }
}

struct Follow<const D: usize>(Rc<RefCell<Seen<D>>>);

impl<const D: usize> Output<D> for Follow<D> {
    fn write(&mut self, view: &View<D>) -> Result<()> {
        let (mut seen, motion) = (self.0.borrow_mut(), view.motion.unwrap());
        seen.clusters = motion.simulation.interactions().clusters().iter().map(|cluster| cluster.bodies.clone()).collect();
        seen.steps.push((motion.state().time, view.whole_centers().unwrap().to_vec()));
        Ok(())
    }
}

fn folder(session: &Session, name: &str) -> PathBuf {
    std::env::temp_dir().join(session.world().broadcast(0, &format!("turbid-objects-{name}-{}", std::process::id())))
}

/// A run of a scene into a folder, and where its bodies were.
fn run<const D: usize>(session: &Session, scene: &Scene, path: &Path) -> Seen<D> {
    let seen = Rc::<RefCell<Seen<D>>>::default();
    let mut run = begin::<D>(session, scene, path);
    run.add(Box::new(Follow(Rc::clone(&seen))));
    run.complete().unwrap();
    session.world().barrier();
    seen.take()
}

fn begin<'a, const D: usize>(session: &'a Session, scene: &Scene, path: &Path) -> Run<'a, D> {
    let folder = RunFolder::to_begin(session.world(), path, NewRun { scene, scene_file: None, overwrite: true }).unwrap();
    Run::<D>::start(session, scene, Some(folder), Options::default()).unwrap()
}

fn table(path: &Path, name: &str) -> Columns {
    Columns::read(&path.join(name)).unwrap()
}

fn times(table: &Columns) -> BTreeSet<u64> {
    table.column("time").unwrap().iter().map(|time| time.to_bits()).collect()
}

fn clear(session: &Session, path: &Path) {
    session.world().barrier();
    session.world().on_first_rank(|| Ok(drop(fs::remove_dir_all(path)))).unwrap();
}

/// Angles that go on from one to the next without jumps by a turn.
fn over_turns(angles: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut last = None;
    let follow = |angle: f64| {
        let before = last.unwrap_or(angle);
        let now = angle + TAU * ((before - angle) / TAU).round();
        last = Some(now);
        now
    };
    angles.map(follow).collect()
}

fn middle<const D: usize>(centers: &[SVector<f64, D>], beads: &Range<usize>) -> SVector<f64, D> {
    centers[beads.clone()].iter().sum::<SVector<f64, D>>() / beads.len() as f64
}

fn angle(vector: Vector2<f64>) -> f64 {
    vector.y.atan2(vector.x)
}

/// Frames are so rare that the ring turns by more than half a turn from one to the next.
fn a_ring_treads_as_far_as_its_beads_go_around_in_a_shear(session: &Session) {
    let scene = scene(
        "domain = { size = [4.8, 4.8], y = { lower = [-4.8, 0.0], upper = [4.8, 0.0] } }\nflow = { model = \"stokes\" }\n\
         resolution = { cells_per_radius = 3 }\nmethod = { inverse = \"transform\" }\ntime = { end = 10.0, step = 0.1 }\n\
         chains = [{ count = 1, shape = \"ring\", beads = 8, radius = 0.3, spacing = 1.1, stretch = \"rigid\", bend = 40.0 }]\n\
         output = { every = 5.0, fields = false, picture = false, report = false }\n",
    );
    let path = folder(session, "ring");
    let seen = run::<2>(session, &scene, &path);
    let (cells, chains) = (table(&path, "cells.csv"), table(&path, "chains.csv"));
    let of_bead = |bead: usize| over_turns(seen.steps.iter().map(|(_, centers)| angle(centers[bead] - middle(centers, &(0..8)))));
    let beads: Vec<Vec<f64>> = (0..8).map(of_bead).collect();
    assert!(cells.rows() > 5 && cells.rows() < 30, "three frames and rows between them: {}", cells.rows());
    for row in 0..cells.rows() {
        let number = |name: &str| cells.number(name, row).unwrap();
        let place = seen.at(number("time"));
        let expected = beads.iter().map(|angles| angles[place] - angles[0]).sum::<f64>() / 8.0;
        assert!((number("tread") - expected).abs() < 1e-9, "{row}: {} {expected}", number("tread"));
        // bonds have constant lengths; of a regular octagon, 4 pi A / P^2 is pi / 8 / tan(pi / 8)
        assert!((number("perimeter") - 8.0 * 0.66).abs() < 1e-2 && (number("reduced_area") - 0.948).abs() < 1e-2, "{row}");
        assert!(number("deformation") < 0.1 && (number("y") - middle(&seen.steps[place].1, &(0..8)).y).abs() < 1e-12, "{row}");
    }
    let end = cells.rows() - 1;
    assert!(cells.number("tread", end).unwrap() < -TAU, "more than a turn, clockwise");
    // the only chain is a ring, which has no ends
    assert!(chains.column("end_to_end").is_none() && chains.column("angle").is_none());
    assert!((chains.number("contour_length", 0).unwrap() - 8.0 * 0.66).abs() < 1e-9);
    // the radius of the octagon
    assert!((chains.number("gyration", 0).unwrap() - 0.33 / (TAU / 16.0).sin()).abs() < 1e-9);
    clear(session, &path);
}

fn clusters_that_a_sheared_box_carries_along_have_places_and_angles_over_many_turns(session: &Session) {
    let scene = scene(
        "domain = { size = [4.0, 8.0] }\nflow = { model = \"stokes\", drive = { shear_rate = 2.0, periodic = \"sheared\" } }\n\
         resolution = { cells_per_radius = 3 }\nmethod = { inverse = \"transform\" }\ntime = { end = 8.0 }\n\
         clusters = [{ offsets = [[0.0, 0.0], [0.9, 0.0], [0.0, 0.8]], radius = 0.4, centers = [[1.0, 7.5], [2.0, 2.0]] }]\n\
         output = { every = 4.0, fields = false, picture = false, report = false }\n",
    );
    let path = folder(session, "sheared");
    let seen = run::<2>(session, &scene, &path);
    let clusters = table(&path, "clusters.csv");
    // the long axis is from the first ball to the farthest from that
    let arm = |centers: &[Vector2<f64>], balls: &Range<usize>| angle(centers[balls.start + 1] - centers[balls.start]);
    let of_cluster = |balls: &Range<usize>| over_turns(seen.steps.iter().map(|(_, centers)| arm(centers, balls)));
    let turned: Vec<Vec<f64>> = seen.clusters.iter().map(of_cluster).collect();
    for row in 0..clusters.rows() {
        let number = |name: &str| clusters.number(name, row).unwrap();
        let (place, cluster) = (seen.at(number("time")), number("cluster") as usize);
        let off = (middle(&seen.steps[place].1, &seen.clusters[cluster]) - Vector2::new(number("x"), number("y"))).norm();
        assert!(off < 1e-9, "{row}: {off:.1e}");
        let off = number("angle") - turned[cluster][place];
        assert!(off.abs() < 1e-9, "{row}: {off}");
    }
    let end = clusters.rows() - 2;
    assert!(clusters.number("x", end).unwrap() > 10.0 * 4.0, "many boxes along");
    assert!(clusters.number("angle", end + 1).unwrap() < -TAU, "more than a turn, clockwise");
    clear(session, &path);
}

fn clusters_in_space_turn_about_their_vectors(session: &Session) {
    let scene = scene(
        "seed = 4\ngravity = [0.0, 0.0, -1.0]\ndomain = { size = [4.0, 4.0, 8.0], z = \"walls\" }\nflow = { model = \"none\" }\n\
         contact = { model = \"inelastic\" }\ntime = { end = 4.0, step = 0.05 }\noutput = { every = 0.5, picture = false, report = false }\n\
         clusters = [{ shape = \"rod\", beads = 3, spacing = 1.05, radius = 0.4, count = 4 }]\n\
         chains = [{ beads = 3, radius = 0.3, spacing = 1.1, stretch = \"rigid\", bend = 1.0, count = 2 }]\n",
    );
    let path = folder(session, "space");
    let seen = run::<3>(session, &scene, &path);
    let (clusters, chains) = (table(&path, "clusters.csv"), table(&path, "chains.csv"));
    let vector = |table: &Columns, name: &str, row: usize| {
        SVector::<f64, 3>::from(["x", "y", "z"].map(|axis| table.number(&format!("{name}{axis}"), row).unwrap()))
    };
    assert_eq!((clusters.rows(), chains.rows(), times(&clusters).len()), (36, 18, 9));
    let mut largest: f64 = 0.0;
    for row in 0..clusters.rows() {
        let centers = |time: f64| &seen.steps[seen.at(time)].1[..];
        // two chains have the first numbers
        let balls = &seen.clusters[clusters.number("cluster", row).unwrap() as usize - 2];
        let arm = |centers: &[SVector<f64, 3>]| (centers[balls.end - 1] - centers[balls.start]).normalize();
        let (axis, turn, time) =
            (vector(&clusters, "axis_", row), vector(&clusters, "rotation_", row), clusters.number("time", row).unwrap());
        let turned = Rotation3::new(turn) * arm(centers(0.0));
        assert!((axis - arm(centers(time))).norm() < 1e-9 && (turned - axis).norm() < 1e-9, "{row}: {turn}");
        assert!((vector(&clusters, "", row) - middle(centers(time), balls)).norm() < 1e-9 && clusters.column("angle").is_none());
        // places -2.1, 0 and 2.1 radii along
        let expected = ((2.0 / 3.0 * 2.1_f64.powi(2) + 0.2) / 0.2).sqrt();
        assert!((clusters.number("aspect_ratio", row).unwrap() / expected - 1.0).abs() < 1e-9);
        largest = largest.max(turn.norm());
    }
    assert!(largest > 0.3, "no cluster has turned by more than {largest}");
    for row in 0..chains.rows() {
        let ends = vector(&chains, "end_to_end_", row);
        let [azimuth, polar, length] = ["azimuth", "polar", "end_to_end"].map(|name| chains.number(name, row).unwrap());
        let direction = SVector::from([polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos()]);
        assert!((direction * length - ends).norm() < 1e-12 && (length - ends.norm()).abs() < 1e-12);
    }
    clear(session, &path);
}

/// Chains with ends, a ring, cells and rods that fall on a floor.
fn falling(unit: f64, end: f64) -> Scene {
    let length = |numbers: &[f64]| format!("{:?}", numbers.iter().map(|number| number * unit).collect::<Vec<_>>());
    // energies of bends, and moduli of membranes
    let (bend, modulus) = (0.5 * unit.powi(4), 0.05 * unit.powi(5));
    scene(&format!(
        "seed = 5\ngravity = {}\ndomain = {{ size = {}, x = \"walls\", y = \"walls\" }}\nflow = {{ model = \"none\" }}\ncontact = {{ model = \"inelastic\" }}\n\
         chains = [{{ count = 2, beads = 5, radius = {radius:e}, spacing = 1.1, stretch = \"rigid\", bend = {:e} }},\n\
         {{ count = 1, shape = \"ring\", beads = 9, radius = {radius:e}, spacing = 1.1, stretch = \"rigid\", bend = {:e} }}]\n\
         cells = [{{ count = 1, beads = 24, radius = {:e}, stretch = \"rigid\", bend = {:e} }}]\n\
         clusters = [{{ count = 3, shape = \"rod\", beads = 3, radius = {radius:e} }}]\n\
         time = {{ end = {end}, step = 0.02 }}\noutput = {{ every = 0.25, checkpoint = 0, picture = false, report = false }}\n",
        length(&[0.0, -1.0]),
        length(&[8.0, 8.0]),
        bend,
        bend,
        0.15 * unit,
        modulus,
        radius = 0.3 * unit,
    ))
}

const TABLES: [&str; 3] = ["chains.csv", "cells.csv", "clusters.csv"];

/// A run that is dropped as a kill would end it, half way between frames, with half a row of what comes next.
fn a_resumed_run_has_the_tables_of_the_whole_one(session: &Session) {
    let (world, whole, parts) = (session.world(), folder(session, "whole"), folder(session, "parts"));
    run::<2>(session, &falling(1.0, 2.0), &whole);
    let mut killed = begin::<2>(session, &falling(1.0, 2.0), &parts);
    while killed.state().is_none_or(|state| state.steps < 60) {
        assert!(killed.advance().unwrap());
    }
    drop(killed);
    world.barrier();
    let half = || {
        TABLES.iter().for_each(|name| {
            let mut file = fs::OpenOptions::new().append(true).open(parts.join(name)).unwrap();
            file.write_all(b"1.25,0,0.5\n1.25,1").unwrap();
        });
        Ok(())
    };
    world.on_first_rank(half).unwrap();
    let mut folder = RunFolder::to_resume(world, &parts).unwrap();
    let (scene, checkpoint) = folder.read(&[]).unwrap();
    Run::<2>::resume(session, &scene, folder, &checkpoint, Options::default()).unwrap().complete().unwrap();
    world.barrier();
    for name in TABLES {
        let [once, again] = [&whole, &parts].map(|path| fs::read_to_string(path.join(name)).unwrap());
        let first = once.lines().zip(again.lines()).position(|(one, other)| one != other);
        assert!(once == again, "{name}: {first:?} of {} and {} lines", once.lines().count(), again.lines().count());
    }
    let (chains, cells) = (table(&whole, "chains.csv"), table(&whole, "cells.csv"));
    let rings = (0..chains.rows()).filter(|&row| chains.number("end_to_end", row).is_none() && chains.number("angle", row).is_none());
    assert_eq!(rings.count(), times(&chains).len(), "of three chains one has no ends");
    assert!(cells.rows() >= 2 * 9 && cells.number("tread", 0) == Some(0.0));
    clear(session, &whole);
    clear(session, &parts);
}

fn lengths_of_tables_go_with_the_unit_and_angles_do_not(session: &Session) {
    let paths = [("meters", 1.0), ("micrometers", 1e-6)].map(|(name, unit)| {
        let path = folder(session, name);
        run::<2>(session, &falling(unit, 0.5), &path);
        path
    });
    for (name, columns) in [
        ("chains.csv", &[("x", 1), ("end_to_end_y", 1), ("contour_length", 1), ("gyration", 1), ("angle", 0)][..]),
        (
            "cells.csv",
            &[("y", 1), ("area", 2), ("perimeter", 1), ("reduced_area", 0), ("deformation", 0), ("inclination", 0), ("tread", 0)],
        ),
        ("clusters.csv", &[("y", 1), ("angle", 0), ("aspect_ratio", 0)]),
    ] {
        let [large, small] = [&paths[0], &paths[1]].map(|path| table(path, name));
        assert_eq!(large.rows(), small.rows(), "{name}");
        for (column, power) in columns {
            for row in 0..large.rows() {
                let [one, other] = [&large, &small].map(|table| table.number(column, row));
                let scaled = other.map(|other| other * 1e6_f64.powi(*power));
                let alike = one.zip(scaled).map_or(one == scaled, |(one, scaled)| (one - scaled).abs() < 1e-5 * one.abs().max(1.0));
                assert!(alike, "{name} {column} {row}: {one:?} {scaled:?}");
            }
        }
    }
    paths.iter().for_each(|path| clear(session, path));
}

fn tables_are_off_where_the_scene_says_so(session: &Session) {
    let (mut scene, path) = (falling(1.0, 0.1), folder(session, "off"));
    scene.output.objects = Some(false);
    let files = begin::<2>(session, &scene.checked().unwrap(), &path).complete().unwrap().files;
    assert!(TABLES.iter().all(|name| !path.join(name).exists() && !files.iter().any(|file| file == name)), "{files:?}");
    clear(session, &path);
}
