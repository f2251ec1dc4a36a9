//! The manual in `docs`: its pages, links and pictures exist, its scenes are accepted, its commands are understood or executed, and its references list all keys, columns and datasets.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use clap::{Parser, error::ErrorKind};
use turbid::{cli::Arguments, plan::Plan, scene::Scene};

const PROGRAM: &str = env!("CARGO_BIN_EXE_turbid");

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The pages of the manual with their names, and pages beside it.
fn pages() -> Vec<(PathBuf, String)> {
    let folders = ["docs", "docs/notes"].map(|folder| fs::read_dir(root().join(folder)).unwrap());
    let docs = folders.into_iter().flatten().map(|entry| entry.unwrap().path());
    let beside = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(|name| root().join(name));
    let pages = docs.filter(|path| path.extension().is_some_and(|ending| ending == "md")).chain(beside);
    pages.map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect()
}

/// Targets of links and pictures outside of code.
fn link_targets(text: &str) -> Vec<String> {
    let mut fenced = false;
    let outside = text.lines().filter(|line| {
        fenced ^= line.starts_with("```");
        !fenced && !line.starts_with("    ")
    });
    let targets = |line: &str| line.split("](").skip(1).filter_map(|rest| Some(rest.split_once(')')?.0.to_owned())).collect::<Vec<_>>();
    outside.flat_map(targets).collect()
}

/// Blocks of code with the words after their fence.
fn blocks(text: &str) -> Vec<(String, String)> {
    let mut found: Vec<(String, String)> = Vec::new();
    let mut inside = false;
    for line in text.lines() {
        match line.strip_prefix("```") {
            Some(words) if !inside => found.push((words.to_owned(), String::new())),
            None if inside => found.last_mut().unwrap().1 += &format!("{line}\n"),
            _ => {}
        }
        inside ^= line.starts_with("```");
    }
    found
}

/// Words of a command of a shell, up to what is not the command's own.
fn words(line: &str) -> Vec<String> {
    let (mut words, mut word, mut quote) = (Vec::new(), String::new(), None);
    let mut signs = line.chars().peekable();
    while let Some(sign) = signs.next() {
        match (sign, quote) {
            (_, Some(open)) if sign == open => quote = None,
            (_, Some(_)) => word.push(sign),
            ('"' | '\'', None) => quote = Some(sign),
            ('>' | '|' | ';' | '#' | '\u{60}', None) => break,
            // what follows two spaces is an explanation
            (' ', None) if signs.peek() == Some(&' ') => break,
            (' ', None) => words.push(std::mem::take(&mut word)),
            _ => word.push(sign),
        }
    }
    words.push(word);
    words.into_iter().filter(|word| !word.is_empty()).collect()
}

/// Commands of a page: in lines of code, and between backquotes.
fn commands(text: &str) -> Vec<String> {
    let (mut found, mut fenced) = (Vec::new(), false);
    for line in text.lines() {
        fenced ^= line.starts_with("```");
        let code = fenced || line.starts_with("    ");
        let starts = line.match_indices("turbid ").map(|(place, _)| line.split_at(place)).filter(|(before, _)| {
            let launched = ["mpirun -n ", "srun "].iter().any(|launcher| before.trim().starts_with(launcher));
            before.ends_with('`') || code && (before.trim().is_empty() || launched && !before.contains("  turbid"))
        });
        found.extend(starts.map(|(_, command)| command.to_owned()));
    }
    let shown = |line: &String| !line.contains("..") && !line.contains('[') && !line.starts_with("turbid help");
    found.into_iter().filter(shown).collect()
}

