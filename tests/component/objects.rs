//! Tables of chains, cells and rigid clusters: what they say of objects that are followed step by step.

use std::{
    cell::RefCell,
    collections::BTreeSet,
    f64::consts::TAU,
    fs,
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
    ]
}

pub fn scene(text: &str) -> Scene {
    Scene::parse("objects", Path::new("."), text, &[]).unwrap()
}

/// Where bodies were at each step of a run.
#[derive(Default)]
pub struct Seen<const D: usize> {
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

pub fn folder(session: &Session, name: &str) -> PathBuf {
    std::env::temp_dir().join(session.world().broadcast(0, &format!("turbid-objects-{name}-{}", std::process::id())))
}

/// Completes a run of a scene into a folder, and tells where its bodies were.
pub fn run<const D: usize>(session: &Session, scene: &Scene, path: &Path) -> Seen<D> {
    let seen = Rc::<RefCell<Seen<D>>>::default();
    let mut run = begin::<D>(session, scene, path);
    run.add(Box::new(Follow(Rc::clone(&seen))));
    run.complete().unwrap();
    session.world().barrier();
    seen.take()
}

pub fn begin<'a, const D: usize>(session: &'a Session, scene: &Scene, path: &Path) -> Run<'a, D> {
    let folder = RunFolder::to_begin(session.world(), path, NewRun { scene, scene_file: None, overwrite: true }).unwrap();
    Run::<D>::start(session, scene, Some(folder), Options::default()).unwrap()
}

pub fn table(path: &Path, name: &str) -> Columns {
    Columns::read(&path.join(name)).unwrap()
}

pub fn times(table: &Columns) -> BTreeSet<u64> {
    table.column("time").unwrap().iter().map(|time| time.to_bits()).collect()
}

pub fn clear(session: &Session, path: &Path) {
    session.world().barrier();
    if session.world().rank() == 0 {
        fs::remove_dir_all(path).unwrap();
    }
    session.world().barrier();
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
         resolution = { cells_per_radius = 3 }\nmethod = { inverse = \"transform\" }\ntime = { end = 14.0, step = 0.1 }\n\
         chains = [{ count = 1, shape = \"ring\", beads = 8, radius = 0.3, spacing = 1.1, stretch = \"rigid\", bend = 40.0 }]\n\
         output = { every = 7.0, fields = false, picture = false, report = false }\n",
    );
    let path = folder(session, "ring");
    let seen = run::<2>(session, &scene, &path);
    let (cells, chains) = (table(&path, "cells.csv"), table(&path, "chains.csv"));
    let of_bead = |bead: usize| over_turns(seen.steps.iter().map(|(_, centers)| angle(centers[bead] - middle(centers, &(0..8)))));
    let beads: Vec<Vec<f64>> = (0..8).map(of_bead).collect();
    assert!(cells.rows() > 3 && cells.rows() < 12, "three frames and rows between them: {}", cells.rows());
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
    let series = table(&path, "series.csv");
    assert!(series.column("end_to_end").is_none() && series.column("gyration").is_some());
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
        // contacts leave balls within 1e-8 of their places in the cluster
        assert!((axis - arm(centers(time))).norm() < 1e-7 && (turned - axis).norm() < 1e-9, "{row}: {turn}");
        assert!((vector(&clusters, "", row) - middle(centers(time), balls)).norm() < 1e-7 && clusters.column("angle").is_none());
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
