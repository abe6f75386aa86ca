//! `light.npz`: light that varies by vertex (docs/format.md).

use std::io::{self, Seek, Write};
use std::path::Path;

use thiserror::Error;

use super::{MAX_RADIANCE, VertexLight};
use crate::basis::Order;
use crate::files::npz::{self, Npz};
use crate::files::printable;

/// A `light.npz` that could not be read or written. One line: what, where, what to do.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum VertexLightError {
    /// The file could not be read or written, or is no such file.
    #[error("{}: {source}", printable(path))]
    File {
        /// The path as given.
        path: String,
        /// Why.
        source: io::Error,
    },
    /// The array is not one of coefficients.
    #[error(
        "{}: coefficients of shape {shape:?}; it must be [vertices, n², 3]",
        printable(path)
    )]
    Shape {
        /// The path as given.
        path: String,
        /// As the file says.
        shape: Vec<u64>,
    },
    /// Light of another object.
    #[error(
        "{}: light of {found} vertices for an asset of {expected}; make it with relume light --for that asset",
        printable(path)
    )]
    Count {
        /// The path as given.
        path: String,
        /// Vertices in the file.
        found: usize,
        /// Vertices of the asset.
        expected: usize,
    },
    /// A number that is none, or too large.
    #[error(
        "{}: coefficient {index} of vertex {vertex} is not finite or larger than 1e21; make the light again",
        printable(path)
    )]
    Value {
        /// The path as given.
        path: String,
        /// Which vertex.
        vertex: usize,
        /// Which of its coefficients, l(l+1)+m.
        index: usize,
    },
}

/// Coefficients reach √4π times the radiance.
const LARGEST: f32 = 10.0 * MAX_RADIANCE;

impl VertexLight {
    /// Adds float32 `coefficients` `[V, n², 3]`, vertices in the order of `rows`, and the basis header.
    pub(crate) fn write(
        &self,
        npz: &mut Npz<impl Write + Seek>,
        rows: impl Iterator<Item = usize>,
    ) -> io::Result<()> {
        let shape = [self.vertex_count() as u64, self.order().count() as u64, 3];
        let values = rows.flat_map(|v| self.coefficients(v)).flatten();
        npz.floats("coefficients", &shape, values.copied())?;
        for (key, token) in [
            ("basis", "sh"),
            ("convention", "real-no-cs"),
            ("quantity", "radiance"),
            ("colour", "linear-rec709"),
            ("frame", "scene"),
        ] {
            npz.text(key, token)?;
        }
        npz.array("order", &[], [self.order().get() as i32])
    }

    /// Reads `coefficients` of a `light.npz`, float32 or float64, vertices in the order of the file ([`crate::asset::import_light`] brings
    /// them to that of a world).
    ///
    /// # Errors
    /// What is wrong with the file; nothing is believed of its lengths.
    pub fn load(path: &Path) -> Result<Self, VertexLightError> {
        let (shape, values) =
            npz::load(path, "coefficients").map_err(|source| file(path, source))?;
        let wrong = || VertexLightError::Shape {
            path: path.display().to_string(),
            shape: shape.clone(),
        };
        let [_, count, 3] = shape[..] else {
            return Err(wrong());
        };
        let order = (1..=Order::MAX).find(|n| (n * n) as u64 == count);
        let order = order.and_then(|n| Order::new(n).ok()).ok_or_else(wrong)?;
        let (coefficients, []) = values.as_chunks::<3>() else {
            return Err(wrong());
        };
        let fine = |rgb: &[f32; 3]| rgb.iter().all(|x| x.abs() <= LARGEST);
        if let Some(place) = coefficients.iter().position(|rgb| !fine(rgb)) {
            return Err(VertexLightError::Value {
                path: path.display().to_string(),
                vertex: place / order.count(),
                index: place % order.count(),
            });
        }
        Ok(Self::new(order, coefficients.to_vec()))
    }
}

fn file(path: &Path, source: io::Error) -> VertexLightError {
    VertexLightError::File {
        path: path.display().to_string(),
        source,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::ShLight;

    fn light() -> VertexLight {
        let order = Order::new(2).unwrap();
        let coefficients = (0..12).map(|i| [i as f32, 0.5, -(i as f32)]).collect();
        VertexLight::new(order, coefficients)
    }

    #[test]
    fn what_is_written_is_read_back_and_damage_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("light.npz");
        let save = || npz::save(&path, |npz| light().write(npz, 0..3)).unwrap();
        save();
        assert_eq!(VertexLight::load(&path).unwrap(), light());
        let bytes = std::fs::read(&path).unwrap();
        save();
        assert_eq!(std::fs::read(&path).unwrap(), bytes, "the same bytes");
        for cut in [0, 10, bytes.len() / 2, bytes.len() - 1] {
            std::fs::write(&path, &bytes[..cut]).unwrap();
            let message = VertexLight::load(&path).unwrap_err().to_string();
            assert!(
                message.contains("light.npz") && message.lines().count() == 1,
                "{message}"
            );
        }
        let save = |shape: &[u64], values: Vec<f32>| {
            npz::save(&path, |npz| npz.floats("coefficients", shape, values)).unwrap();
            VertexLight::load(&path).unwrap_err().to_string()
        };
        assert!(save(&[2, 5, 3], vec![0.0; 30]).contains("[2, 5, 3]"));
        assert!(save(&[12], vec![0.0; 12]).contains("[12]"));
        assert!(save(&[2, 1, 3], vec![0.0, 0.0, 0.0, 0.0, f32::NAN, 0.0]).contains("vertex 1"));
        assert!(
            VertexLight::load(folder.path())
                .unwrap_err()
                .to_string()
                .contains("not a file")
        );
    }

    #[test]
    fn lights_add_up_at_the_higher_order() {
        let far = ShLight::new(Order::new(1).unwrap(), vec![[1.0; 3]]);
        let sum = light().plus(&far);
        assert_eq!(sum.order(), light().order());
        assert_eq!(sum.coefficients(1)[0], [5.0, 1.5, -3.0]);
        assert_eq!(sum.coefficients(1)[1], light().coefficients(1)[1]);
        let far = ShLight::new(Order::new(3).unwrap(), vec![[2.0; 3]; 9]);
        let sum = light().plus(&far);
        assert_eq!(sum.order().get(), 3);
        assert_eq!(
            (sum.coefficients(2)[3], sum.coefficients(2)[8]),
            ([13.0, 2.5, -9.0], [2.0; 3])
        );
    }
}
