//! The server as the network sees it: raw bytes in, raw bytes out.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream, UdpSocket};
use std::time::{Duration, Instant};

use super::*;

/// A served folder beside a file that is not served.
struct Served {
    port: u16,
    _folder: tempfile::TempDir,
}

impl Served {
    fn new() -> Self {
        Self::patient(PATIENCE)
    }

    fn patient(patience: Patience) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let page = folder.path().join("page");
        for inside in ["gallery", "a b"] {
            std::fs::create_dir_all(page.join(inside)).unwrap();
        }
        let text = |name: &str, text: &str| std::fs::write(page.join(name), text).unwrap();
        text("index.html", "<!doctype html>");
        text("boot.js", "start()");
        text("program.wasm", "\0asm");
        text("a b/ä.txt", "umlaut");
        text("gallery/ball.glb", "glTF");
        std::fs::write(folder.path().join("secret.txt"), "secret").unwrap();
        std::fs::create_dir(folder.path().join("page-beside")).unwrap();
        std::fs::write(folder.path().join("page-beside/secret.txt"), "secret").unwrap();
        #[cfg(unix)]
        for (target, link) in [
            ("../secret.txt", "out.txt"),
            ("..", "up"),
            ("boot.js", "in.js"),
        ] {
            std::os::unix::fs::symlink(target, page.join(link)).unwrap();
        }
        let server = Server::bind(&page, 0, patience).unwrap();
        let port = server.port;
        std::thread::spawn(move || server.run());
        let _folder = folder;
        Self { port, _folder }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        let long = Some(Duration::from_secs(20));
        stream.set_read_timeout(long).unwrap();
        stream
    }

    /// What comes back for these bytes.
    fn raw(&self, bytes: &[u8]) -> String {
        let mut stream = self.connect();
        // A server that has heard enough may hang up before all is sent.
        let _ = stream.write_all(bytes);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8(answer).unwrap()
    }

    fn ask(&self, method: &str, path: &str) -> String {
        let port = self.port;
        self.raw(format!("{method} {path} HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n").as_bytes())
    }

    fn status(&self, method: &str, path: &str) -> u16 {
        status(&self.ask(method, path))
    }
}

fn status(answer: &str) -> u16 {
    let code = answer
        .strip_prefix("HTTP/1.1 ")
        .and_then(|rest| rest.get(..3));
    code.unwrap_or_else(|| panic!("no answer: {answer:?}"))
        .parse()
        .unwrap()
}

fn body(answer: &str) -> &str {
    answer.split_once("\r\n\r\n").unwrap().1
}

#[test]
fn files_come_with_their_type_and_length_and_are_not_sniffed() {
    let served = Served::new();
    for (path, mime, text) in [
        ("/", "text/html; charset=utf-8", "<!doctype html>"),
        ("/index.html", "text/html; charset=utf-8", "<!doctype html>"),
        ("/boot.js?v=1", "text/javascript; charset=utf-8", "start()"),
        ("/program.wasm", "application/wasm", "\0asm"),
        ("/gallery/ball.glb", "model/gltf-binary", "glTF"),
        ("/a%20b/%C3%A4.txt", "text/plain; charset=utf-8", "umlaut"),
    ] {
        let answer = served.ask("GET", path);
        assert_eq!(status(&answer), 200, "{path}");
        assert_eq!(body(&answer), text, "{path}");
        for line in [
            format!("Content-Type: {mime}"),
            format!("Content-Length: {}", text.len()),
            "X-Content-Type-Options: nosniff".to_owned(),
        ] {
            assert!(answer.contains(&format!("\r\n{line}\r\n")), "{line}");
        }
    }
}

#[test]
fn head_is_get_without_the_body() {
    let served = Served::new();
    let answer = served.ask("HEAD", "/boot.js");
    assert_eq!(status(&answer), 200);
    assert!(answer.contains("\r\nContent-Length: 7\r\n"));
    assert_eq!(body(&answer), "");
    let missing = served.ask("HEAD", "/none.js");
    assert_eq!((status(&missing), body(&missing)), (404, ""));
}

