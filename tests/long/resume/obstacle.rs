//! What is told of a stream past bodies with prescribed motion: forces, coefficients, vorticity.

use std::{fs, os::unix::fs::PermissionsExt, path::Path};

use crate::common::{Series, command, difference, folder, number, resume, run, said, scenes::OBSTACLE, turbid, write};

/// The same arithmetic on the same ranks; what is left is the order of sums.
const SAME: f64 = 1e-10;

fn forces(out: &Path) -> Series {
    Series::read_table(&out.join("forces.csv"))
}

#[test]
fn forces_on_bodies_whose_motion_is_given_are_told_step_by_step_across_a_restart() {
    let here = folder("obstacle-halves");
    let (scene, once, twice) = (write(&here, OBSTACLE), here.join("once"), here.join("twice"));
    let summary = run(2, &scene, &once, &[]);
    run(2, &scene, &twice, &["time.end=0.16"]);
    resume(2, &twice, &["time.end=0.32"]);
    let (whole, halves) = (forces(&once), forces(&twice));
    let (distance, column) = whole.difference(&halves, &[]);
    assert!(distance <= SAME, "{column} differs by {distance:.1e}");
    let of_body = |body: usize| ["force_x", "force_y", "torque", "drag", "lift"].map(|name| format!("{name}_{body}"));
    let columns: Vec<String> = ["step", "time"].map(str::to_owned).into_iter().chain(of_body(0)).chain(of_body(2)).collect();
    assert_eq!(whole.columns, columns, "the free disk is not among them");
    assert!(whole.rows[0][2..].iter().all(|number| number.is_infinite()), "no flow leads to the start: {:?}", whole.rows[0]);
    let last = whole.rows.len() - 1;
    assert_eq!(last as f64, number(&summary, "steps"));
    for body in [0, 2] {
        let reported = [0, 1].map(|axis| number(&summary, &format!("bodies.{body}.force.{axis}")));
        let found = ["force_x", "force_y"].map(|name| whole.at(last, &format!("{name}_{body}")));
        assert!(difference(&reported, &found) <= SAME, "{reported:?} {found:?}");
        // density 2, speed 2, radius 0.5: half of density times its square, over the diameter, is 4
        let coefficients = ["drag", "lift"].map(|name| 4.0 * whole.at(last, &format!("{name}_{body}")));
        assert!(difference(&reported, &coefficients) <= SAME, "{reported:?} {coefficients:?}");
    }
    assert!(whole.at(last, "drag_0") > 0.1, "the stream drags along the disk that stays");
}

#[test]
fn forces_and_vorticity_are_the_same_on_any_number_of_ranks_and_are_drawn() {
    let here = folder("obstacle-ranks");
    let scene = write(&here, OBSTACLE);
    let frame =
        |out: &Path| hdf5::File::open(out.join("run.h5")).unwrap().dataset("frames/000004/fields/vorticity").unwrap().read_raw::<f64>();
    let all = [1, 2, 3].map(|ranks| {
        let out = here.join(ranks.to_string());
        run(ranks, &scene, &out, &[]);
        (forces(&out), frame(&out).unwrap())
    });
    assert_eq!(all[0].1.len(), 60 * 40);
    assert!(all[0].1.iter().any(|vorticity| *vorticity > 1.0) && all[0].1.iter().any(|vorticity| *vorticity < -1.0));
    for (forces, vorticity) in &all[1..] {
        let (distance, column) = all[0].0.difference(forces, &[]);
        assert!(distance <= 1e-5, "{column} differs by {distance:.1e}");
        assert!(difference(&all[0].1, vorticity) <= 1e-5);
    }
    let out = here.join("1");
    let picture = fs::read_to_string(out.join("picture.svg")).unwrap();
    assert!(picture.contains(">vorticity"), "the picture is coloured by it");
    let output = turbid(1, &["animate", out.to_str().unwrap(), "--width", "300"]);
    assert!(output.status.success(), "{}", said(&output));
    assert!(out.join("animation.png").exists());
    let film = here.join("film.gif");
    let output = turbid(1, &["animate", out.to_str().unwrap(), "--width", "200", "--out", film.to_str().unwrap()]);
    assert!(output.status.success() && fs::read(&film).unwrap().starts_with(b"GIF89a"), "{}", said(&output));
    // ffmpeg need not be installed here: what stands for it writes the format that it is asked for into the file that it is given
    let program = here.join("ffmpeg");
    fs::write(
        &program,
        "#!/bin/sh\n[ \"$1\" = -version ] && exit 0\nfor last; do format=$before; before=$last; done\necho \"$format\" >\"$last\"\n",
    )
    .unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    let (film, path) = (here.join("film.webm"), format!("{}:/usr/bin:/bin", here.display()));
    let output = command(1, &["animate", out.to_str().unwrap(), "--out", film.to_str().unwrap()]).env("PATH", path).output().unwrap();
    assert!(output.status.success() && fs::read_to_string(&film).unwrap() == "webm\n", "{}", said(&output));
    let left = |name: &str| name.starts_with("film.") && name != "film.gif" && name != "film.webm";
    assert!(!fs::read_dir(&here).unwrap().any(|entry| left(&entry.unwrap().file_name().to_string_lossy())), "something is left");
}

#[test]
fn an_animation_of_what_no_frame_holds_is_refused() {
    let here = folder("obstacle-without-fields");
    let out = here.join("out");
    run(1, &write(&here, OBSTACLE), &out, &["output.fields=false", "time.end=0.02", "output.every=0.01"]);
    let output = turbid(1, &["animate", out.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("no frame of the run holds the flow"), "{}", said(&output));
}

#[test]
fn coefficients_of_more_bodies_than_a_row_has_room_for_are_refused() {
    let here = folder("obstacle-many");
    let many: String = (0..17).map(|body| format!("[{}, 2.0], ", 0.2 + 0.3 * f64::from(body))).collect();
    let text = OBSTACLE
        .replace("[[1.5, 2.2]]", &format!("[{many}]"))
        .replace("radius = 0.5\ncenters = [[4.5, 1.2]]", "radius = 0.1\ncenters = [[4.5, 0.5]]");
    let scene = write(&here, &text.replacen("radius = 0.5", "radius = 0.1", 1));
    let output = turbid(1, &["run", scene.to_str().unwrap(), "--out", here.join("out").to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(said(&output).contains("room for 16 bodies with prescribed motion, and there are 18"), "{}", said(&output));
}

#[test]
fn the_plan_of_a_flow_with_inertia_tells_its_seconds() {
    let here = folder("obstacle-plan");
    let scene = write(&here, OBSTACLE);
    let output = turbid(1, &["plan", scene.to_str().unwrap()]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("velocity, pressure and vorticity of each cell") && said.contains("of the fluid on 2 bodies"), "{said}");
    let steps = said.split_once(" steps: ").and_then(|(_, rest)| rest.split_once(" steps")).map(|(steps, _)| steps.parse::<f64>());
    let forecast = steps.unwrap_or_else(|| panic!("no steps in: {said}")).unwrap();
    let taken = number(&run(1, &scene, &here.join("out"), &[]), "steps");
    assert!((forecast / taken - 1.0).abs() < 0.3, "{forecast} steps are told, {taken} are taken");
}
