//! Arrays for numpy, several in a file.

use std::fs::File;
use std::io::{self, BufReader, BufWriter, Seek, Write};
use std::path::Path;

use npyz::WriterBuilder;
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, System, ZipArchive, ZipWriter};

use super::{npy, write_atomically};

/// From this many bytes on an entry says its length in 64 bits.
const LARGE: u64 = 0xf000_0000;

/// Writes a file of arrays whole or not at all. The same bytes each time.
pub fn save(
    path: &Path,
    write: impl FnOnce(&mut Npz<&mut BufWriter<&File>>) -> io::Result<()>,
) -> io::Result<()> {
    write_atomically(path, |writer| {
        let mut npz = Npz(ZipWriter::new(writer));
        write(&mut npz)?;
        npz.0.finish()?;
        Ok(())
    })
}

/// Reads the array `name`, float32 or float64 in C order: its shape and its values, of which there are 2²⁸ at most.
///
/// # Errors
/// What is wrong with the file, or with the array; nothing is believed of its lengths.
pub fn load(path: &Path, name: &str) -> io::Result<(Vec<u64>, Vec<f32>)> {
    let wrong = |what: String| io::Error::new(io::ErrorKind::InvalidData, what);
    // Asked before opening: opening a pipe would wait.
    if !std::fs::metadata(path)?.is_file() {
        return Err(wrong("is not a file".to_owned()));
    }
    let mut archive = ZipArchive::new(BufReader::new(File::open(path)?))
        .map_err(|_| wrong("is no .npz file".to_owned()))?;
    let entry = archive.by_name(&format!("{name}.npy")).map_err(|error| {
        wrong(match error {
            ZipError::FileNotFound => format!("has no array named {name}"),
            _ => format!("has a packed or broken array {name}; save it with numpy.savez"),
        })
    })?;
    npy::read(BufReader::new(entry)).map_err(|what| wrong(format!("its array {name} {what}")))
}

/// An uncompressed zip of `.npy` files.
pub struct Npz<W: Write + Seek>(ZipWriter<W>);

impl<W: Write + Seek> Npz<W> {
    /// [`Npz::array`] of float32.
    pub fn floats(
        &mut self,
        name: &str,
        shape: &[u64],
        values: impl IntoIterator<Item = f32>,
    ) -> io::Result<()> {
        self.array(name, shape, values)
    }

    /// An array of `shape`, the last axis fastest.
    pub fn array<T: npyz::AutoSerialize>(
        &mut self,
        name: &str,
        shape: &[u64],
        values: impl IntoIterator<Item = T>,
    ) -> io::Result<()> {
        let dtype = T::default_dtype();
        self.start(name, shape, 8)?;
        let mut npy = npyz::WriteOptions::new()
            .dtype(dtype)
            .shape(shape)
            .writer(&mut self.0)
            .begin_nd()?;
        npy.extend(values)?;
        npy.finish()
    }

    /// A string, as numpy's unicode array of no dimension.
    pub fn text(&mut self, name: &str, text: &str) -> io::Result<()> {
        let size = text.chars().count().max(1);
        let kind = format!("<U{size}").parse().map_err(io::Error::other)?;
        self.start(name, &[], 4 * size as u64)?;
        let mut npy = npyz::WriteOptions::<str>::new()
            .dtype(npyz::DType::new_scalar(kind))
            .shape(&[])
            .writer(&mut self.0)
            .begin_nd()?;
        npy.push(text)?;
        npy.finish()
    }

    /// Begins an entry of at most `width` bytes per value.
    fn start(&mut self, name: &str, shape: &[u64], width: u64) -> io::Result<()> {
        // The same everywhere: not the clock's time, and not the name of the machine's system.
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .last_modified_time(DateTime::default())
            .system(System::Unix)
            .unix_permissions(0o644)
            .large_file(width * shape.iter().product::<u64>() >= LARGE);
        Ok(self.0.start_file(format!("{name}.npy"), options)?)
    }
}