#[test]
fn other_methods_are_refused() {
    let served = Served::new();
    for method in ["POST", "PUT", "DELETE", "OPTIONS", "CONNECT", "get", "X"] {
        let answer = served.ask(method, "/boot.js");
        assert_eq!(status(&answer), 405, "{method}");
        assert!(answer.contains("\r\nAllow: GET, HEAD\r\n"));
    }
    // Its body goes unread, and the answer arrives all the same.
    let (port, long) = (served.port, "x".repeat(200_000));
    let post = format!("POST / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n{long}");
    assert_eq!(status(&served.raw(post.as_bytes())), 405);
}

#[test]
fn only_requests_that_name_this_machine_are_answered() {
    let served = Served::new();
    let port = served.port;
    let with = |headers: &str| {
        let request = format!("GET /boot.js HTTP/1.1\r\n{headers}\r\n");
        status(&served.raw(request.as_bytes()))
    };
    assert_eq!(with(&format!("Host: 127.0.0.1:{port}\r\n")), 200);
    assert_eq!(with(&format!("hOST:\tLocalHost:{port} \r\n")), 200);
    for host in [
        "evil.example".to_owned(),
        format!("evil.example:{port}"),
        format!("127.0.0.1.evil.example:{port}"),
        format!("evil.example/127.0.0.1:{port}"),
        format!("localhost:{}", port.wrapping_add(1)),
        format!("localhost:0{port}"),
        format!("user@localhost:{port}"),
        format!("[::1]:{port}"),
        "localhost".to_owned(),
        "127.0.0.1".to_owned(),
        String::new(),
    ] {
        assert_eq!(with(&format!("Host: {host}\r\n")), 403, "{host}");
    }
    assert_eq!(with(""), 403);
    let twice = format!("Host: localhost:{port}\r\nHost: evil.example\r\n");
    assert_eq!(with(&twice), 403);
    let same_twice = format!("Host: localhost:{port}\r\nHost: localhost:{port}\r\n");
    assert_eq!(with(&same_twice), 403);
}

#[test]
fn nothing_outside_the_folder_is_served() {
    let served = Served::new();
    for path in [
        "/../secret.txt",
        "/%2e%2e/secret.txt",
        "/.%2E/secret.txt",
        "/%2e%2e%2fsecret.txt",
        "/..%2fsecret.txt",
        "/..%5csecret.txt",
        "/..\\secret.txt",
        "/gallery/../../secret.txt",
        "/gallery/../boot.js",
        "/../page-beside/secret.txt",
        "/%252e%252e/secret.txt",
        "//etc/passwd",
        "/%2fetc/passwd",
        "/%2Fetc%2Fpasswd",
        "/C:/secret.txt",
        "/boot.js:stream",
        "/./boot.js",
        "/boot.js/",
        "/gallery",
        "/gallery/",
        "/none",
        #[cfg(unix)]
        "/out.txt",
        #[cfg(unix)]
        "/up/secret.txt",
        #[cfg(unix)]
        "/up/page-beside/secret.txt",
    ] {
        let answer = served.ask("GET", path);
        assert_eq!(status(&answer), 404, "{path}");
        assert!(!answer.contains("secret"), "{path}");
    }
    for path in [
        "/%00",
        "/boot.js%00.txt",
        "/%",
        "/%zz",
        "/%ff",
        "boot.js",
        "http://localhost/boot.js",
        "*",
    ] {
        assert_eq!(served.status("GET", path), 400, "{path}");
    }
}

#[cfg(unix)]
#[test]
fn a_link_to_a_file_of_the_folder_is_followed() {
    assert_eq!(body(&Served::new().ask("GET", "/in.js")), "start()");
}

#[test]
fn what_is_no_request_is_refused_in_one_line() {
    let served = Served::new();
    let host = format!("Host: localhost:{}", served.port);
    for request in [
        format!("GET /boot.js\r\n{host}\r\n\r\n"),
        format!("GET  /boot.js HTTP/1.1\r\n{host}\r\n\r\n"),
        format!("GET /boot.js HTTP/2\r\n{host}\r\n\r\n"),
        format!(" /boot.js HTTP/1.1\r\n{host}\r\n\r\n"),
        format!("GET /boot.js HTTP/1.1\r\nHost : localhost\r\n{host}\r\n\r\n"),
        format!("GET /boot.js HTTP/1.1\r\n{host}\r\n evil\r\n\r\n"),
        format!("GET /boot.js HTTP/1.1\r\n{host}\r\n: x\r\n\r\n"),
        "\r\n\r\n".to_owned(),
        "\u{16}\u{3}\u{1}\r\n\r\n".to_owned(),
    ] {
        let answer = served.raw(request.as_bytes());
        assert_eq!(status(&answer), 400, "{request:?}");
        assert_eq!(body(&answer).lines().count(), 1);
    }
    assert_eq!(
        status(&served.raw(b"GET /\xff HTTP/1.1\r\nHost: x\r\n\r\n")),
        400
    );
}

