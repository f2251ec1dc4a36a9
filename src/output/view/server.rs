//! A server of the page to browsers on this machine, which reads frames when they are asked for.

use std::{
    io::{self, BufRead, BufReader, Read, Write},
    net::{Ipv4Addr, TcpListener, TcpStream},
    path::Path,
    sync::mpsc::{self, Receiver},
    thread,
    time::Duration,
};

use super::{RunView, chunk::Chunk};
use crate::{
    error::{Error, Result},
    output::say,
};

/// Longest request, and how long a browser may take over it.
const LONGEST: u64 = 1 << 14;
const PATIENCE: Duration = Duration::from_secs(2);

/// The type and the bytes of what was asked for.
type Response = (&'static str, Vec<u8>);

/// Serves the run in a folder on a port of 127.0.0.1 until the program is stopped; port 0 is any that is free. A page that is loaded again shows the frames that
/// have come since.
///
/// # Errors
/// [`Error::Refused`] when the port is taken, or as [`RunView::open`].
pub fn serve(folder: &Path, port: u16) -> Result<()> {
    let mut view = RunView::open(folder)?;
    let mut first = view.chunk(0)?;
    let refuse = |error| Error::refused(format!("--serve {port}: cannot be listened to ({error}); choose another port"));
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(refuse)?;
    let address = listener.local_addr().map_err(refuse)?;
    say(&format!("{} frames at http://{address}/ (Ctrl-C ends)", view.count()))?;
    for (stream, path) in requests(listener) {
        // a browser that has gone away wants no answer
        let _ = answer(stream, path.map(|path| respond(&path, folder, &mut view, &mut first)));
    }
    Ok(())
}

/// What browsers ask for, as it comes; nothing where they are not to be answered. Each is read on a thread of its own: they open connections before they need them.
fn requests(listener: TcpListener) -> Receiver<(TcpStream, Option<String>)> {
    let (sender, receiver) = mpsc::channel();
    thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            let sender = sender.clone();
            thread::spawn(move || read(&stream).map(|path| sender.send((stream, path))));
        }
    });
    receiver
}

/// The path that a request asks for, if it comes from a page of this machine.
fn read(stream: &TcpStream) -> io::Result<Option<String>> {
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let mut lines = BufReader::new(Read::take(stream, LONGEST)).lines();
    let request = lines.next().transpose()?.ok_or(io::ErrorKind::UnexpectedEof)?;
    let mut known = false;
    while let Some(line) = lines.next().transpose()?.filter(|line| !line.is_empty()) {
        known |= line.split_once(':').is_some_and(|(name, host)| name.eq_ignore_ascii_case("host") && is_here(host.trim()));
    }
    let path = request.strip_prefix("GET ").and_then(|rest| rest.split(' ').next()).filter(|_| known);
    Ok(path.map(str::to_owned))
}

fn answer(mut stream: TcpStream, response: Option<Result<Option<Response>>>) -> io::Result<()> {
    let (status, kind, body) = match response {
        Some(Ok(Some((kind, body)))) => ("200 OK", kind, body),
        Some(Err(error)) => ("500 Internal Server Error", "text/plain", error.to_string().into_bytes()),
        _ => ("404 Not Found", "text/plain", b"not found".to_vec()),
    };
    write!(stream, "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\n", body.len())?;
    write!(stream, "Cache-Control: no-store\r\nConnection: close\r\n\r\n")?;
    stream.write_all(&body)
}

/// Whether a host, with or without a port, is this machine: a page of another site whose name leads here has no business with the run.
fn is_here(host: &str) -> bool {
    let name = host.split_once(':').map_or(host, |(name, _)| name);
    name == "localhost" || name == "127.0.0.1"
}

fn respond(path: &str, folder: &Path, view: &mut RunView, first: &mut Chunk) -> Result<Option<Response>> {
    if path == "/" {
        *view = RunView::open(folder)?;
        *first = view.chunk(0)?;
        return Ok(Some(("text/html; charset=utf-8", view.served_page()?)));
    }
    let number = path.strip_prefix("/frame/").and_then(|number| number.parse::<usize>().ok()).filter(|number| *number < view.count());
    let packed = |number| Ok(("application/octet-stream", view.chunk(number)?.packed((number > 0).then_some(&*first))));
    number.map(packed).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_this_machine_is_answered() {
        assert!(["localhost", "localhost:8765", "127.0.0.1:80"].iter().all(|host| is_here(host)));
        assert!(!["evil.example", "evil.example:8765", "", "127.0.0.1.evil.example"].iter().any(|host| is_here(host)));
    }
}
