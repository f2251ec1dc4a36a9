//! A server of the page to browsers on this machine, which reads frames when they are asked for.

use std::{
    io::{self, BufRead, BufReader, Read, Write},
    net::{Ipv4Addr, TcpListener, TcpStream},
    path::Path,
    sync::{
        Arc,
        mpsc::{self, Receiver},
    },
    thread,
    time::{Duration, Instant},
};

use super::{RunView, chunk::Chunk};
use crate::{
    error::{Error, Result},
    output::say,
};

/// Longest request, how long a browser may take over the whole of it, and how long over the answer.
const LONGEST: u64 = 1 << 14;
const PATIENCE: Duration = Duration::from_secs(2);
const ANSWERED: Duration = Duration::from_secs(20);

/// How long to wait where no connection can be taken.
const PAUSE: Duration = Duration::from_millis(50);

/// Bytes that a thread needs to read a request.
const STACK: usize = 1 << 18;

/// The type and the bytes of what was asked for.
type Response = (&'static str, Vec<u8>);

/// What a browser asks for.
enum Request {
    /// What is at a path.
    Path {
        /// The path.
        path: String,
        /// Whether only the head of the answer is wanted.
        head: bool,
    },
    /// Something else than to get it.
    Other,
    /// Anything, from a page that has no business here.
    Foreign,
}

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
    for (stream, request) in requests(listener) {
        // a browser that has gone away wants no answer
        let _ = match request {
            Request::Path { path, head } => match respond(&path, folder, &mut view, &mut first) {
                Ok(Some(found)) => answer(&stream, "200 OK", found, head),
                Ok(None) => answer(&stream, "404 Not Found", text("not found"), head),
                Err(error) => answer(&stream, "500 Internal Server Error", text(&error.to_string()), head),
            },
            Request::Other => answer(&stream, "405 Method Not Allowed\r\nAllow: GET, HEAD", text("only GET and HEAD"), false),
            Request::Foreign => answer(&stream, "404 Not Found", text("not found"), false),
        };
    }
    Ok(())
}

/// What browsers ask for, as it comes. Each is read on a thread of its own: they open connections before they need them. Where no thread can be made, they are
/// told to come again.
fn requests(listener: TcpListener) -> Receiver<(Arc<TcpStream>, Request)> {
    let (sender, receiver) = mpsc::channel();
    thread::spawn(move || {
        for stream in listener.incoming() {
            let Ok(stream) = stream.map(Arc::new) else {
                // too many are open
                thread::sleep(PAUSE);
                continue;
            };
            let (sender, own) = (sender.clone(), Arc::clone(&stream));
            let read = move || read(&own).map(|request| sender.send((own, request)));
            if thread::Builder::new().stack_size(STACK).spawn(read).is_err() {
                let _ = refuse(&stream);
            }
        }
    });
    receiver
}

/// Tells a browser to come again.
fn refuse(stream: &TcpStream) -> io::Result<()> {
    answer(stream, "503 Service Unavailable\r\nRetry-After: 1", text("too many connections"), false)?;
    // what has come unread would cut the answer off
    stream.set_nonblocking(true)?;
    let mut stream = stream;
    stream.read(&mut [0; LONGEST as usize]).map(|_| ())
}

/// What a request asks for, if all of it comes in time.
fn read(stream: &TcpStream) -> io::Result<Request> {
    let mut lines = BufReader::new(Read::take(Within::new(stream, PATIENCE), LONGEST)).lines();
    let request = lines.next().transpose()?.ok_or(io::ErrorKind::UnexpectedEof)?;
    let mut known = false;
    while let Some(line) = lines.next().transpose()?.filter(|line| !line.is_empty()) {
        known |= line.split_once(':').is_some_and(|(name, host)| name.eq_ignore_ascii_case("host") && is_here(host.trim()));
    }
    Ok(if known { Request::of(&request) } else { Request::Foreign })
}

impl Request {
    /// Of its first line; what follows a question mark is not looked at.
    fn of(line: &str) -> Request {
        let mut words = line.split(' ');
        let (method, target) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
        let path = target.split('?').next().unwrap_or_default().to_owned();
        match method {
            "GET" | "HEAD" => Request::Path { path, head: method == "HEAD" },
            _ => Request::Other,
        }
    }
}

fn answer(stream: &TcpStream, status: &str, (kind, body): Response, head: bool) -> io::Result<()> {
    let mut stream = Within::new(stream, ANSWERED);
    write!(stream, "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\n", body.len())?;
    write!(stream, "Cache-Control: no-store\r\nConnection: close\r\n\r\n")?;
    if head { Ok(()) } else { stream.write_all(&body) }
}

fn text(words: &str) -> Response {
    ("text/plain", words.as_bytes().to_vec())
}

/// A connection that ends at a moment, however slowly bytes come and go.
struct Within<'a> {
    stream: &'a TcpStream,
    end: Instant,
}

impl<'a> Within<'a> {
    fn new(stream: &'a TcpStream, patience: Duration) -> Self {
        Within { stream, end: Instant::now() + patience }
    }

    fn left(&self) -> io::Result<Option<Duration>> {
        let left = self.end.saturating_duration_since(Instant::now());
        if left.is_zero() { Err(io::ErrorKind::TimedOut.into()) } else { Ok(Some(left.min(PATIENCE))) }
    }
}

impl Read for Within<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        self.stream.set_read_timeout(self.left()?)?;
        self.stream.read(into)
    }
}

impl Write for Within<'_> {
    fn write(&mut self, from: &[u8]) -> io::Result<usize> {
        self.stream.set_write_timeout(self.left()?)?;
        self.stream.write(from)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
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
