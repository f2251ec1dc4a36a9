//! Folders of which no page can be made.

use std::fs;

use super::page::{index, page_of};
use crate::common::{folder, run, said, scenes::DRY, turbid, write};

fn refused(arguments: &[&str], words: &[&str]) {
    let output = turbid(1, arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", said(&output));
    words.iter().for_each(|word| assert!(said(&output).contains(word), "{word} is missing in {}", said(&output)));
}

#[test]
fn a_folder_without_frames_is_refused() {
    let here = folder("view-refused");
    let path = here.to_str().unwrap();
    refused(&["view", here.join("nowhere").to_str().unwrap()], &["nowhere: no such folder; name the output folder of a run"]);
    refused(&["view", path], &[path, "holds no scene.toml; name the output folder of a run"]);
    write(&here, DRY);
    refused(&["view", path], &[path]);
    fs::create_dir(here.join("frames")).unwrap();
    refused(&["view", path], &["holds no frames", "[time]"]);
    refused(&["view", path, "--serve", "0"], &["holds no frames"]);
    refused(&["view", path, "--out", "page.png"], &["page.html"]);
    assert!(!here.join("view.html").exists());
}

#[test]
fn a_damaged_frame_is_refused_and_a_run_that_has_not_ended_is_shown() {
    let here = folder("view-damaged");
    let out = here.join("out");
    run(1, &write(&here, DRY), &out, &["time.end=0.64"]);
    fs::remove_file(out.join("summary.json")).unwrap();
    assert_eq!(index(&page_of(&out, &[]))["finished"], false);
    let (frame, page) = (out.join("frames/000002.h5"), out.join("view.html"));
    let whole = fs::read(&frame).unwrap();
    fs::remove_file(&page).unwrap();
    fs::write(&frame, &whole[..whole.len() / 3]).unwrap();
    refused(&["view", out.to_str().unwrap()], &["frames/000002.h5", "cannot be read", "move it out of the folder"]);
    assert!(!page.exists() && !out.join("view.html.part").exists());
    fs::write(&frame, &whole).unwrap();
    let file = hdf5::File::open_rw(&frame).unwrap();
    let center = file.dataset("bodies/center").unwrap();
    let mut numbers = center.read_raw::<f64>().unwrap();
    numbers[0] = f64::NAN;
    center.write_raw(&numbers).unwrap();
    drop((center, file));
    refused(&["view", out.to_str().unwrap()], &["000002.h5", "bodies/center differs from its checksum"]);
    assert!(!page.exists());
}