/// The words of a command as the program takes them; of a command that is only named, those that ask for its help.
fn arguments(command: &str) -> Vec<String> {
    let words: Vec<String> = words(command).into_iter().map(|word| if word == "SHELL" { "bash".to_owned() } else { word }).collect();
    if words.len() == 2 && !words[1].starts_with('-') { [words, vec!["--help".to_owned()]].concat() } else { words }
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("turbid-manual-{name}-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn every_page_is_in_the_summary_and_every_chapter_exists() {
    let summary = fs::read_to_string(root().join("docs/SUMMARY.md")).unwrap();
    let chapters: BTreeSet<String> = link_targets(&summary).into_iter().collect();
    let there = pages().into_iter().filter_map(|(path, _)| Some(path.strip_prefix(root().join("docs")).ok()?.to_str()?.to_owned()));
    let there: BTreeSet<String> = there.filter(|name| name != "SUMMARY.md").collect();
    assert_eq!(chapters, there);
}

#[test]
fn links_and_pictures_lead_to_files() {
    let (mut broken, mut count) = (Vec::new(), 0);
    for (path, text) in pages() {
        for link in link_targets(&text).iter().filter(|link| !link.starts_with("http") && !link.starts_with('#')) {
            count += 1;
            let file = path.parent().unwrap().join(link.split('#').next().unwrap());
            if !file.exists() {
                broken.push(format!("{}: {link}", path.display()));
            }
        }
    }
    assert!(count > 80 && broken.is_empty(), "{count} links; {}", broken.join("\n"));
}

#[test]
fn commands_are_those_of_the_program() {
    let (mut wrong, mut count) = (Vec::new(), 0);
    for (path, text) in pages() {
        for command in commands(&text) {
            count += 1;
            match Arguments::try_parse_from(arguments(&command)).map_err(|error| error.kind()) {
                Ok(_) | Err(ErrorKind::DisplayVersion | ErrorKind::DisplayHelp) => {}
                Err(kind) => wrong.push(format!("{}: {command}: {kind}", path.display())),
            }
        }
    }
    assert!(count > 80 && wrong.is_empty(), "{count} commands; {}", wrong.join("\n"));
}

#[test]
fn scenes_are_planned_and_marked_commands_end_well() {
    let path = format!("{}:{}", Path::new(PROGRAM).parent().unwrap().display(), std::env::var("PATH").unwrap());
    let (mut scenes, mut scripts) = (0, 0);
    for (page, text) in pages() {
        let folder = folder(page.file_stem().unwrap().to_str().unwrap());
        let marked = |mark: &str| blocks(&text).into_iter().filter(|(words, _)| words == mark).map(|(_, text)| text).collect::<Vec<_>>();
        let written: Vec<PathBuf> = marked("toml,scene").iter().map(|scene| write(&folder, scene)).collect();
        for script in marked("sh,run") {
            scripts += 1;
            let run = Command::new("bash").args(["-e", "-c", &script]).current_dir(&folder).env("PATH", &path).output().unwrap();
            assert!(run.status.success(), "{}: {script}{}", page.display(), String::from_utf8_lossy(&run.stderr));
        }
        for scene in &written {
            scenes += 1;
            let scene = Scene::read(scene, &[]).unwrap_or_else(|error| panic!("{}: {error}", page.display()));
            let plan = if scene.dimension() == 2 { Plan::<2>::of(&scene).map(drop) } else { Plan::<3>::of(&scene).map(drop) };
            plan.unwrap_or_else(|error| panic!("{}: {error}", page.display()));
        }
        fs::remove_dir_all(folder).unwrap();
    }
    assert!(scenes >= 7 && scripts >= 3, "{scenes} scenes, {scripts} scripts");
}

/// Writes a scene under the name in its first line.
fn write(folder: &Path, scene: &str) -> PathBuf {
    let name = scene.lines().next().unwrap().strip_prefix("# ").expect("a scene of the manual begins with its name");
    fs::write(folder.join(name), scene).unwrap();
    folder.join(name)
}

#[test]
fn the_reference_of_scenes_is_that_of_the_program() {
    let printed = Command::new(PROGRAM).args(["keys", "--markdown"]).output().unwrap().stdout;
    let page = fs::read_to_string(root().join("docs/scene-reference.md")).unwrap();
    assert!(String::from_utf8(printed).unwrap() == page, "stale; turbid keys --markdown > docs/scene-reference.md writes it anew");
}

#[test]
fn the_columns_of_a_series_are_those_of_the_program() {
    let printed = String::from_utf8(Command::new(PROGRAM).args(["columns", "--markdown"]).output().unwrap().stdout).unwrap();
    let page = fs::read_to_string(root().join("docs/output-reference.md")).unwrap();
    let own = page.split("## `series.csv`").nth(1).unwrap().split("\n## ").next().unwrap();
    assert!(own.contains(&printed), "the table of series.csv is stale; turbid columns --markdown prints\n{printed}");
}

/// Short runs that between them have every kind of column and dataset.
const RUNS: [&str; 7] = [
    "domain = { size = [8.0, 8.0], y = { lower = [-1.0, 0.0], upper = [1.0, 0.0] } }\ncontact.model = \"gluey\"\nlubrication.model = \"pairwise\"\n\
     output.vorticity = true\n[[bodies]]\nradius = 1.0\ncount = 2\n[[chains]]\ncount = 1\nbeads = 2\nradius = 1.0\nstretch = \"rigid\"\n",
    "domain = { size = [14.0, 8.0], y = { lower = [-1.0, 0.0], upper = [1.0, 0.0] } }\ncontact = { model = \"repulsion\", stiffness = 1e-3 }\n[[cells]]\n\
     centers = [[5.0, 4.0]]\nbeads = 24\nradius = 0.3\nstretch = \"rigid\"\nbend = 0.03\n[[clusters]]\ncenters = [[12.0, 4.0]]\nshape = \"rod\"\nbeads = 2\nradius = 0.5\n",
    "domain = { size = [9.0, 9.0, 9.0] }\nflow.drive = { shear_rate = 1.0, periodic = \"sheared\" }\ncontact.model = \"inelastic\"\n[[bodies]]\nradius = 1.0\n\
     count = 1\n[[chains]]\ncount = 1\nbeads = 2\nradius = 1.0\nstretch = 10.0\n[[clusters]]\ncount = 1\nshape = \"rod\"\nbeads = 2\nradius = 1.0\n",
    "domain = { size = [24.0, 10.0, 24.0] }\nflow.drive = { shear_rate = 1.0, periodic = \"sheared\" }\noutput.fields = false\n[[cells]]\n\
     centers = [[12.0, 5.0, 12.0]]\nbeads = 42\nradius = 1.0\nstretch = 23.0\nbend = 43.0\n",
    "domain = { size = [8.0, 8.0], y = { lower = [-1.0, 0.0], upper = [1.0, 0.0] } }\nflow = { model = \"navier-stokes\", density = 1.0 }\n[[bodies]]\n\
     radius = 1.0\ncenters = [[2.0, 4.0]]\n[[bodies]]\nradius = 1.0\ncenters = [[6.0, 4.0]]\nmotion = \"fixed\"\n",
    "domain = { size = [6.0, 6.0, 6.0] }\nflow.drive = { mean_velocity = [1.0, 0.0, 0.0] }\nflow.density = 1.0\noutput.reference_velocity = [1.0, 0.0, 0.0]\n\
     [[bodies]]\nradius = 1.0\ncenters = [[3.0, 3.0, 3.0]]\nmotion = \"fixed\"\n",
    "domain = { size = [8.0, 8.0], y = \"walls\" }\nflow = { model = \"navier-stokes\", density = 1.0 }\noutput.energy = true\n\
     contact.model = \"inelastic\"\nlubrication.model = \"pairwise\"\n[[bodies]]\nradius = 1.0\ncenters = [[2.0, 4.0]]\nforce = [1.0, 0.0]\n",
];

#[test]
fn the_reference_of_outputs_has_every_file_column_and_dataset() {
    let page = fs::read_to_string(root().join("docs/output-reference.md")).unwrap();
    let (mut missing, mut seen) = (BTreeSet::new(), BTreeSet::new());
    for (number, text) in RUNS.iter().enumerate() {
        let folder = folder(&format!("columns-{number}"));
        let scene = format!("seed = 3\nresolution.cells_per_radius = 3\nmethod.inverse = \"auto\"\n{text}[time]\nend = 0.1\nstep = 0.1\n");
        fs::write(folder.join("scene.toml"), scene).unwrap();
        let run = Command::new(PROGRAM).args(["run", "scene.toml", "--out", "out"]).current_dir(&folder).output().unwrap();
        assert!(run.status.success(), "{text}{}", String::from_utf8_lossy(&run.stderr));
        let names = names(&folder.join("out"));
        missing.extend(names.iter().filter(|name| !page.contains(&format!("`{name}`"))).cloned());
        seen.extend(names);
        fs::remove_dir_all(folder).unwrap();
    }
    assert!(missing.is_empty(), "docs/output-reference.md lacks {missing:?}");
    for rare in [
        "stuck",
        "bond_energy",
        "area_error",
        "volume_error",
        "courant",
        "lift_z_0",
        "end_to_end_x",
        "phase",
        "reduced_volume",
        "rotation_z",
        "dissipated_films",
        "faces/topology",
        "fields/vorticity",
    ] {
        assert!(seen.contains(rare), "no run has {rare}: the test sees too little");
    }
}

/// Names of the files of a run, of the columns of its tables and of the datasets of its last frame.
fn names(out: &Path) -> BTreeSet<String> {
    let files = fs::read_dir(out).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).filter(|name| name != "frames");
    let tables = ["series.csv", "forces.csv", "energy.csv", "chains.csv", "cells.csv", "clusters.csv"];
    let columns = tables.into_iter().filter_map(|table| fs::read_to_string(out.join(table)).ok());
    let columns = columns.flat_map(|table| table.lines().next().unwrap().split(',').map(of_body_0).collect::<Vec<_>>());
    let mut frames: Vec<PathBuf> = fs::read_dir(out.join("frames")).unwrap().map(|entry| entry.unwrap().path()).collect();
    frames.sort();
    let frame = hdf5::File::open(frames.last().unwrap()).unwrap();
    let groups = frame.groups().unwrap();
    let datasets =
        groups.iter().flat_map(|group| group.datasets().unwrap()).map(|dataset| dataset.name().trim_start_matches('/').to_owned());
    files.chain(columns).chain(datasets).collect()
}

/// The name of a column that belongs to a body as the page has it, of body 0.
fn of_body_0(column: &str) -> String {
    match column.rsplit_once('_') {
        Some((name, body)) if body.bytes().all(|sign| sign.is_ascii_digit()) => format!("{name}_0"),
        _ => column.to_owned(),
    }
}
