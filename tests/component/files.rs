//! Lasting output: checkpoints and frames, alike on any number of ranks.

use std::{
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use nalgebra::{SMatrix, SVector};
use turbid::{
    body::{planes, skew},
    contact::Partner,
    error::Error,
    geometry::{Axis, Domain, LeesEdwards},
    grid::{Grid, operators::signed},
    observe::FrameBody,
    output::{Checkpoint, CheckpointWriter, Frame, FrameContact, FrameFields, Frames, read_frames},
    petsc::Session,
};

use crate::{
    Test,
    fields::{BOXES_2D, BOXES_3D, boxes_2d, boxes_3d, domain, grid, noise},
};

/// Longer than a reader takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_checkpoint_gives_back_what_it_was_given),
        Test::of(rows_are_stored_in_the_order_of_the_bodies_whoever_had_them),
        Test::of(a_lattice_is_stored_in_its_natural_order_whoever_wrote_it),
        Test::of(a_checkpoint_that_was_not_finished_is_absent),
        Test::of(checkpoints_that_cannot_be_used_are_refused),
        Test::of(no_changed_byte_changes_what_a_checkpoint_says),
        Test::of(a_checkpoint_for_another_grid_is_refused),
        Test::of(a_checkpoint_that_cannot_be_written_names_its_file),
        Test::of(frames_give_back_their_bodies),
        Test::of(frames_give_back_their_contacts),
        Test::of(frames_are_joined_as_vtkhdf_once_they_end),
        Test::of(fields_are_stored_slowest_axis_first_whoever_wrote_them),
        Test::of(a_resumed_run_forgets_later_frames_and_a_new_one_all),
        Test::of(frames_for_an_independent_reader),
    ]
}

fn a_checkpoint_gives_back_what_it_was_given(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>) {
        let (folder, grid) = (folder(session), grid(session, domain, 8));
        let path = folder.join("state.h5");
        let values = |field: usize| grid.block(field).indices().map(|index| noise(field, index)).collect::<Vec<_>>();
        let mut writer = CheckpointWriter::create(session.world(), &path).unwrap();
        writer.text("scene", "title = \"é\"\n").unwrap();
        writer.text("nothing", "").unwrap();
        writer.shared("numbers", &[1.5, -0.0, f64::MIN_POSITIVE, f64::NAN]).unwrap();
        writer.shared("none", &[]).unwrap();
        (0..=D).for_each(|field| writer.lattice(&format!("field {field}"), &grid, field, &values(field)).unwrap());
        assert!(!path.exists());
        writer.finish().unwrap();
        let read = Checkpoint::open(session.world(), &path).unwrap();
        assert_eq!(read.text("scene").unwrap(), "title = \"é\"\n");
        assert_eq!(read.text("nothing").unwrap(), "");
        let numbers = read.shared("numbers").unwrap();
        assert_eq!(numbers[..3], [1.5, -0.0, f64::MIN_POSITIVE]);
        assert!(numbers[1].is_sign_negative() && numbers[3].is_nan());
        assert!(read.shared("none").unwrap().is_empty());
        (0..=D).for_each(|field| assert_eq!(read.lattice(&format!("field {field}"), &grid, field).unwrap(), values(field)));
        assert!(read.shared("other").unwrap_err().to_string().contains("holds no other"));
    }
    boxes_2d().for_each(|domain| proof(session, &domain));
    boxes_3d().for_each(|domain| proof(session, &domain));
}

/// Reads with HDF5 alone, and compares with a function of the index: other numbers of ranks write and read the same.
fn a_lattice_is_stored_in_its_natural_order_whoever_wrote_it(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>) {
        let (folder, grid) = (folder(session), grid(session, domain, 8));
        let path = folder.join("state.h5");
        write_checkpoint(session, &grid, &path);
        let file = hdf5::File::open(&path).unwrap();
        for field in 0..=D {
            let stored = file.dataset(&format!("field {field}")).unwrap();
            let first = std::array::from_fn(|axis| usize::from(axis == field && !domain.periodic(axis)));
            let extents: Vec<usize> = (0..D).map(|axis| grid.cells()[axis] - first[axis]).collect();
            assert_eq!(stored.shape(), extents);
            let whole = turbid::grid::Block { start: first, end: grid.cells() };
            let expected: Vec<f64> = whole.indices().map(|index| noise(field, index)).collect();
            assert_eq!(stored.read_raw::<f64>().unwrap(), expected);
        }
    }
    boxes_2d().for_each(|domain| proof(session, &domain));
    boxes_3d().for_each(|domain| proof(session, &domain));
}

