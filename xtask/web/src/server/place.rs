//! From a path in a request to a file in the folder, and to nothing outside it.

use std::path::{Path, PathBuf};

use super::reply::Refused;

/// The file that `path`, percent-encoded, names in `root`, which is canonical. A path that ends in a slash names `index.html` there.
pub fn find(root: &Path, path: &str) -> Result<PathBuf, Refused> {
    let path = decoded(path).ok_or(Refused::Malformed)?;
    if path.contains('\0') {
        return Err(Refused::Malformed);
    }
    let mut place = root.to_owned();
    let mut segments = path.split('/').skip(1).peekable();
    while let Some(segment) = segments.next() {
        match segment {
            "" if segments.peek().is_none() => place.push("index.html"),
            // Also what other systems take for a separator or a drive.
            "" | "." | ".." => return Err(Refused::Missing),
            name if name.contains(['\\', ':']) => return Err(Refused::Missing),
            name => place.push(name),
        }
    }
    // Follows links: what counts is where the file lies in the end.
    let place = place.canonicalize().map_err(|_| Refused::Missing)?;
    if place.starts_with(root) && place.is_file() {
        Ok(place)
    } else {
        Err(Refused::Missing)
    }
}

/// `path` without percent signs, once: what they stood for is not decoded again. `None` where it is not UTF-8, or a percent sign stands
/// alone.
fn decoded(path: &str) -> Option<String> {
    let mut bytes = Vec::new();
    let mut rest = path.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        if first == b'%' {
            let digit = |i: usize| (*after.get(i)? as char).to_digit(16);
            bytes.push((digit(0)? * 16 + digit(1)?) as u8);
            rest = &after[2..];
        } else {
            bytes.push(first);
            rest = after;
        }
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percent_signs_are_decoded_once() {
        let decode = |path| decoded(path);
        assert_eq!(decode("/a%20b%2Fc"), Some("/a b/c".to_owned()));
        assert_eq!(decode("/%252e"), Some("/%2e".to_owned()));
        assert_eq!(decode("/%c3%a4"), Some("/ä".to_owned()));
        for wrong in ["/%", "/%4", "/%zz", "/%+1", "/%ff", "/%ä1"] {
            assert_eq!(decode(wrong), None, "{wrong}");
        }
    }
}
