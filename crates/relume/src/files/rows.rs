//! Numbers that live in memory or in a file.
#![allow(
    unsafe_code,
    reason = "mapping a file is unsafe in any crate: whoever shortens it meanwhile takes memory away from under us"
)]

use std::borrow::Cow;
use std::fmt;
use std::ops::{Deref, DerefMut};

#[cfg(not(target_arch = "wasm32"))]
use std::{fs::File, io, sync::Arc};

/// Many f32: a vector in memory, or a file of little-endian f32 that is mapped into memory and may be larger than it.
///
/// It is used as a slice. Changing a mapped value changes this process's copy of its page and never the file, so what is changed takes
/// memory and what is only read does not. A clone lies in memory.
#[derive(Default)]
pub struct Rows(Store);

enum Store {
    Memory(Vec<f32>),
    #[cfg(all(any(unix, windows), target_endian = "little"))]
    Mapped {
        map: memmap2::MmapMut,
        /// Held so that nobody else may touch the file while it is mapped.
        _lock: Arc<File>,
    },
}

impl Default for Store {
    fn default() -> Self {
        Self::Memory(Vec::new())
    }
}

impl Rows {
    /// The first `count` numbers of a file of ours, mapped where the system can, else read.
    ///
    /// `lock` is the locked file that keeps every other relume away from `file`; it stays open, and locked, as long as the numbers live.
    /// Fails when the file is shorter than that, and as the system does.
    #[cfg(not(target_arch = "wasm32"))]
    #[cfg_attr(not(feature = "bake"), allow(dead_code, reason = "for checkpoints"))]
    pub(crate) fn of_file(file: &File, lock: &Arc<File>, count: usize) -> io::Result<Self> {
        let bytes = count.checked_mul(4).ok_or(io::ErrorKind::OutOfMemory)?;
        if file.metadata()?.len() < bytes as u64 {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        if count == 0 {
            return Ok(Self::default());
        }
        Self::map(file, lock, bytes)
    }

    #[cfg(all(any(unix, windows), target_endian = "little"))]
    fn map(file: &File, lock: &Arc<File>, bytes: usize) -> io::Result<Self> {
        let mut options = memmap2::MmapOptions::new();
        // Without a reserve: else Linux refuses a private map of more than memory and swap together.
        options.len(bytes).no_reserve_swap();
        // SAFETY: the file is ours, at least `bytes` long, and under `lock` from now on until the map is gone; no relume that holds
        // the lock ever shortens it (checkpoints only grow their files, or unlink them). The map is private: nothing is written back.
        let map = unsafe { options.map_copy(file)? };
        Ok(Self(Store::Mapped {
            map,
            _lock: Arc::clone(lock),
        }))
    }

    #[cfg(all(
        not(target_arch = "wasm32"),
        not(all(any(unix, windows), target_endian = "little"))
    ))]
    fn map(mut file: &File, _lock: &Arc<File>, bytes: usize) -> io::Result<Self> {
        use io::{Read, Seek};
        file.rewind()?;
        let mut all = Vec::with_capacity(bytes);
        file.take(bytes as u64).read_to_end(&mut all)?;
        if all.len() < bytes {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        let values = all.as_chunks::<4>().0.iter();
        Ok(values.copied().map(f32::from_le_bytes).collect())
    }

    /// Whether the numbers lie in a file rather than in memory.
    pub fn is_mapped(&self) -> bool {
        !matches!(self.0, Store::Memory(_))
    }

    /// The numbers as a vector: the one they lie in, or a copy of a file.
    pub fn into_vec(self) -> Vec<f32> {
        match self.0 {
            Store::Memory(values) => values,
            #[cfg(all(any(unix, windows), target_endian = "little"))]
            Store::Mapped { .. } => self.to_vec(),
        }
    }
}

impl Deref for Rows {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        match &self.0 {
            Store::Memory(values) => values,
            // A map begins at a page, and its length is a multiple of four.
            #[cfg(all(any(unix, windows), target_endian = "little"))]
            Store::Mapped { map, .. } => bytemuck::cast_slice(map),
        }
    }
}