/// Reads with HDF5 alone, and what is not there is told from what is corrupt.
fn rows_are_stored_in_the_order_of_the_bodies_whoever_had_them(session: &Session) {
    let path = folder(session).join("state.h5");
    write_checkpoint(session, &grid(session, &domain(BOXES_2D[0]), 8), &path);
    let stored = hdf5::File::open(&path).unwrap().dataset("rows").unwrap().read_raw::<f64>().unwrap();
    assert_eq!(stored, (0..BODIES).flat_map(|body| [0.5 * body as f64, -1.0]).collect::<Vec<_>>());
    let read = Checkpoint::open(session.world(), &path).unwrap();
    assert_eq!(read.rows("rows", BODIES + 1, 2).unwrap(), None);
    assert!(read.rows("other", BODIES, 2).unwrap_err().to_string().contains("holds no other"));
    drop(read);
    // fewer bodies than ranks, and none
    for bodies in [0, 1] {
        let mut writer = CheckpointWriter::create(session.world(), &path).unwrap();
        let rows = own(session, &vec![[0.0, 4.0]; bodies], |_| 0).concat();
        writer.rows("rows", bodies, 1, rows).unwrap();
        writer.finish().unwrap();
        let rows = Checkpoint::open(session.world(), &path).unwrap().rows("rows", bodies, 1).unwrap().unwrap();
        assert_eq!(session.world().gather(&rows), vec![4.0; bodies]);
    }
}

fn a_checkpoint_that_was_not_finished_is_absent(session: &Session) {
    let path = folder(session).join("state.h5");
    let grid = grid(session, &domain(BOXES_2D[0]), 8);
    write_checkpoint(session, &grid, &path);
    let before = fs::read(&path).unwrap();
    session.world().barrier();
    let mut writer = CheckpointWriter::create(session.world(), &path).unwrap();
    writer.text("scene", "other").unwrap();
    drop(writer);
    session.world().barrier();
    assert_eq!(fs::read(&path).unwrap(), before);
    assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
}

fn checkpoints_that_cannot_be_used_are_refused(session: &Session) {
    let folder = folder(session);
    let grid = grid(session, &domain(BOXES_2D[1]), 8);
    let path = folder.join("state.h5");
    write_checkpoint(session, &grid, &path);
    let whole = fs::read(&path).unwrap();
    let refused = |name: &str, contents: Option<&[u8]>, what: &str| {
        let path = folder.join(name);
        on_first_rank(session, || {
            if let Some(contents) = contents {
                fs::write(&path, contents).unwrap();
            }
        });
        let Err(error) = Checkpoint::open(session.world(), &path) else { panic!("{name} was opened") };
        let text = error.to_string();
        assert!(matches!(error, Error::Refused(_)) && text.contains(name) && text.contains(what) && text.contains("resume from"), "{text}");
    };
    refused("missing.h5", None, "No such file");
    refused("empty.h5", Some(b""), "is empty");
    refused("text.h5", Some(b"a text of some length, longer than any signature"), "is no HDF5 file");
    refused("cut.h5", Some(&whole[..4]), "is no HDF5 file");
    for length in [8, 20, 48, 100, whole.len() / 2, whole.len() - 1] {
        refused("cut.h5", Some(&whole[..length]), "is truncated or corrupt");
    }
    on_first_rank(session, || {
        let file = hdf5::File::create(folder.join("foreign.h5")).unwrap();
        file.new_dataset::<f64>().shape(3).create("scene").unwrap();
    });
    refused("foreign.h5", None, "is no checkpoint of turbid");
    on_first_rank(session, || {
        let file = hdf5::File::open_rw(&path).unwrap();
        file.attr("version").unwrap().write_scalar(&7u32).unwrap();
    });
    refused("state.h5", None, "version 7 of the checkpoint format");
}

