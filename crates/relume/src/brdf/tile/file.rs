//! Tiles as files of numpy (docs/format.md).

use std::io;
use std::path::Path;

use thiserror::Error;

use super::{Tile, TileError, TileShape};
use crate::basis::Order;
use crate::files::{npz, printable};

/// The name of the array.
const ARRAY: &str = "tile";

/// A file that holds no tile, or could not be written.
#[derive(Debug, Error)]
pub enum TileFileError {
    /// It could not be read or written.
    #[error("{}: {source}", printable(path))]
    File {
        /// The path as given.
        path: String,
        /// Why not.
        source: io::Error,
    },
    /// Its array has not the six axes of a tile.
    #[error(
        "{}: the array {ARRAY} is {shape:?}, and a tile is [height, width, views, views, 3, order²]; write one with relume tile",
        printable(path)
    )]
    Axes {
        /// The path as given.
        path: String,
        /// What it has.
        shape: Vec<u64>,
    },
    /// Its values are no tile.
    #[error("{}: {source}", printable(path))]
    Tile {
        /// The path as given.
        path: String,
        /// What is wrong.
        source: TileError,
    },
}

impl Tile {
    /// Reads the array `tile`, `[height, width, views, views, 3, order²]`, of a `.npz` file.
    ///
    /// # Errors
    /// [`TileFileError`] when it cannot be read, or is no tile.
    pub fn read(path: &Path) -> Result<Self, TileFileError> {
        let name = || path.display().to_string();
        let (shape, values) = npz::load(path, ARRAY).map_err(|source| TileFileError::File {
            path: name(),
            source,
        })?;
        let shape = axes(&shape).ok_or_else(|| TileFileError::Axes {
            path: name(),
            shape: shape.clone(),
        })?;
        Self::new(shape, values).map_err(|source| TileFileError::Tile {
            path: name(),
            source,
        })
    }

    /// Writes it as [`Tile::read`] takes it, with what its coefficients mean. The same bytes each time.
    ///
    /// # Errors
    /// [`TileFileError::File`] when it cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), TileFileError> {
        let TileShape {
            width,
            height,
            views,
            order,
        } = self.shape;
        let shape = [height, width, views, views, 3, order.count()].map(|side| side as u64);
        npz::save(path, |npz| {
            npz.floats(ARRAY, &shape, self.values.iter().copied())?;
            npz.text("basis", "sh")?;
            npz.text("convention", "real-no-cs")?;
            npz.text("quantity", "radiance")?;
            npz.text("colour", "linear-rec709")?;
            npz.text("views", "octahedral")
        })
        .map_err(|source| TileFileError::File {
            path: path.display().to_string(),
            source,
        })
    }
}

/// The shape of six axes.
fn axes(shape: &[u64]) -> Option<TileShape> {
    let &[height, width, views, other, 3, count] = shape else {
        return None;
    };
    let order = Order::new((count as f64).sqrt() as usize).ok()?;
    (views == other && order.count() as u64 == count).then_some(TileShape {
        width: usize::try_from(width).ok()?,
        height: usize::try_from(height).ok()?,
        views: usize::try_from(views).ok()?,
        order,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tile() -> Tile {
        let shape = TileShape {
            width: 2,
            height: 3,
            views: 3,
            order: Order::new(2).unwrap(),
        };
        let values = (0..shape.count()).map(|i| i as f32 / 7.0);
        Tile::new(shape, values.collect()).unwrap()
    }

    #[test]
    fn what_is_written_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tile.npz");
        tile().write(&path).unwrap();
        assert_eq!(Tile::read(&path).unwrap(), tile());
        let first = std::fs::read(&path).unwrap();
        tile().write(&path).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), first);
    }

    #[test]
    fn what_is_no_tile_is_told_in_a_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tile.npz");
        let message = || Tile::read(&path).unwrap_err().to_string();
        assert!(message().contains("tile.npz: "));
        std::fs::write(&path, "not an archive").unwrap();
        assert!(message().ends_with("is no .npz file"));
        npz::save(&path, |npz| npz.floats("other", &[1], [0.0])).unwrap();
        assert!(message().ends_with("has no array named tile"));
        npz::save(&path, |npz| npz.floats(ARRAY, &[2, 2], [0.0; 4])).unwrap();
        assert!(
            message().contains("is [2, 2], and a tile is"),
            "{}",
            message()
        );
        npz::save(&path, |npz| {
            npz.array(ARRAY, &[1, 1, 2, 2, 3, 1], [1_i32; 12])
        })
        .unwrap();
        assert!(message().contains("save it as float32"), "{}", message());
        npz::save(&path, |npz| {
            npz.array(ARRAY, &[1, 1, 2, 2, 3, 1], [f64::NAN; 12])
        })
        .unwrap();
        assert!(message().contains("value 0 is NaN"));
        // Cut anywhere, and with any byte changed: an error or a tile, and no panic.
        tile().write(&path).unwrap();
        let whole = std::fs::read(&path).unwrap();
        for length in (0..whole.len()).step_by(97) {
            std::fs::write(&path, &whole[..length]).unwrap();
            assert!(Tile::read(&path).is_err());
        }
        for place in (0..whole.len()).step_by(31) {
            let mut bytes = whole.clone();
            bytes[place] ^= 0xff;
            std::fs::write(&path, &bytes).unwrap();
            let _ = Tile::read(&path);
        }
    }
}