#[test]
fn long_heads_are_cut_off() {
    let served = Served::new();
    let port = served.port;
    let padded = |length: usize| {
        let padding = "x".repeat(length);
        let request =
            format!("GET /boot.js HTTP/1.1\r\nHost: localhost:{port}\r\nCookie: {padding}\r\n\r\n");
        status(&served.raw(request.as_bytes()))
    };
    assert_eq!(padded(HEAD_LIMIT - 200), 200);
    assert_eq!(padded(HEAD_LIMIT), 431);
    assert_eq!(padded(HEAD_LIMIT * 20), 431);
}

#[test]
fn slow_heads_are_given_up_and_do_not_keep_others_waiting() {
    let served = Served::patient(Patience {
        head: Duration::from_millis(400),
        ..PATIENCE
    });
    let mut slow: Vec<TcpStream> = (0..8).map(|_| served.connect()).collect();
    slow[0].write_all(b"GET / HT").unwrap();
    assert_eq!(served.status("GET", "/boot.js"), 200);
    let start = Instant::now();
    for stream in &mut slow {
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        assert_eq!(status(&answer), 408);
    }
    // They wait at the same time, each as long as it may and a little more.
    assert!(start.elapsed() < Duration::from_secs(5));
}

#[test]
fn a_head_may_come_a_byte_at_a_time() {
    let served = Served::new();
    let mut stream = served.connect();
    let request = format!(
        "GET /boot.js HTTP/1.1\r\nHost: localhost:{}\r\n\r\n",
        served.port
    );
    for byte in request.bytes() {
        stream.write_all(&[byte]).unwrap();
        stream.flush().unwrap();
    }
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    assert_eq!(status(&answer), 200);
}

#[test]
fn connections_past_the_limit_are_closed_and_room_comes_back() {
    let served = Served::patient(Patience {
        head: Duration::from_secs(3),
        ..PATIENCE
    });
    let held: Vec<TcpStream> = (0..CONNECTIONS).map(|_| served.connect()).collect();
    // All of them are taken before the next one is.
    assert_eq!(
        served.raw(b"GET / HTTP/1.1\r\n\r\n"),
        "",
        "one connection more"
    );
    drop(held);
    let deadline = Instant::now() + Duration::from_secs(10);
    loop {
        let request = format!("GET / HTTP/1.1\r\nHost: localhost:{}\r\n\r\n", served.port);
        let answer = served.raw(request.as_bytes());
        if !answer.is_empty() {
            assert_eq!(status(&answer), 200);
            break;
        }
        assert!(Instant::now() < deadline, "no room came back");
    }
}

#[test]
fn nobody_on_the_network_can_connect() {
    let served = Served::new();
    // The address this machine would speak from, if it has one; nothing is sent.
    let outside = UdpSocket::bind("0.0.0.0:0").and_then(|socket| {
        socket.connect("192.0.2.1:9")?;
        socket.local_addr()
    });
    let Ok(outside) = outside else {
        println!(
            "skipped: nobody_on_the_network_can_connect: needs an address besides the loopback"
        );
        return;
    };
    let address = SocketAddr::new(outside.ip(), served.port);
    let timeout = Duration::from_secs(2);
    assert!(TcpStream::connect_timeout(&address, timeout).is_err());
}

#[test]
fn a_port_that_is_taken_and_a_folder_that_is_missing_are_said_in_one_line() {
    let served = Served::new();
    let folder = tempfile::tempdir().unwrap();
    let taken = Server::bind(folder.path(), served.port, PATIENCE);
    let message = taken.err().unwrap();
    assert!(
        message.contains("another port") && !message.contains('\n'),
        "{message}"
    );
    let missing = Server::bind(&folder.path().join("none"), 0, PATIENCE);
    assert!(missing.err().unwrap().contains("none: "));
}
