//! Tables of chains, cells and rigid clusters across restarts, in any unit, and switched off.

use std::{fs, io::Write};

use turbid::{
    petsc::Session,
    run::{Options, Run, RunFolder},
    scene::Scene,
};

use crate::{
    Test,
    objects::{begin, clear, folder, run, scene, table, times},
};

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_resumed_run_has_the_tables_of_the_whole_one),
        Test::of(lengths_of_tables_go_with_the_unit_and_angles_do_not),
        Test::of(tables_are_off_where_the_scene_says_so),
    ]
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
