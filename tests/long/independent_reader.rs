//! Frames as others read them: h5py and VTK, while the run that writes them goes on.

use std::{
    fs,
    io::{BufRead, BufReader, Write},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

use crate::common::{self, scenes};

const FRAMES: usize = 3;

/// Longer than any step takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);

#[test]
fn h5py_and_vtk_read_frames_while_more_are_written() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("independent-reader");
    let _ = fs::remove_dir_all(&folder);
    let mut writer = Writer(start_writer(&folder));
    for dimension in [2, 3] {
        let folder = folder.join(format!("{dimension}d"));
        for step in 0..FRAMES {
            wait_until(&mut writer.0, || listed(&folder) > step);
            let mut reader = start_reader(&folder, dimension, step + 1);
            let mut said = BufReader::new(reader.stdout.take().unwrap()).lines();
            assert_eq!(said.next().map(Result::unwrap).as_deref(), Some("checked"), "see the reader's message above");
            fs::write(folder.join(format!("read-{step}")), "").unwrap();
            if step + 1 < FRAMES {
                wait_until(&mut writer.0, || listed(&folder) > step + 1);
            }
            writeln!(reader.stdin.take().unwrap(), "go on").unwrap();
            assert_eq!(said.next().map(Result::unwrap).as_deref(), Some("checked again"), "see the reader's message above");
            assert!(reader.wait().unwrap().success());
        }
    }
    assert!(writer.0.wait().unwrap().success());
}

#[test]
fn h5py_reads_runs_of_the_program_under_way_and_finished() {
    let bonded = [("chains", scenes::CHAINS), ("clusters", scenes::CLUSTERS), ("cells", scenes::CELLS)];
    let others = [("flow", scenes::SHEARED), ("dry", scenes::DRY), ("gluey", scenes::GLUEY), ("sliding", scenes::SLIDING)];
    // of disks of three cells a radius the cells inside fill their area to a twentieth by chance only
    let (finer, as_given): (&[&str], &[&str]) = (&["--set", "resolution.cells_per_radius=4"], &[]);
    for ((name, text), resolution) in others.map(|scene| (scene, as_given)).into_iter().chain(bonded.map(|scene| (scene, finer))) {
        let here = common::folder(&format!("independent-reader-{name}"));
        let (scene, out) = (common::write(&here, text), here.join("out"));
        let mut command = common::command(2, &["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        let mut running = Writer(
            command
                .args(["--set", "output.every=0.02", "--set", "output.pairs=true"])
                .args(resolution)
                .stdout(Stdio::null())
                .spawn()
                .unwrap(),
        );
        let frames = || fs::read_to_string(out.join("bodies.xdmf")).map_or(0, |text| text.matches("<Time").count());
        wait_until(&mut running.0, || frames() >= 2);
        reads_run(&out);
        assert!(running.0.wait().unwrap().success());
        reads_run(&out);
    }
}

#[test]
fn vtk_reads_the_frame_of_an_instant() {
    let here = common::folder("independent-reader-instant");
    let (scene, out) = (common::write(&here, scenes::SPHERE), here.join("out"));
    common::run(1, &scene, &out, &[]);
    for (reader, file) in [("vtkXdmfReader", "fields.xdmf"), ("vtkHDFReader", "fields.vtkhdf")] {
        let read = "import sys, vtk\nr = getattr(vtk, sys.argv[1])()\nr.SetFileName(sys.argv[2])\nr.Update()\n\
                    d = r.GetOutputDataObject(0)\nwhile d.IsA('vtkMultiBlockDataSet'): d = d.GetBlock(0)\n\
                    assert d.GetNumberOfCells() == 4096, d\nassert d.GetCellData().GetArray('velocity').GetNumberOfComponents() == 3\n\
                    assert d.GetBounds() == (0, 1, 0, 1, 0, 1), d\n";
        let mut python = Command::new(common::root().join("target/python/bin/python"));
        let python = python.args(["-c", read, reader]).arg(out.join(file)).output().unwrap();
        assert!(python.status.success(), "{reader}: {}", String::from_utf8_lossy(&python.stderr));
    }
}

fn reads_run(out: &Path) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let reader =
        Command::new(root.join("target/python/bin/python")).arg(root.join("tests/long/independent_reader.py")).arg(out).arg("run").output();
    let reader = reader.unwrap();
    assert!(reader.status.success(), "{}", String::from_utf8_lossy(&reader.stderr));
}

/// Ends with the test, also with one that fails.
struct Writer(Child);

impl Drop for Writer {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Number of frames that the run's companion lists.
fn listed(folder: &Path) -> usize {
    fs::read_to_string(folder.join("fields.xdmf")).map_or(0, |text| text.matches("<Time").count())
}

fn wait_until(writer: &mut Child, ready: impl Fn() -> bool) {
    let start = Instant::now();
    while !ready() {
        assert!(writer.try_wait().unwrap().is_none(), "the writer has ended");
        assert!(start.elapsed() < PATIENCE, "the writer does not go on");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// The component test that writes frames, on two ranks.
fn start_writer(folder: &Path) -> Child {
    let mut command = Command::new("mpirun");
    command.args(["--oversubscribe", "-n", "2"]).arg(component_tests()).arg("frames_for_an_independent_reader");
    command.envs([("OMPI_ALLOW_RUN_AS_ROOT", "1"), ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"), ("OMP_NUM_THREADS", "1")]);
    command.env("TURBID_INDEPENDENT_READER", folder).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

/// The newest build of the component tests, which lies beside this one.
fn component_tests() -> PathBuf {
    let own = std::env::current_exe().unwrap();
    let files = fs::read_dir(own.parent().unwrap()).unwrap().map(|entry| entry.unwrap().path());
    let built = files.filter(|path| path.extension().is_none() && path.file_name().unwrap().to_string_lossy().starts_with("component-"));
    let newest = built.max_by_key(|path| fs::metadata(path).unwrap().modified().unwrap());
    newest.expect("the component tests are not built: cargo test --no-run --test component")
}

fn start_reader(folder: &Path, dimension: usize, frames: usize) -> Child {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let python = root.join("target/python/bin/python");
    assert!(python.exists(), "{} is missing: execute ./run setup, which makes it", python.display());
    let mut command = Command::new(python);
    command.arg(root.join("tests/long/independent_reader.py")).arg(folder).args([dimension.to_string(), frames.to_string()]);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap()
}