fn no_changed_byte_changes_what_a_checkpoint_says(session: &Session) {
    let folder = folder(session);
    let grid = grid(session, &domain(BOXES_2D[1]), 8);
    let path = folder.join("state.h5");
    write_checkpoint(session, &grid, &path);
    let whole = fs::read(&path).unwrap();
    let changed = folder.join("changed.h5");
    let mut found = 0;
    // a prime step meets all kinds of places
    for place in (0..whole.len()).step_by(37) {
        on_first_rank(session, || {
            let mut bytes = whole.clone();
            bytes[place] ^= 0x10;
            fs::write(&changed, bytes).unwrap();
        });
        match read_checkpoint(session, &grid, &changed) {
            Ok(values) => assert!(values == expected_checkpoint(&grid), "byte {place} went unnoticed"),
            Err(Error::Refused(_)) => found += 1,
            Err(error) => panic!("{error:?}"),
        }
    }
    assert!(found > 10);
}

fn a_checkpoint_for_another_grid_is_refused(session: &Session) {
    let path = folder(session).join("state.h5");
    let domain = domain(BOXES_2D[1]);
    write_checkpoint(session, &grid(session, &domain, 8), &path);
    let error = read_checkpoint(session, &grid(session, &domain, 10), &path).unwrap_err().to_string();
    assert!(error.contains("field 0 lies on a lattice of [8, 9] points, the scene needs [10, 11]"), "{error}");
}

fn a_checkpoint_that_cannot_be_written_names_its_file(session: &Session) {
    let path = folder(session).join("absent/state.h5");
    let Err(error) = CheckpointWriter::create(session.world(), &path) else { panic!("written into an absent folder") };
    assert!(error.to_string().contains("absent/state.h5") && error.exit_code() == 2, "{error}");
}

fn frames_give_back_their_bodies(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>) {
        let folder = folder(session);
        let mut frames = Frames::create(session.world(), &folder, true).unwrap();
        for step in 0..3 {
            // the first frame has no bodies
            let bodies = bodies(domain, step, 5 * step);
            write_frame(session, &mut frames, bare(0.1 * step as f64, step, domain, &bodies));
            let read = read_frames::<D>(&folder).unwrap();
            assert_eq!((read.len(), read[step].step, read[step].time), (step + 1, step, 0.1 * step as f64));
            assert_eq!(
                (read[step].size, read[step].offset),
                (domain.size, domain.slide().map(|_| domain.shift().rem_euclid(domain.size[0])))
            );
            let in_the_box = |body: FrameBody<D>| FrameBody {
                center: domain.wrap(body.center),
                velocity: body.velocity - domain.image_velocity(&body.center),
                ..body
            };
            let wrapped = bodies.into_iter().map(in_the_box);
            assert_eq!(read[step].bodies, wrapped.collect::<Vec<_>>());
            session.world().barrier();
        }
    }
    boxes_2d().for_each(|domain| proof(session, &domain));
    boxes_3d().for_each(|domain| proof(session, &domain));
    let sliding = |time| Domain { axes: [Axis::Periodic, Axis::Sheared(LeesEdwards::steady(0.3, -2.0, time))], ..domain(BOXES_2D[0]) };
    [0.0, 0.4, 1.7].into_iter().for_each(|time| proof(session, &sliding(time)));
    let folder = folder(session);
    let mut frames = Frames::create(session.world(), &folder, true).unwrap();
    write_frame(session, &mut frames, bare(0.0, 0, &domain(BOXES_2D[0]), &[]));
    let error = read_frames::<3>(&folder).unwrap_err().to_string();
    assert!(error.contains("000000.h5") && error.contains("2 dimensions, not 3"), "{error}");
}

