//! A small server for this machine alone: the files of one folder, to be looked at in a browser.
//!
//! It listens on 127.0.0.1 only, and answers only requests that name it by that address or as localhost: a page elsewhere that has its own
//! name point here (DNS rebinding) gets nothing. One request a connection, one thread each, few at a time.

mod place;
mod reply;
mod request;
#[cfg(test)]
mod tests;

use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, Shutdown, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use reply::Reply;

/// The most bytes of a request line and its headers: browsers send about one thousand.
const HEAD_LIMIT: usize = 16 << 10;
/// Connections at a time; browsers open six.
const CONNECTIONS: usize = 64;

/// How long the other side may take.
#[derive(Clone, Copy)]
struct Patience {
    /// For its whole head.
    head: Duration,
    /// To take the next part of the answer.
    write: Duration,
}

const PATIENCE: Patience = Patience {
    head: Duration::from_secs(10),
    write: Duration::from_secs(30),
};

/// Serves `folder` until the process ends. The first line on stdout is the address.
pub fn serve(folder: &Path, port: u16) -> Result<(), String> {
    let server = Server::bind(folder, port, PATIENCE)?;
    println!("http://127.0.0.1:{}/", server.port);
    io::stdout().flush().map_err(|error| error.to_string())?;
    server.run();
    Ok(())
}

/// A server that listens.
struct Server {
    listener: TcpListener,
    port: u16,
    /// Canonical, so that what lies in it can be told from what does not.
    root: PathBuf,
    patience: Patience,
}

impl Server {
    fn bind(folder: &Path, port: u16, patience: Patience) -> Result<Self, String> {
        let root = folder
            .canonicalize()
            .map_err(|error| format!("{}: {error}; build it first", folder.display()))?;
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(|error| {
            format!("cannot listen on 127.0.0.1:{port}: {error}; name another port, or 0 for any")
        })?;
        let port = listener
            .local_addr()
            .map_err(|error| error.to_string())?
            .port();
        Ok(Self {
            listener,
            port,
            root,
            patience,
        })
    }

    /// Answers connections, for as long as there is a listener.
    fn run(self) {
        let open = Arc::new(AtomicUsize::new(0));
        for stream in self.listener.incoming() {
            let Ok(stream) = stream else {
                // Out of descriptors, or a connection that went before it came: neither is for ever.
                std::thread::sleep(Duration::from_millis(10));
                continue;
            };
            if open.fetch_add(1, Ordering::Relaxed) >= CONNECTIONS {
                // Dropped, which closes it.
                open.fetch_sub(1, Ordering::Relaxed);
                continue;
            }
            let (root, port, patience) = (self.root.clone(), self.port, self.patience);
            let counted = Counted(open.clone());
            std::thread::spawn(move || {
                // A browser that goes away in the middle is not worth a word.
                let _ = answer(stream, &root, port, patience);
                drop(counted);
            });
        }
    }
}

/// A connection among those counted.
struct Counted(Arc<AtomicUsize>);

impl Drop for Counted {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Reads one request and answers it.
fn answer(mut stream: TcpStream, root: &Path, port: u16, patience: Patience) -> io::Result<()> {
    stream.set_write_timeout(Some(patience.write))?;
    let reply = match read_head(&mut stream, Instant::now() + patience.head)? {
        Head::Whole(head) => {
            let request = request::parse(&head).and_then(|request| request.check(port));
            match request {
                Ok(request) => place::find(root, &request.path)
                    .and_then(|path| Reply::file(&path, request.body))
                    .unwrap_or_else(|refused| Reply::refusal(refused, request.body)),
                Err(refused) => Reply::refusal(refused, true),
            }
        }
        Head::Long => Reply::refusal(reply::Refused::TooLong, true),
        Head::Slow => Reply::refusal(reply::Refused::TooSlow, true),
        Head::Cut => return Ok(()),
    };
    reply.send(&mut stream)?;
    hang_up(&mut stream)
}

/// What came before the empty line.
enum Head {
    /// All of it, with nothing after it.
    Whole(Vec<u8>),
    /// More than [`HEAD_LIMIT`].
    Long,
    /// It did not end in time.
    Slow,
    /// The other side went away.
    Cut,
}

/// Reads up to the empty line. A body, which nothing here takes, is left alone.
fn read_head(stream: &mut TcpStream, deadline: Instant) -> io::Result<Head> {
    let mut head = Vec::new();
    let mut part = [0; 4096];
    loop {
        let left = deadline.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Ok(Head::Slow);
        }
        stream.set_read_timeout(Some(left))?;
        let read = match stream.read(&mut part) {
            Ok(0) => return Ok(Head::Cut),
            Ok(read) => read,
            Err(error) if is_timeout(&error) => return Ok(Head::Slow),
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(error),
        };
        // The end may straddle two parts.
        let searched = head.len().saturating_sub(3);
        head.extend_from_slice(&part[..read]);
        let end = head[searched..]
            .windows(4)
            .position(|four| four == b"\r\n\r\n");
        if let Some(end) = end.map(|end| searched + end)
            && end <= HEAD_LIMIT
        {
            head.truncate(end);
            return Ok(Head::Whole(head));
        }
        if head.len() > HEAD_LIMIT {
            return Ok(Head::Long);
        }
    }
}

fn is_timeout(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut
    )
}

/// Ends the connection so that the answer arrives: closed with bytes unread, it would be reset, and the answer lost.
fn hang_up(stream: &mut TcpStream) -> io::Result<()> {
    stream.shutdown(Shutdown::Write)?;
    stream.set_read_timeout(Some(Duration::from_millis(200)))?;
    let mut part = [0; 4096];
    // A few, not what somebody goes on sending.
    for _ in 0..64 {
        if !matches!(stream.read(&mut part), Ok(read) if read > 0) {
            break;
        }
    }
    Ok(())
}