impl DerefMut for Rows {
    fn deref_mut(&mut self) -> &mut [f32] {
        match &mut self.0 {
            Store::Memory(values) => values,
            #[cfg(all(any(unix, windows), target_endian = "little"))]
            Store::Mapped { map, .. } => bytemuck::cast_slice_mut(map),
        }
    }
}

impl From<Vec<f32>> for Rows {
    fn from(values: Vec<f32>) -> Self {
        Self(Store::Memory(values))
    }
}

impl FromIterator<f32> for Rows {
    fn from_iter<I: IntoIterator<Item = f32>>(values: I) -> Self {
        Vec::from_iter(values).into()
    }
}

impl Clone for Rows {
    fn clone(&self) -> Self {
        self.to_vec().into()
    }
}

impl fmt::Debug for Rows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}

impl PartialEq for Rows {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl PartialEq<Vec<f32>> for Rows {
    fn eq(&self, other: &Vec<f32>) -> bool {
        **self == **other
    }
}

/// The bytes of `values` as files hold them: little-endian, on any machine.
pub fn le_bytes(values: &[f32]) -> Cow<'_, [u8]> {
    le_words(bytemuck::cast_slice(values))
}

/// [`le_bytes`] of whole numbers.
pub fn le_words(values: &[u32]) -> Cow<'_, [u8]> {
    if cfg!(target_endian = "little") {
        Cow::Borrowed(bytemuck::cast_slice(values))
    } else {
        Cow::Owned(
            values
                .iter()
                .flat_map(|value| value.to_le_bytes())
                .collect(),
        )
    }
}

#[cfg(all(test, not(target_arch = "wasm32")))]
mod tests {
    use super::*;

    fn file_of(values: &[f32]) -> Arc<File> {
        let file = tempfile::tempfile().unwrap();
        io::Write::write_all(&mut &file, &le_bytes(values)).unwrap();
        Arc::new(file)
    }

    #[test]
    fn numbers_of_a_file_are_those_that_went_in() {
        let values: Vec<f32> = (0..5000).map(|i| (i as f32).sqrt() - 7.0).collect();
        let file = file_of(&values);
        for count in [0, 1, 1023, 1024, 1025, 5000] {
            let rows = Rows::of_file(&file, &file, count).unwrap();
            assert_eq!(&*rows, &values[..count]);
            assert_eq!(rows, Rows::from(values[..count].to_vec()));
            assert_eq!(rows.clone().into_vec(), &values[..count]);
            assert_eq!(rows.into_vec(), &values[..count]);
        }
    }

    #[test]
    fn changes_stay_private() {
        let values = vec![1.0; 3000];
        let file = file_of(&values);
        let mut rows = Rows::of_file(&file, &file, 3000).unwrap();
        rows[17] = 2.0;
        rows[2999] += 4.0;
        let clone = rows.clone();
        assert_eq!((rows[16], rows[17], rows[2999]), (1.0, 2.0, 5.0));
        assert!(!clone.is_mapped());
        assert_eq!(clone, rows);
        assert_eq!(Rows::of_file(&file, &file, 3000).unwrap(), values);
    }

    #[test]
    fn a_file_that_is_too_short_is_refused() {
        let file = file_of(&[1.0, 2.0]);
        let error = Rows::of_file(&file, &file, 3).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::UnexpectedEof);
        assert!(Rows::of_file(&file, &file, usize::MAX / 2).is_err());
    }

    #[test]
    fn the_lock_outlives_who_took_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lock");
        let lock = Arc::new(File::create(&path).unwrap());
        lock.try_lock().unwrap();
        let again = || File::open(&path).unwrap().try_lock().is_ok();
        let rows = Rows::of_file(&file_of(&[3.0]), &lock, 1).unwrap();
        drop(lock);
        if rows.is_mapped() {
            assert!(!again());
        }
        drop(rows);
        // Where another test starts a child just now, it holds the lock until it is another program.
        assert!((0..100).any(|_| {
            std::thread::sleep(std::time::Duration::from_millis(10));
            again()
        }));
    }

    #[test]
    fn bytes_are_little_endian() {
        assert_eq!(&*le_bytes(&[1.0, -2.0]), [0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0]);
    }
}
