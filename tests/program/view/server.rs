//! The page and its frames as a browser on this machine gets them.

use std::{
    io::{BufRead, BufReader, Read, Write},
    net::TcpStream,
    path::PathBuf,
    process::{Child, Command, Stdio},
    time::Duration,
};

use super::page::{bytes_of, element, index, page_of};
use crate::common::{command, folder, run, scenes::DRY, write};

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
    let (head, body) = ask_by("GET", address, path, host);
    (head.lines().next().unwrap().to_owned(), body)
}

/// The head and the body of the answer to a method.
fn ask_by(method: &str, address: &str, path: &str, host: &str) -> (String, Vec<u8>) {
    let mut stream = TcpStream::connect(address).unwrap();
    write!(stream, "{method} {path} HTTP/1.1\r\nHost: {host}\r\n\r\n").unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).unwrap();
    let end = answer.windows(4).position(|window| window == b"\r\n\r\n").unwrap();
    (String::from_utf8_lossy(&answer[..end]).into_owned(), answer[end + 4..].to_vec())
}

/// A server of the run of a scene that is made for it, the run's folder, and the address.
fn serve(name: &str) -> (Server, PathBuf, String) {
    let here = folder(name);
    let out = here.join("out");
    run(1, &write(&here, DRY), &out, &["time.end=0.64"]);
    let mut server = command(1, &["view", out.to_str().unwrap(), "--serve", "0"]);
    let mut server = Server(server.stdout(Stdio::piped()).spawn().unwrap());
    let mut line = String::new();
    BufReader::new(server.0.stdout.take().unwrap()).read_line(&mut line).unwrap();
    assert!(line.starts_with("5 frames at http://127.0.0.1:"), "{line}");
    let address = line.split("http://").nth(1).and_then(|rest| rest.split('/').next()).unwrap().to_owned();
    (server, out, address)
}

#[test]
fn a_server_gives_the_page_and_the_same_frames_to_this_machine_alone() {
    let (_server, out, address) = serve("view-served");
    let (page, address) = (page_of(&out, &[]), address.as_str());
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

#[test]
fn heads_and_addresses_with_questions_are_served_and_other_methods_are_not() {
    let (_server, _, address) = serve("view-methods");
    let address = address.as_str();
    let (head, page) = ask_by("GET", address, "/?a", address);
    assert!(head.starts_with("HTTP/1.1 200 OK") && page == ask(address, "/", address).1);
    assert_eq!(ask(address, "/frame/3?v=2", address), ask(address, "/frame/3", address));
    let (only, nothing) = ask_by("HEAD", address, "/", address);
    assert_eq!((only, nothing.len()), (head, 0));
    let (head, _) = ask_by("POST", address, "/", address);
    assert!(head.starts_with("HTTP/1.1 405 Method Not Allowed") && head.contains("\r\nAllow: GET, HEAD"), "{head}");
}

/// One byte at a time never keeps a request waiting for longer than it may take as a whole.
#[test]
fn a_request_that_never_ends_is_closed() {
    let (_server, _, address) = serve("view-dripping");
    let mut stream = TcpStream::connect(&address).unwrap();
    write!(stream, "GET / HTTP/1.1\r\nHost: {address}\r\nX: ").unwrap();
    // as many bytes as last ten times as long
    let refused = (0..400).any(|_| {
        std::thread::sleep(Duration::from_millis(50));
        stream.write_all(b"x").is_err()
    });
    assert!(refused);
    assert_eq!(ask(&address, "/frame/0", &address).0, "HTTP/1.1 200 OK");
}

/// A server whose memory has no room for the stacks of more threads tells browsers to come again, and serves them once there is room.
#[test]
fn browsers_are_told_to_come_again_where_no_thread_can_be_made() {
    let (server, _, address) = serve("view-threads");
    let id = server.0.id().to_string();
    let limit = |bytes: &str| {
        let set = Command::new("prlimit").args(["--pid", &id, &format!("--as={bytes}:")]).status();
        assert!(set.unwrap().success());
    };
    let status = std::fs::read_to_string(format!("/proc/{id}/status")).unwrap();
    let kilobytes: u64 =
        status.lines().find_map(|line| line.strip_prefix("VmSize:")).unwrap().trim().trim_end_matches(" kB").parse().unwrap();
    limit(&((kilobytes + 2048) * 1024).to_string());
    // idle ones, each with a thread, until there is room for no more
    let mut idle = Vec::new();
    let answer = (0..1000).find_map(|_| {
        let mut stream = TcpStream::connect(&address).unwrap();
        stream.set_read_timeout(Some(Duration::from_millis(100))).unwrap();
        let (mut answer, mut part) = (Vec::new(), [0; 256]);
        while let Ok(count @ 1..) = stream.read(&mut part) {
            answer.extend_from_slice(&part[..count]);
        }
        idle.push(stream);
        (!answer.is_empty()).then(|| String::from_utf8_lossy(&answer).into_owned())
    });
    assert!(answer.as_deref().is_some_and(|answer| answer.starts_with("HTTP/1.1 503 Service Unavailable")), "{answer:?}");
    limit("unlimited");
    drop(idle);
    assert_eq!(ask(&address, "/frame/0", &address).0, "HTTP/1.1 200 OK");
}
