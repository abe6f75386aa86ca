//! The head of an HTTP/1 request.

use super::reply::Refused;

/// What a request says, as far as anything here depends on it.
#[derive(Debug, PartialEq)]
pub struct Request {
    method: Method,
    hosts: Vec<String>,
    /// The target up to `?`, as it came.
    target: String,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Method {
    Get,
    Head,
    Other,
}

/// A request that may be answered.
#[derive(Debug, PartialEq)]
pub struct Checked {
    /// The path, still percent-encoded; begins with a slash.
    pub path: String,
    /// False for HEAD.
    pub body: bool,
}

/// Reads the request line and the headers, which come without the empty line that ends them.
pub fn parse(head: &[u8]) -> Result<Request, Refused> {
    // All that is needed is ASCII; what is not is no request that a browser makes.
    let head = std::str::from_utf8(head).map_err(|_| Refused::Malformed)?;
    let mut lines = head.split("\r\n");
    let line = lines.next().unwrap_or_default();
    let words: Vec<&str> = line.split(' ').collect();
    let [method, target, version] = words[..] else {
        return Err(Refused::Malformed);
    };
    if !matches!(version, "HTTP/1.1" | "HTTP/1.0") {
        return Err(Refused::Malformed);
    }
    let method = match method {
        "GET" => Method::Get,
        "HEAD" => Method::Head,
        "" => return Err(Refused::Malformed),
        _ => Method::Other,
    };
    let mut hosts = Vec::new();
    for line in lines {
        let (name, value) = line.split_once(':').ok_or(Refused::Malformed)?;
        // Space before the colon, or a line that goes on: two readers would read two things.
        if name.is_empty() || name.contains([' ', '\t']) {
            return Err(Refused::Malformed);
        }
        if name.eq_ignore_ascii_case("host") {
            hosts.push(value.trim_matches([' ', '\t']).to_ascii_lowercase());
        }
    }
    Ok(Request {
        method,
        hosts,
        target: target
            .split(['?', '#'])
            .next()
            .unwrap_or_default()
            .to_owned(),
    })
}

impl Request {
    /// Whether it is meant for the server on this port, and asks for what that does.
    pub fn check(self, port: u16) -> Result<Checked, Refused> {
        let ours = |host: &String| {
            let name = match host.rsplit_once(':') {
                Some((name, written)) => (written == port.to_string()).then_some(name),
                // Browsers leave the usual port out.
                None => (port == 80).then_some(host.as_str()),
            };
            matches!(name, Some("127.0.0.1" | "localhost"))
        };
        if self.hosts.len() != 1 || !self.hosts.iter().all(ours) {
            return Err(Refused::Host);
        }
        let body = match self.method {
            Method::Get => true,
            Method::Head => false,
            Method::Other => return Err(Refused::Method),
        };
        if !self.target.starts_with('/') {
            return Err(Refused::Malformed);
        }
        let path = self.target;
        Ok(Checked { path, body })
    }
}
