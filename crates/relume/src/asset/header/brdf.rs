//! How all surfaces of a scene reflect, in the JSON of `RELUME_transfer`.

use serde::{Deserialize, Serialize};

use crate::brdf::{self, Merl, Reflection};

/// How all surfaces of a scene reflect.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "model", rename_all = "lowercase")]
pub enum Brdf {
    /// By their albedo.
    Lambert {},
    /// By colours of its own.
    Phong {
        diffuse: [f64; 3],
        specular: [f64; 3],
        exponent: f64,
    },
    /// By their albedo as base colour.
    Ggx { metallic: f32, roughness: f32 },
    /// As measured: the buffer view of the table.
    Merl { table: usize },
}

impl Brdf {
    /// `None` for what a header cannot hold; `keep` puts a table into a buffer view.
    pub fn of<'a, E>(
        reflection: &'a Reflection,
        keep: impl FnOnce(&'a Merl) -> Result<usize, E>,
    ) -> Result<Option<Self>, E> {
        Ok(match reflection {
            Reflection::Diffuse => Some(Self::Lambert {}),
            &Reflection::MetallicRoughness {
                metallic,
                roughness,
            } => Some(Self::Ggx {
                metallic,
                roughness,
            }),
            Reflection::Fixed(brdf::Brdf::Phong(phong)) => Some(Self::Phong {
                diffuse: phong.diffuse.to_array(),
                specular: phong.specular.to_array(),
                exponent: phong.exponent,
            }),
            Reflection::Fixed(brdf::Brdf::Measured(merl)) => {
                let table = keep(merl)?;
                Some(Self::Merl { table })
            }
            Reflection::Fixed(_) => None,
        })
    }

    /// The reflection; `table` reads one out of a buffer view.
    pub fn reflection<E>(
        self,
        table: impl FnOnce(usize) -> Result<Merl, E>,
    ) -> Result<Reflection, E> {
        Ok(match self {
            Self::Merl { table: view } => Reflection::Fixed(table(view)?.into()),
            Self::Lambert {} => Reflection::Diffuse,
            Self::Phong {
                diffuse,
                specular,
                exponent,
            } => Reflection::Fixed(brdf::Brdf::from(brdf::Phong {
                diffuse: diffuse.into(),
                specular: specular.into(),
                exponent,
            })),
            Self::Ggx {
                metallic,
                roughness,
            } => Reflection::MetallicRoughness {
                metallic,
                roughness,
            },
        })
    }

    /// As it was, if its numbers are in their ranges.
    pub fn checked(self) -> Result<Self, String> {
        let whole = match self {
            Self::Lambert {} | Self::Merl { .. } => true,
            Self::Phong {
                diffuse,
                specular,
                exponent,
            } => {
                let colours = diffuse.iter().chain(&specular);
                colours.into_iter().all(|x| (0.0..=1.0).contains(x))
                    && (0.0..=1e6).contains(&exponent)
            }
            Self::Ggx {
                metallic,
                roughness,
            } => [metallic, roughness]
                .iter()
                .all(|x| (0.0..=1.0).contains(x)),
        };
        match whole {
            true => Ok(self),
            false => Err("has a brdf with a number out of its range".to_owned()),
        }
    }
}