fn frames_give_back_their_contacts(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>) {
        let folder = folder(session);
        let mut frames = Frames::create(session.world(), &folder, true).unwrap();
        let partners = [Partner::Body(4), Partner::Wall { axis: 1, upper: false }, Partner::Wall { axis: 0, upper: true }];
        let contact = |(place, partner): (usize, Partner), gluey: bool| FrameContact {
            body: place,
            partner,
            image: std::array::from_fn(|axis| place as i32 - axis as i32),
            point: SVector::from_fn(|axis, _| 0.1 + 0.05 * (place + axis) as f64),
            normal: SVector::from_fn(|axis, _| {
                if axis == 0 {
                    0.6
                } else if axis == 1 {
                    -0.8
                } else {
                    0.0
                }
            }),
            gap: 0.01 * place as f64,
            force: 1.5 - place as f64,
            gamma: gluey.then_some(-0.25 * place as f64),
            friction: (!gluey).then(|| SVector::from_fn(|axis, _| 0.125 * (place + 2 * axis) as f64)),
        };
        let bodies = bodies(domain, 0, 5);
        for (step, (count, gluey)) in [(0, true), (3, true), (2, false)].into_iter().enumerate() {
            let contacts: Vec<_> = partners.into_iter().enumerate().take(count).map(|partner| contact(partner, gluey)).collect();
            let time = step as f64;
            write_frame(session, &mut frames, Frame { contacts: Some(&contacts), ..bare(time, step, domain, &bodies) });
            assert_eq!(read_frames::<D>(&folder).unwrap()[step].contacts.as_ref(), Some(&contacts));
        }
        let listed = fs::read_to_string(folder.join("contacts.xdmf")).unwrap();
        assert_eq!((listed.matches("<Time").count(), listed.matches("contacts/gamma").count()), (2, 1), "{listed}");
        assert_eq!(listed.matches("contacts/friction").count(), 1, "{listed}");
        session.world().barrier();
        // without a law of contact there is nothing of it, and nothing of an earlier run is left
        let mut frames = Frames::create(session.world(), &folder, true).unwrap();
        write_frame(session, &mut frames, bare(0.0, 0, domain, &bodies));
        assert_eq!(read_frames::<D>(&folder).unwrap()[0].contacts, None);
        assert!(!folder.join("contacts.xdmf").exists());
        session.world().barrier();
    }
    boxes_2d().for_each(|domain| proof(session, &domain));
    boxes_3d().for_each(|domain| proof(session, &domain));
}

fn fields_are_stored_slowest_axis_first_whoever_wrote_them(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>) {
        let folder = folder(session);
        let grid = grid(session, domain, 8);
        let mut frames = Frames::create(session.world(), &folder, true).unwrap();
        write_frame(session, &mut frames, Frame { fields: Some(fields(&grid, 0.0)), ..bare(0.0, 0, domain, &[]) });
        let file = hdf5::File::open(folder.join("run.h5")).unwrap();
        let stored = file.dataset("frames/000000/fields/pressure").unwrap();
        let mut extents = [grid.cells().to_vec(), vec![1; 3 - D]].concat();
        extents.reverse();
        assert_eq!(stored.shape(), extents);
        let values = stored.read_raw::<f64>().unwrap();
        let velocity = file.dataset("frames/000000/fields/velocity").unwrap().read_raw::<f64>().unwrap();
        let vorticity = file.dataset("frames/000000/fields/vorticity").unwrap().read_raw::<f64>().unwrap();
        for index in grid.lattice(D).indices() {
            let place = (0..D).rev().fold(0, |place, axis| place * grid.cells()[axis] + index[axis]);
            let x = grid.position(D, signed(index));
            assert_eq!(values[place], field_at(D, &x, 0.0));
            let expected: Vec<f64> = (0..3).map(|axis| if axis < D { field_at(axis, &x, 0.0) } else { 0.0 }).collect();
            assert_eq!(velocity[3 * place..][..3], expected);
            let count = planes::<D>().len();
            let expected: Vec<f64> = (0..count).map(|component| field_at(D + 1 + component, &x, 0.0)).collect();
            assert_eq!(vorticity[count * place..][..count], expected);
        }
    }
    boxes_2d().for_each(|domain| proof(session, &domain));
    boxes_3d().for_each(|domain| proof(session, &domain));
}

