//! The file beside a `.glb` that holds its transfer where a `.glb`, which ends at 4 GiB, has no room for it.

use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crc32fast::Hasher;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_decode_str, utf8_percent_encode};
use serde_json::Value;

use super::AssetError;
use super::container::Bin;
use super::header::Beside;
use crate::files::printable;

/// How such a file begins, so that no other is ever written over. The transfer follows.
pub const MAGIC: &[u8; 16] = b"RELUME_transfer\n";
/// What stands in a URI as it is (RFC 3986 §2.3).
const ENCODED: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'-')
    .remove(b'.')
    .remove(b'_')
    .remove(b'~');
/// Bytes read at a time: a multiple of four.
const PIECE: usize = 1 << 20;

/// `<name>.bin` for the asset `<name>.glb`.
pub fn path(asset: &Path) -> PathBuf {
    asset.with_extension("bin")
}

/// The file's name, fit to print.
fn shown(asset: &Path) -> String {
    let path = path(asset);
    printable(&path.file_name().unwrap_or_default().to_string_lossy())
}

/// The URI by which the asset names the file.
pub fn uri(asset: &Path) -> Result<String, AssetError> {
    let refused = |what: &str| AssetError::Unwritable(what.to_owned());
    let path = path(asset);
    if path == asset {
        let what = "ends in .bin, as the file with its transfer would; choose another output";
        return Err(refused(what));
    }
    let name = path.file_name().and_then(|name| name.to_str());
    let name = name.ok_or_else(|| {
        refused("has no name in UTF-8, which glTF needs for the file beside it; choose another")
    })?;
    Ok(utf8_percent_encode(name, ENCODED).to_string())
}

/// Refuses to write over a file that is none of ours.
pub fn check_free(asset: &Path) -> Result<(), AssetError> {
    match is_ours(&path(asset)) {
        Ok(true) => Ok(()),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        _ => Err(AssetError::InTheWay(shown(asset))),
    }
}

/// Takes away the transfer of an older asset of the same name, which nobody reads any more.
pub fn forget(asset: &Path) {
    let path = path(asset);
    if path != asset && is_ours(&path).unwrap_or(false) {
        // If it stays, it only takes room.
        let _ = fs::remove_file(path);
    }
}

/// Whether a regular file, no link to one, begins as ours do.
fn is_ours(path: &Path) -> io::Result<bool> {
    if !fs::symlink_metadata(path)?.is_file() {
        return Ok(false);
    }
    let mut found = Vec::new();
    let length = MAGIC.len() as u64;
    File::open(path)?.take(length).read_to_end(&mut found)?;
    Ok(found == MAGIC)
}

/// Writes all of `bin`; returns its CRC-32 as the header says it.
pub fn write(bin: &Bin<'_>, writer: &mut BufWriter<&File>) -> io::Result<String> {
    struct Hashing<'a, 'f>(&'a mut BufWriter<&'f File>, Hasher);
    impl Write for Hashing<'_, '_> {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let written = self.0.write(bytes)?;
            self.1.update(&bytes[..written]);
            Ok(written)
        }
        fn flush(&mut self) -> io::Result<()> {
            self.0.flush()
        }
    }
    let mut hashing = Hashing(writer, Hasher::new());
    bin.write(&mut hashing)?;
    Ok(format!("{:08x}", hashing.1.finalize()))
}

/// The file, open for reading.
pub struct Source {
    file: File,
    name: String,
    header: Beside,
}

impl Source {
    /// Opens the file that belongs to `asset`: the regular file of that one name in the same folder, and exactly as long as both the
    /// header and the document say.
    pub fn open(asset: &Path, header: &Beside, document: &Value) -> Result<Self, AssetError> {
        let name = shown(asset);
        let wrong = |what: &str| AssetError::Beside {
            name: name.clone(),
            what: what.to_owned(),
        };
        let path = path(asset);
        let buffer = &document["buffers"][1];
        let uri = buffer["uri"].as_str().unwrap_or_default();
        let decoded = percent_decode_str(uri).decode_utf8();
        let own = path.file_name().and_then(|name| name.to_str());
        if path == asset || own.is_none() || decoded.ok().as_deref() != own {
            let named = printable(&uri.chars().take(200).collect::<String>());
            return Err(wrong(&format!("it calls \"{named}\"")));
        }
        if buffer["byteLength"].as_u64() != Some(header.byte_length) {
            return Err(wrong("has two lengths in its document"));
        }
        let found = match fs::symlink_metadata(&path) {
            Ok(found) if found.is_file() => found,
            Ok(_) => return Err(wrong("is no regular file")),
            Err(error) => return Err(wrong(&format!("cannot be read: {error}"))),
        };
        if found.len() != header.byte_length {
            let (found, said) = (found.len(), header.byte_length);
            return Err(wrong(&format!("has {found} bytes, not {said}")));
        }
        let file = File::open(&path).map_err(|error| wrong(&format!("cannot be read: {error}")))?;
        let header = header.clone();
        Ok(Self { file, name, header })
    }

    /// Its length in bytes.
    pub fn len(&self) -> u64 {
        self.header.byte_length
    }

    /// Hands out a range in pieces whose length is a multiple of four, but for the last, and adds them to a hash.
    pub fn each(
        &self,
        range: std::ops::Range<u64>,
        hash: &mut Hasher,
        mut take: impl FnMut(&[u8]),
    ) -> io::Result<()> {
        let mut file = &self.file;
        file.seek(SeekFrom::Start(range.start))?;
        let mut left = range.end - range.start;
        let mut buffer = vec![0; left.min(PIECE as u64) as usize];
        while left > 0 {
            let length = left.min(PIECE as u64);
            let piece = &mut buffer[..length as usize];
            file.read_exact(piece)?;
            hash.update(piece);
            take(piece);
            left -= length;
        }
        Ok(())
    }

    /// Refuses the file if its hash, put together from those of `read` (by start: end and hash) and what lies between, is not the header's.
    pub fn check<'h>(
        &self,
        read: impl Iterator<Item = (u64, u64, &'h Hasher)>,
    ) -> Result<(), AssetError> {
        let unreadable = |error: io::Error| self.wrong(&format!("cannot be read: {error}"));
        let mut whole = Hasher::new();
        let mut at = 0;
        for (start, end, hash) in read {
            self.each(at..start, &mut whole, |_| {})
                .map_err(unreadable)?;
            whole.combine(hash);
            at = end;
        }
        self.each(at..self.len(), &mut whole, |_| {})
            .map_err(unreadable)?;
        if format!("{:08x}", whole.finalize()) == self.header.crc32 {
            Ok(())
        } else {
            Err(self.wrong("is damaged, or of another bake"))
        }
    }

    fn wrong(&self, what: &str) -> AssetError {
        AssetError::Beside {
            name: self.name.clone(),
            what: what.to_owned(),
        }
    }
}
