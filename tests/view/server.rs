//! The page and its frames as a browser on this machine gets them.

use std::{
    io::{BufRead, BufReader, Read, Write},
    net::TcpStream,
    process::{Child, Stdio},
};

use super::{
    common::{command, folder, run, write},
    page::{bytes_of, element, index, page_of},
    scenes::DRY,
};

/// Ends with the test, also with one that fails.
struct Server(Child);

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The status line and the body of an answer.
fn ask(address: &str, path: &str, host: &str) -> (String, Vec<u8>) {
    let mut stream = TcpStream::connect(address).unwrap();
    write!(stream, "GET {path} HTTP/1.1\r\nHost: {host}\r\n\r\n").unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).unwrap();
    let end = answer.windows(4).position(|window| window == b"\r\n\r\n").unwrap();
    let head = String::from_utf8_lossy(&answer[..end]).into_owned();
    (head.lines().next().unwrap().to_owned(), answer[end + 4..].to_vec())
}

#[test]
fn a_server_gives_the_page_and_the_same_frames_to_this_machine_alone() {
    let here = folder("view-served");
    let out = here.join("out");
    run(1, &write(&here, DRY), &out, &["time.end=0.64"]);
    let page = page_of(&out, &[]);
    let mut server = command(1, &["view", out.to_str().unwrap(), "--serve", "0"]);
    let mut server = Server(server.stdout(Stdio::piped()).spawn().unwrap());
    let mut line = String::new();
    BufReader::new(server.0.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let address = line.split("http://").nth(1).and_then(|rest| rest.split('/').next()).unwrap_or_else(|| panic!("{line}"));
    assert!(line.starts_with("5 frames at http://127.0.0.1:"), "{line}");
    let (status, served) = ask(address, "/", address);
    let served = index(&String::from_utf8(served).unwrap());
    assert_eq!((status.as_str(), &served["frames"]["served"]), ("HTTP/1.1 200 OK", &true.into()));
    assert_eq!(served["frames"]["times"], index(&page)["frames"]["times"]);
    for number in [0, 3] {
        let (status, frame) = ask(address, &format!("/frame/{number}"), address);
        assert_eq!(status, "HTTP/1.1 200 OK");
        assert_eq!(frame, bytes_of(element(&page, &format!("frame-{number}")).unwrap()));
    }
    for (path, host) in
        [("/frame/5", address), ("/frame/-1", address), ("/../scene.toml", address), ("/", "elsewhere.example"), ("", address)]
    {
        assert_eq!(ask(address, path, host).0, "HTTP/1.1 404 Not Found", "{path} {host}");
    }
}
