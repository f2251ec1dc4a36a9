//! How tests start the program and read what it leaves behind.

#![allow(dead_code, clippy::unwrap_used, reason = "each test binary takes what it needs")]

pub mod scenes;

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

use serde_json::Value;

pub const PROGRAM: &str = env!("CARGO_BIN_EXE_turbid");

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A folder of its own for a test, empty.
pub fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

/// Writes a scene into a folder.
pub fn write(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("scene.toml");
    fs::write(&path, text).unwrap();
    path
}

/// The words that start the program on so many ranks.
pub fn words(ranks: usize) -> Vec<String> {
    let count = ranks.to_string();
    let words = if ranks == 1 { vec![PROGRAM] } else { vec!["mpirun", "--oversubscribe", "-n", &count, PROGRAM] };
    words.into_iter().map(str::to_owned).collect()
}

/// The program on so many ranks, not yet started.
pub fn command(ranks: usize, arguments: &[&str]) -> Command {
    let words = words(ranks);
    let mut command = Command::new(&words[0]);
    command.args(&words[1..]).args(arguments);
    settle(&mut command);
    command
}

/// What every command of a test needs: a place, and what Open MPI asks of root.
pub fn settle(command: &mut Command) {
    command.current_dir(root());
    command.envs([("OMPI_ALLOW_RUN_AS_ROOT", "1"), ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"), ("OMP_NUM_THREADS", "1")]);
    // tests run side by side: a rank that waits leaves its core to the others
    command.env("OMPI_MCA_mpi_yield_when_idle", "1");
}

pub fn turbid(ranks: usize, arguments: &[&str]) -> Output {
    command(ranks, arguments).output().unwrap()
}

/// What a command said about what went wrong.
pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs a scene to its end.
pub fn run(ranks: usize, scene: &Path, out: &Path, settings: &[&str]) -> Value {
    reach_the_end(ranks, &["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap()], out, settings)
}

/// Runs a scene to its end in a folder where another run may be.
pub fn run_again(ranks: usize, scene: &Path, out: &Path, settings: &[&str]) -> Value {
    reach_the_end(ranks, &["run", scene.to_str().unwrap(), "--force", "--out", out.to_str().unwrap()], out, settings)
}

/// Resumes a run to its end.
pub fn resume(ranks: usize, out: &Path, settings: &[&str]) -> Value {
    reach_the_end(ranks, &["resume", out.to_str().unwrap()], out, settings)
}

fn reach_the_end(ranks: usize, arguments: &[&str], out: &Path, settings: &[&str]) -> Value {
    let mut arguments = arguments.to_vec();
    settings.iter().for_each(|setting| arguments.extend(["--set", setting]));
    let output = turbid(ranks, &arguments);
    assert!(output.status.success(), "{arguments:?} on {ranks} ranks: {}", said(&output));
    summary(out)
}

pub fn summary(out: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(out.join("summary.json")).unwrap()).unwrap()
}

/// The number at a path of a summary; `list.*.path` is the mean over a list.
pub fn number(summary: &Value, path: &str) -> f64 {
    if let Some((list, rest)) = path.split_once(".*.") {
        let members = summary[list].as_array().unwrap();
        return members.iter().map(|member| number(member, rest)).sum::<f64>() / members.len() as f64;
    }
    let pointer = format!("/{}", path.replace('.', "/"));
    summary.pointer(&pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("no number at {path}"))
}

/// All numbers of the bodies of a summary.
pub fn bodies(summary: &Value) -> Vec<f64> {
    fn gather(value: &Value, numbers: &mut Vec<f64>) {
        match value {
            Value::Array(values) => values.iter().for_each(|value| gather(value, numbers)),
            Value::Object(entries) => entries.values().for_each(|value| gather(value, numbers)),
            other => numbers.push(other.as_f64().unwrap()),
        }
    }
    let mut numbers = Vec::new();
    gather(&summary["bodies"], &mut numbers);
    assert!(!numbers.is_empty());
    numbers
}

/// Largest difference of numbers, relative where they are large.
pub fn difference(one: &[f64], two: &[f64]) -> f64 {
    assert_eq!(one.len(), two.len());
    let distance = |(one, two): (&f64, &f64)| if one == two { 0.0 } else { (one - two).abs() / one.abs().max(1.0) };
    one.iter()
        .zip(two)
        .map(distance)
        .fold(0.0, |largest, distance| if distance > largest || distance.is_nan() { distance } else { largest })
}

/// The rows of a series.
pub struct Series {
    pub columns: Vec<String>,
    pub rows: Vec<Vec<f64>>,
}

impl Series {
    /// Reads a series that must be whole.
    pub fn read(out: &Path) -> Series {
        Series::read_table(&out.join("series.csv"))
    }

    /// Reads a table of a row a step that must be whole.
    pub fn read_table(path: &Path) -> Series {
        let text = fs::read_to_string(path).unwrap();
        assert!(text.is_empty() || text.ends_with('\n'), "half a row: {text:?}");
        let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let columns: Vec<String> = lines.next().unwrap_or_default().into_iter().map(str::to_owned).collect();
        let rows: Vec<Vec<f64>> = lines.map(|line| line.iter().map(|cell| number_in(cell)).collect()).collect();
        for (step, row) in rows.iter().enumerate() {
            assert_eq!((row.len(), row[0]), (columns.len(), step as f64), "row {step}");
        }
        Series { columns, rows }
    }

    /// The number in a row and a column.
    pub fn at(&self, row: usize, column: &str) -> f64 {
        self.rows[row][self.columns.iter().position(|name| name == column).unwrap()]
    }

    /// Largest difference to another series in the columns that are not left out; they have the same steps.
    pub fn difference(&self, other: &Series, without: &[&str]) -> (f64, String) {
        assert_eq!(self.columns, other.columns);
        assert_eq!(self.rows.len(), other.rows.len(), "steps");
        let column = |rows: &[Vec<f64>], place: usize| rows.iter().map(|row| row[place]).collect::<Vec<f64>>();
        let compared = self.columns.iter().enumerate().filter(|(_, name)| !without.contains(&name.as_str()));
        let differences = compared.map(|(place, name)| (difference(&column(&self.rows, place), &column(&other.rows, place)), name.clone()));
        differences.fold((0.0, String::new()), |worst, new| if new.0 > worst.0 || new.0.is_nan() { new } else { worst })
    }
}

/// The number in a cell; an empty one has none, which equals itself.
fn number_in(cell: &str) -> f64 {
    if cell.is_empty() { f64::INFINITY } else { cell.parse().unwrap() }
}

/// Files under a folder that are not whole.
pub fn halves(out: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(out) else { return Vec::new() };
    let paths = entries.map(|entry| entry.unwrap().path());
    paths
        .flat_map(|path| if path.is_dir() { halves(&path) } else { vec![path] })
        .filter(|path| path.extension().is_some_and(|ending| ending == "part"))
        .collect()
}