fn a_resumed_run_forgets_later_frames_and_a_new_one_all(session: &Session) {
    let folder = folder(session);
    let domain = domain(BOXES_2D[0]);
    let write = |frames: &mut Frames, time: f64| {
        let bodies = bodies(&domain, 0, 2);
        write_frame(session, frames, bare(time, 0, &domain, &bodies));
    };
    let times = || {
        session.world().barrier();
        let times: Vec<f64> = read_frames::<2>(&folder).unwrap().iter().map(|frame| frame.time).collect();
        let listed = hdf5::File::open(folder.join("run.h5")).unwrap();
        assert_eq!(listed.dataset("times").unwrap().read_1d::<f64>().unwrap().to_vec(), times);
        assert_eq!(listed.group("frames").unwrap().len(), times.len() as u64);
        // readers take an empty list for a broken one
        let shown = fs::read_to_string(folder.join("bodies.xdmf")).ok().map(|text| text.matches("<Time").count());
        assert_eq!(shown, (!times.is_empty()).then_some(times.len()));
        assert!(!folder.join("contacts.xdmf").exists() && !folder.join("fields.xdmf").exists());
        drop(listed);
        session.world().barrier();
        times
    };
    let mut frames = Frames::create(session.world(), &folder, true).unwrap();
    assert!(times().is_empty());
    [0.0, 0.1, 0.2, 0.3].into_iter().for_each(|time| write(&mut frames, time));
    on_first_rank(session, || fs::write(folder.join("frames/000004.h5.part"), b"half").unwrap());
    let (mut frames, lost) = Frames::resume(session.world(), &folder, 0.1, true).unwrap();
    assert!(lost.is_empty(), "{lost:?}");
    assert_eq!(times(), [0.0, 0.1]);
    assert_eq!(fs::read_dir(folder.join("frames")).unwrap().count(), 2);
    session.world().barrier();
    write(&mut frames, 0.15);
    assert_eq!(times(), [0.0, 0.1, 0.15]);
    on_first_rank(session, || fs::write(folder.join("frames/000002.h5"), b"half").unwrap());
    let (mut frames, lost) = Frames::resume(session.world(), &folder, 1.0, true).unwrap();
    assert_eq!(lost.iter().any(|lost| lost.contains("000002.h5 cannot be read")), session.world().rank() == 0, "{lost:?}");
    assert_eq!(times(), [0.0, 0.1]);
    // its number is not given again
    write(&mut frames, 0.2);
    assert_eq!(times(), [0.0, 0.1, 0.2]);
    assert!(folder.join("frames/000003.h5").exists() && folder.join("frames/000002.h5.damaged").exists());
    // a new run removes them, as soon as its first rank comes to it
    session.world().barrier();
    Frames::create(session.world(), &folder, true).unwrap();
    assert!(times().is_empty());
}

fn frames_are_joined_as_vtkhdf_once_they_end(session: &Session) {
    let (folder, domain) = (folder(session), domain(BOXES_2D[0]));
    let grid = grid(session, &domain, 8);
    let write = |frames: &mut Frames, number: usize| {
        let (time, bodies) = (0.1 * number as f64, bodies(&domain, number, 3 + number / 2));
        write_frame(session, frames, Frame { fields: Some(fields(&grid, time)), ..bare(time, number, &domain, &bodies) });
    };
    let listed = || {
        session.world().barrier();
        let listed = joined(&folder);
        session.world().barrier();
        listed
    };
    let mut frames = Frames::create(session.world(), &folder, true).unwrap();
    (0..4).for_each(|number| write(&mut frames, number));
    assert_eq!(listed(), None);
    frames.finish(session.world()).unwrap();
    assert_eq!(listed(), Some(4));
    let mut frames = Frames::resume(session.world(), &folder, 0.1, true).unwrap().0;
    assert_eq!(listed(), Some(2));
    write(&mut frames, 2);
    assert_eq!(listed(), Some(2));
    frames.settle_local().unwrap();
    assert_eq!(listed(), Some(3));
    write(&mut frames, 3);
    frames.finish(session.world()).unwrap();
    assert_eq!(listed(), Some(4));
    Frames::resume(session.world(), &folder, 0.1, false).unwrap();
    assert_eq!(listed(), None);
}

