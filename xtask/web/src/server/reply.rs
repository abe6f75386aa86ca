//! Answers.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

/// Why a request is not answered with a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refused {
    /// Not a request, or not one of HTTP/1.
    Malformed,
    /// Meant for somebody else.
    Host,
    /// Nothing there to be had.
    Missing,
    /// Neither GET nor HEAD.
    Method,
    /// The head did not come in time.
    TooSlow,
    /// The head is too long.
    TooLong,
    /// It is there, and cannot be read.
    Unreadable,
}

impl Refused {
    /// The status line's rest, and what a person reads.
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Malformed => ("400 Bad Request", "this is not a request for a file here"),
            Self::Host => (
                "403 Forbidden",
                "this server answers to 127.0.0.1 and localhost with its port only",
            ),
            Self::Missing => ("404 Not Found", "there is no such file here"),
            Self::Method => (
                "405 Method Not Allowed",
                "this server answers GET and HEAD only",
            ),
            Self::TooSlow => ("408 Request Timeout", "the request took too long to come"),
            Self::TooLong => (
                "431 Request Header Fields Too Large",
                "the request's headers are too long",
            ),
            Self::Unreadable => (
                "500 Internal Server Error",
                "the file is there but cannot be read",
            ),
        }
    }
}

/// An answer, ready to be sent.
pub struct Reply {
    status: &'static str,
    mime: &'static str,
    length: u64,
    body: Option<Body>,
    /// Further header lines.
    also: &'static str,
}

enum Body {
    File(File),
    Text(String),
}

impl Reply {
    /// A file; without `body`, what is said about it.
    pub fn file(path: &Path, body: bool) -> Result<Self, Refused> {
        let open = || {
            let file = File::open(path)?;
            let length = file.metadata()?.len();
            Ok::<_, io::Error>((file, length))
        };
        let (file, length) = open().map_err(|_| Refused::Unreadable)?;
        Ok(Self {
            status: "200 OK",
            mime: mime(path),
            length,
            body: body.then_some(Body::File(file)),
            also: "",
        })
    }

    /// One line that says why not.
    pub fn refusal(refused: Refused, body: bool) -> Self {
        let (status, words) = refused.words();
        let text = format!("{words}\n");
        Self {
            status,
            mime: "text/plain; charset=utf-8",
            length: text.len() as u64,
            body: body.then_some(Body::Text(text)),
            also: match refused {
                Refused::Method => "Allow: GET, HEAD\r\n",
                _ => "",
            },
        }
    }

    /// Writes all of it.
    pub fn send(self, stream: &mut impl Write) -> io::Result<()> {
        let Self {
            status,
            mime,
            length,
            also,
            ..
        } = self;
        // What was built again is to be seen at once; no other site's page may read any of it.
        let head = format!(
            "HTTP/1.1 {status}\r\nContent-Type: {mime}\r\nContent-Length: {length}\r\n{also}\
             X-Content-Type-Options: nosniff\r\nCross-Origin-Resource-Policy: same-origin\r\n\
             Cache-Control: no-cache\r\nConnection: close\r\n\r\n"
        );
        stream.write_all(head.as_bytes())?;
        match self.body {
            // Not more than was promised, should the file have grown.
            Some(Body::File(file)) => io::copy(&mut file.take(length), stream).map(|_| ()),
            Some(Body::Text(text)) => stream.write_all(text.as_bytes()),
            None => Ok(()),
        }
    }
}

/// By the name's end; with `nosniff`, browsers believe it.
fn mime(path: &Path) -> &'static str {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    match extension.to_ascii_lowercase().as_str() {
        "html" => "text/html; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "js" | "mjs" => "text/javascript; charset=utf-8",
        "json" => "application/json",
        "wasm" => "application/wasm",
        "glb" => "model/gltf-binary",
        "svg" => "image/svg+xml",
        "png" => "image/png",
        "jpg" | "jpeg" => "image/jpeg",
        "hdr" => "image/vnd.radiance",
        "txt" => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}
