//! Pages as Chromium shows them; passed over, with a word, where it is not installed.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
    sync::Mutex,
};

use turbid::{
    observe::FrameBody,
    output::{StoredFrame, read_frames},
};

use super::page::page_of;
use crate::common::{
    folder, run,
    scenes::{CHAINS, SLIDING, SPHERES},
    write,
};

const SIZE: [usize; 2] = [1000, 760];
/// Colours of bodies that are coloured by nothing, and of the first two chains.
const PLAIN: [u8; 3] = [96, 108, 128];
const CHAIN: [[u8; 3]; 2] = [[230, 159, 0], [86, 180, 233]];
/// The point in the middle of the scene, and pixels per length in parts of its height: boxes of eight lengths are seen, with the colour bars beside.
const VIEW: [f64; 3] = [4.5, 3.8, 0.1];
/// One browser at a time.
static BROWSER: Mutex<()> = Mutex::new(());

fn chromium() -> Option<&'static str> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let found = names.into_iter().find(|name| Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success()));
    if found.is_none() {
        eprintln!("SKIPPED: no Chromium is installed (apt-get install chromium), and the viewer's page was not looked at");
    }
    found
}

/// What was seen of a page.
struct Rendering {
    pixels: Vec<[u8; 3]>,
    document: String,
}

/// Shows a page in a state that its address names; no error may come up.
fn render(program: &str, page: &Path, state: &str) -> Rendering {
    let _one = BROWSER.lock().unwrap_or_else(|broken| broken.into_inner());
    let here = page.parent().unwrap();
    let picture = here.join("seen.png");
    let _ = fs::remove_file(&picture);
    let flags =
        ["--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-first-run"];
    let output = Command::new(program)
        .args(flags)
        .args(["--hide-scrollbars", "--enable-logging=stderr", "--virtual-time-budget=8000", "--force-device-scale-factor=1", "--dump-dom"])
        .arg(format!("--window-size={},{}", SIZE[0], SIZE[1]))
        .arg(format!("--user-data-dir={}", here.join("browser").display()))
        .arg(format!("--screenshot={}", picture.display()))
        .arg(format!("file://{}#{state}", page.display()))
        .output()
        .unwrap();
    let (document, log) = (String::from_utf8_lossy(&output.stdout).into_owned(), String::from_utf8_lossy(&output.stderr).into_owned());
    let errors: Vec<&str> = log.lines().filter(|line| line.contains("CONSOLE") || line.contains("Uncaught")).collect();
    assert!(errors.is_empty(), "{state}: {errors:?}");
    let rendering = Rendering { pixels: pixels(&picture), document };
    assert_eq!(rendering.fact("state"), "ready", "{state}: {log}");
    rendering
}

fn pixels(path: &Path) -> Vec<[u8; 3]> {
    let mut reader = png::Decoder::new(std::io::BufReader::new(fs::File::open(path).unwrap())).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!([info.width as usize, info.height as usize], SIZE);
    bytes[..info.buffer_size()].chunks(info.color_type.samples()).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
}

impl Rendering {
    /// What the page says of itself.
    fn fact(&self, name: &str) -> &str {
        let start =
            self.document.find(&format!("data-{name}=\"")).map(|start| start + name.len() + 7).unwrap_or_else(|| panic!("no {name}"));
        self.document[start..].split('"').next().unwrap()
    }

    /// The colour at a point of the box, as seen in [`VIEW`].
    fn at(&self, point: [f64; 2]) -> [u8; 3] {
        let insets: Vec<f64> = self.fact("insets").split(',').map(|inset| inset.parse().unwrap()).collect();
        let stage = [0, 1].map(|axis| SIZE[axis] as f64 - insets[axis] - insets[axis + 2]);
        let away = [point[0] - VIEW[0], VIEW[1] - point[1]].map(|away| away * VIEW[2] * stage[1]);
        let [x, y] = [0, 1].map(|axis| (insets[axis] + 0.5 * stage[axis] + away[axis]) as usize);
        self.pixels[y * SIZE[0] + x]
    }

    /// Pixels in the left part of the page, where the scene is.
    fn scene(&self) -> impl Iterator<Item = [u8; 3]> {
        let rows = self.pixels.chunks(SIZE[0]).skip(50).take(SIZE[1] - 120);
        rows.flat_map(|row| row[..560].iter().copied())
    }

    fn coloured(&self) -> usize {
        self.scene().filter(|pixel| pixel.iter().max().unwrap() - pixel.iter().min().unwrap() > 25).count()
    }

    fn colours(&self) -> usize {
        let mut colours: Vec<[u8; 3]> = self.scene().collect();
        colours.sort_unstable();
        colours.dedup();
        colours.len()
    }

    fn difference(&self, other: &Rendering) -> usize {
        self.scene().zip(other.scene()).filter(|(one, other)| one != other).count()
    }
}