/// Frames that the files of VTKHDF list, whose arrays are those of the frames one behind the other; nothing without the files.
fn joined(folder: &Path) -> Option<usize> {
    let open = |name: &str| hdf5::File::open(folder.join(name)).unwrap();
    if ["bodies.vtkhdf", "fields.vtkhdf"].iter().all(|name| !folder.join(name).exists()) {
        return None;
    }
    let (bodies, fields, run) = (open("bodies.vtkhdf"), open("fields.vtkhdf"), open("run.h5"));
    let numbers = |file: &hdf5::File, name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap();
    let counts = |name: &str| bodies.dataset(&format!("VTKHDF/{name}")).unwrap().read_raw::<usize>().unwrap();
    let times = numbers(&bodies, "VTKHDF/Steps/Values");
    assert_eq!(times, numbers(&fields, "VTKHDF/Steps/Values"));
    assert_eq!(times, numbers(&run, "times")[..times.len()]);
    let mut frames = run.group("frames").unwrap().member_names().unwrap();
    frames.sort();
    frames.truncate(times.len());
    let of_bodies = [("Points", "bodies/center"), ("PointData/rotation", "bodies/rotation"), ("PointData/contacts", "bodies/contacts")];
    let of_fields = [("CellData/velocity", "fields/velocity"), ("CellData/vorticity", "fields/vorticity")];
    for (file, name, source) in
        of_bodies.map(|(name, source)| (&bodies, name, source)).into_iter().chain(of_fields.map(|(name, source)| (&fields, name, source)))
    {
        let expected: Vec<f64> = frames.iter().flat_map(|frame| numbers(&run, &format!("frames/{frame}/{source}"))).collect();
        assert_eq!(numbers(file, &format!("VTKHDF/{name}")), expected, "{name}");
    }
    let (points, radii) =
        (counts("NumberOfPoints"), |frame: &String| run.dataset(&format!("frames/{frame}/bodies/radius")).unwrap().size());
    let listed: Vec<usize> = counts("Steps/PartOffsets").into_iter().map(|part| points[part]).collect();
    assert_eq!(listed, frames.iter().map(radii).collect::<Vec<_>>());
    Some(times.len())
}

/// Writes what `tests/long/independent_reader.rs` reads, step by step as it asks for, if it does.
fn frames_for_an_independent_reader(session: &Session) {
    fn write<const D: usize>(session: &Session, folder: &Path, domain: &Domain<D>) {
        let grid = grid(session, domain, 8);
        let mut frames = Frames::create(session.world(), folder, true).unwrap();
        for step in 0..3 {
            let (time, bodies) = (0.25 * step as f64, bodies(domain, step, 7));
            write_frame(session, &mut frames, Frame { fields: Some(fields(&grid, time)), ..bare(time, step, domain, &bodies) });
            let start = Instant::now();
            while !folder.join(format!("read-{step}")).exists() {
                assert!(start.elapsed() < PATIENCE, "nobody reads");
                std::thread::sleep(Duration::from_millis(5));
            }
        }
    }
    let Some(folder) = std::env::var_os("TURBID_INDEPENDENT_READER").map(PathBuf::from) else { return };
    write(session, &folder.join("2d"), &domain(BOXES_2D[1]));
    write(session, &folder.join("3d"), &domain(BOXES_3D[1]));
}

/// A field as a function of position and time, unlike along different axes.
fn field_at<const D: usize>(field: usize, x: &SVector<f64, D>, time: f64) -> f64 {
    (0..D).map(|axis| (axis + 1) as f64 * x[axis]).sum::<f64>() + 10.0 * field as f64 + time
}

fn fields<const D: usize>(grid: &Grid<D>, time: f64) -> FrameFields<'_, D> {
    let points: Vec<SVector<f64, D>> = grid.block(D).indices().map(|index| grid.position(D, signed(index))).collect();
    FrameFields {
        grid,
        velocity: points.iter().map(|x| SVector::from_fn(|axis, _| field_at(axis, x, time))).collect(),
        pressure: points.iter().map(|x| field_at(D, x, time)).collect(),
        inside: points.iter().map(|x| f64::from(u8::from(x[0] < x[1]))).collect(),
        vorticity: Some(
            points.iter().flat_map(|x| (0..planes::<D>().len()).map(|component| field_at(D + 1 + component, x, time))).collect(),
        ),
    }
}

/// What this rank hands in: what belongs to bodies that it holds, which follow each other on no rank.
fn own<T: Clone>(session: &Session, all: &[T], body: impl Fn(&T) -> usize) -> Vec<T> {
    let world = session.world();
    all.iter().filter(|entry| (body(entry) + 1) % world.size() == world.rank()).cloned().collect()
}

