//! A server of the page to browsers on this machine, which reads frames when they are asked for.

use std::{
    io::{self, BufRead, BufReader, Read, Write},
    net::{Ipv4Addr, TcpListener, TcpStream},
    path::Path,
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
    for stream in listener.incoming().flatten() {
        // a browser that has gone away wants no answer
        let _ = answer(stream, folder, &mut view, &mut first);
    }
    Ok(())
}

fn answer(mut stream: TcpStream, folder: &Path, view: &mut RunView, first: &mut Chunk) -> io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let mut lines = BufReader::new(Read::take(&stream, LONGEST)).lines();
    let request = lines.next().transpose()?.unwrap_or_default();
    let mut known = false;
    while let Some(line) = lines.next().transpose()?.filter(|line| !line.is_empty()) {
        known |= line.split_once(':').is_some_and(|(name, host)| name.eq_ignore_ascii_case("host") && is_here(host.trim()));
    }
    drop(lines);
    let path = request.strip_prefix("GET ").and_then(|rest| rest.split(' ').next()).filter(|_| known);
    let (status, kind, body) = match path.map(|path| respond(path, folder, view, first)) {
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

fn respond(path: &str, folder: &Path, view: &mut RunView, first: &mut Chunk) -> Result<Option<(&'static str, Vec<u8>)>> {
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