/// The page of a scene that is run here.
fn shown(name: &str, scene: &str, settings: &[&str]) -> (PathBuf, PathBuf) {
    let here = folder(name);
    let out = here.join("out");
    run(1, &write(&here, scene), &out, settings);
    page_of(&out, &[]);
    let page = out.join("view.html");
    (out, page)
}

fn view() -> String {
    format!("view={},{},{}", VIEW[0], VIEW[1], VIEW[2])
}

fn last<const D: usize>(out: &Path) -> (usize, StoredFrame<D>) {
    let frames = read_frames::<D>(out).unwrap();
    (frames.len() - 1, frames.last().unwrap().clone())
}

#[test]
fn disks_of_a_sheared_run_are_where_the_frame_has_them() {
    let Some(chromium) = chromium() else { return };
    let (out, page) = shown("view-browser-sheared", SLIDING, &["time.end=0.25"]);
    let (number, frame) = last::<2>(&out);
    let size = [frame.size.x, frame.size.y];
    let rendering = render(chromium, &page, &format!("frame={number}&colour=plain&marks=0&{}", view()));
    assert_eq!((rendering.fact("frame"), rendering.fact("bodies")), (number.to_string().as_str(), frame.bodies.len().to_string().as_str()));
    // the edges of the box are drawn over the bodies
    let off_edges = |body: &&FrameBody<2>| (0..2).all(|axis| (0.1..size[axis] - 0.1).contains(&body.center[axis]));
    for body in frame.bodies.iter().filter(off_edges) {
        assert_eq!(rendering.at(body.center.into()), PLAIN, "at {}", body.center);
    }
    // between all images of the disks it is white
    let free = |x: f64, y: f64| {
        let rows = [-1.0, 0.0, 1.0];
        let away = |body: &FrameBody<2>, i: f64, j: f64| {
            let image = [body.center.x + i * size[0] + j * frame.offset.unwrap(), body.center.y + j * size[1]];
            (x - image[0]).hypot(y - image[1]) > 1.15 * body.radius
        };
        frame.bodies.iter().all(|body| rows.iter().all(|&j| [-2.0, -1.0, 0.0, 1.0].iter().all(|&i| away(body, i, j))))
    };
    let places = (1..40).flat_map(|i| (1..40).map(move |j| [f64::from(i), f64::from(j)].map(|place| 0.2 * place)));
    let gaps: Vec<[f64; 2]> = places.filter(|[x, y]| free(*x, *y)).collect();
    assert!(gaps.len() > 20, "{}", gaps.len());
    for gap in gaps {
        assert_eq!(rendering.at(gap), [255; 3], "at {gap:?}");
    }
    let start = render(chromium, &page, &format!("frame=0&colour=plain&marks=0&{}", view()));
    assert!(rendering.difference(&start) > 3000, "{}", rendering.difference(&start));
    let by_speed = render(chromium, &page, &format!("frame={number}&colour=speed&flow=vorticity&streams=1&images=around"));
    assert!(by_speed.coloured() > 2 * rendering.coloured().max(1000), "{} {}", by_speed.coloured(), rendering.coloured());
    // it goes round and round, and a busy machine may draw nothing for a while: one look may find it at its start, not all of them
    let mut speeds = [1, 2, 5, 10, 15, 25].into_iter().cycle().take(24);
    let goes_on = |speed| render(chromium, &page, &format!("frame=0&play=1&speed={speed}")).fact("frame") != "0";
    assert!(speeds.any(goes_on), "it plays");
}

#[test]
fn chains_have_their_colours_and_a_body_its_history() {
    let Some(chromium) = chromium() else { return };
    let (out, page) = shown("view-browser-chains", CHAINS, &["time.end=0.16"]);
    let (number, frame) = last::<2>(&out);
    let rendering = render(chromium, &page, &format!("frame={number}&bonds=0&marks=0&{}", view()));
    for body in &frame.bodies {
        assert_eq!(rendering.at(body.center.into()), CHAIN[usize::from(body.number >= 4)], "body {}", body.number);
    }
    let followed = render(chromium, &page, &format!("frame={number}&body=2"));
    assert!(followed.document.contains(">Body 2<") && followed.document.contains("the path is drawn"), "the card of the body");
}

#[test]
fn spheres_are_shaded_turned_and_cut() {
    let Some(chromium) = chromium() else { return };
    let (_, page) = shown("view-browser-spheres", SPHERES, &["time.end=0.01", "output.every=0.01"]);
    let rendering = render(chromium, &page, "frame=1");
    assert!(rendering.coloured() > 10_000 && rendering.colours() > 300, "{} {}", rendering.coloured(), rendering.colours());
    let [turned, cut] = ["view=2,2,2,1.5,0.2,9", "clip=z:0.4&flow=speed"].map(|state| render(chromium, &page, &format!("frame=1&{state}")));
    assert!(rendering.difference(&turned) > 10_000 && rendering.difference(&cut) > 10_000);
}