/// A frame of bodies alone.
fn bare<'a, const D: usize>(time: f64, step: usize, domain: &'a Domain<D>, bodies: &'a [FrameBody<D>]) -> Frame<'a, D> {
    Frame { time, step, domain, bodies, contacts: None, bonds: None, membranes: None, fields: None }
}

/// Writes a frame of which each rank hands in its share.
fn write_frame<const D: usize>(session: &Session, frames: &mut Frames, frame: Frame<D>) {
    let bodies = own(session, frame.bodies, |body| body.number);
    let contacts = frame.contacts.map(|contacts| own(session, contacts, |contact| contact.body));
    frames.write(session.world(), &Frame { bodies: &bodies, contacts: contacts.as_deref(), ..frame }).unwrap();
}

/// Bodies whose numbers are simple functions of their place in the list; centres leave the box along periodic axes.
fn bodies<const D: usize>(domain: &Domain<D>, step: usize, count: usize) -> Vec<FrameBody<D>> {
    let body = |body: usize| {
        let number = body as f64 + 0.125 * step as f64;
        let turn = |scale: f64| skew(&[number * scale, number + scale, scale][..D * (D - 1) / 2]);
        FrameBody {
            number: body,
            center: SVector::from_fn(|axis, _| if domain.periodic(axis) { 0.3 * number } else { 0.1 * number } + 0.01 * axis as f64),
            radius: 0.1 + 0.01 * body as f64,
            velocity: SVector::from_fn(|axis, _| number + 100.0 * axis as f64),
            spin: turn(2.0),
            rotation: SMatrix::from_fn(|row, column| number + 10.0 * row as f64 + column as f64),
            force: SVector::from_fn(|axis, _| -number - 100.0 * axis as f64),
            torque: turn(-3.0),
            contacts: body % 4,
        }
    };
    (0..count).map(body).collect()
}

fn write_checkpoint<const D: usize>(session: &Session, grid: &Grid<D>, path: &Path) {
    let mut writer = CheckpointWriter::create(session.world(), path).unwrap();
    writer.text("scene", "title = \"one\"").unwrap();
    writer.shared("numbers", &[1.0, 2.0, 3.0]).unwrap();
    let rows = (0..BODIES).map(|body| [body as f64, 0.5 * body as f64, -1.0]).collect::<Vec<_>>();
    writer.rows("rows", BODIES, 2, own(session, &rows, |row| row[0] as usize).concat()).unwrap();
    for (field, values) in expected_checkpoint(grid).2.iter().enumerate() {
        writer.lattice(&format!("field {field}"), grid, field, values).unwrap();
    }
    writer.finish().unwrap();
}

/// Bodies of a checkpoint, some ranks having one more than others.
const BODIES: usize = 7;

type Contents = (String, Vec<f64>, Vec<Vec<f64>>);

fn expected_checkpoint<const D: usize>(grid: &Grid<D>) -> Contents {
    let values = |field| grid.block(field).indices().map(|index| noise(field, index)).collect();
    ("title = \"one\"".into(), vec![1.0, 2.0, 3.0], (0..=D).map(values).collect())
}

fn read_checkpoint<const D: usize>(session: &Session, grid: &Grid<D>, path: &Path) -> Result<Contents, Error> {
    let read = Checkpoint::open(session.world(), path)?;
    let fields = (0..=D).map(|field| read.lattice(&format!("field {field}"), grid, field)).collect::<Result<_, _>>()?;
    let rows = read.rows("rows", BODIES, 2)?.ok_or_else(|| Error::refused("other rows"))?;
    let expected: Vec<f64> = session.world().share(BODIES).flat_map(|body| [0.5 * body as f64, -1.0]).collect();
    assert_eq!(rows, expected);
    Ok((read.text("scene")?, read.shared("numbers")?, fields))
}

fn on_first_rank(session: &Session, act: impl FnOnce()) {
    session.world().barrier();
    if session.world().rank() == 0 {
        act();
    }
    session.world().barrier();
}

/// An empty folder, the same on all ranks.
fn folder(session: &Session) -> PathBuf {
    let own = std::env::temp_dir().join(format!("turbid-lasting-{}", std::process::id()));
    let path = PathBuf::from(session.world().broadcast(0, &own.to_string_lossy()));
    on_first_rank(session, || {
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
    });
    path
}
