//! How all surfaces of a scene reflect, in the JSON of `RELUME_transfer`.

use serde::{Deserialize, Serialize};

use crate::basis::Order;
use crate::brdf::{self, MERL_ENTRIES, Merl, Reflection, Tile, TileShape};

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
    /// A tile: the buffer view of its values `[height][width][views][views][3][order²]`, repeated so often.
    Tile {
        table: usize,
        width: usize,
        height: usize,
        views: usize,
        order: usize,
        repeat: f32,
    },
}

impl Brdf {
    /// `None` for what a header cannot hold; `table` is the buffer view of its table, if it has one.
    pub fn of(reflection: &Reflection, table: Option<usize>) -> Option<Self> {
        match reflection {
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
            Reflection::Fixed(brdf::Brdf::Measured(_)) => table.map(|table| Self::Merl { table }),
            Reflection::Fixed(_) => None,
            Reflection::Tile { tile, repeat } => table.map(|table| {
                let shape = tile.shape();
                Self::Tile {
                    table,
                    width: shape.width,
                    height: shape.height,
                    views: shape.views,
                    order: shape.order.get(),
                    repeat: *repeat,
                }
            }),
        }
    }

    /// The reflection; `triples` reads so many of them out of a buffer view. Otherwise what "RELUME_transfer" has instead.
    pub fn reflection(
        self,
        triples: impl FnOnce(usize, usize) -> Result<Vec<[f32; 3]>, String>,
    ) -> Result<Reflection, String> {
        let triples = |view, count| {
            triples(view, count).map_err(|what| format!("has a brdf whose table {what}"))
        };
        Ok(match self {
            Self::Merl { table } => {
                let merl = Merl::from_values(triples(table, MERL_ENTRIES)?);
                Reflection::Fixed(merl.map_err(|what| format!("has {what}"))?.into())
            }
            Self::Tile {
                table,
                width,
                height,
                views,
                order,
                repeat,
            } => {
                let wrong = |what: String| format!("has a tile that is none: {what}");
                let shape = TileShape {
                    width,
                    height,
                    views,
                    order: Order::new(order).map_err(|e| wrong(e.to_string()))?,
                };
                let shape = shape.checked().map_err(|e| wrong(e.to_string()))?;
                let values = triples(table, shape.count() / 3)?.into_flattened();
                let tile = Tile::new(shape, values).map_err(|e| wrong(e.to_string()))?;
                Reflection::Tile {
                    tile: tile.into(),
                    repeat,
                }
            }
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
            Self::Tile { repeat, .. } => (1e-3..=1e6).contains(&repeat),
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
