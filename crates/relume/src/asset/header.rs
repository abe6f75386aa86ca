//! The JSON of the extension `RELUME_transfer` (docs/format.md).

mod brdf;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{Precision, Provenance, Transfer, TransferKind};
use crate::basis::Order;

pub use brdf::Brdf;

/// Name of the extension.
pub const NAME: &str = "RELUME_transfer";
/// The version this code writes, and the highest it reads.
pub const VERSION: u64 = 1;
/// Numbers above this are not exact in every JSON reader, so seeds above it are strings.
const EXACT: u64 = 1 << 53;

/// The tokens that say how coefficients are to be understood. One value each as yet, but for the precision; a reader refuses others.
pub fn tokens(precision: Precision) -> [(&'static str, &'static str); 6] {
    [
        ("basis", "sh"),
        ("convention", CONVENTION),
        ("quantity", QUANTITY),
        ("colour", "linear-rec709"),
        ("precision", precision.token()),
        ("frame", "scene"),
    ]
}

/// Real, orthonormal, no Condon–Shortley phase, index l(l+1)+m.
pub const CONVENTION: &str = "real-no-cs";
/// Transferred irradiance divided by π, without the receiver's own albedo.
pub const QUANTITY: &str = "irradiance-over-pi";

/// What one node says, but for the tokens.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Header {
    order: usize,
    channels: usize,
    kind: String,
    bounces: u32,
    samples: u32,
    seed: Value,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    albedo: Option<[f32; 3]>,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    source: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    error: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    tracer: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    bake: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    transfer_order: Option<usize>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    brdf: Option<Brdf>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    bin: Option<Beside>,
}

/// The file beside the `.glb` that holds the transfer: buffer 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Beside {
    /// Its length.
    pub byte_length: u64,
    /// CRC-32 of all of it, eight hex digits.
    pub crc32: String,
}

/// One glTF primitive's transfer.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Primitive {
    /// An earlier primitive whose vertices and transfer this one shares; then nothing else stands here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub same_as: Option<usize>,
    /// Vertices, as many as the primitive's POSITION has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<usize>,
    /// How many of them came from the source; the rest were added by tessellation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub input_vertices: Option<usize>,
    /// Buffer view of the coefficients.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub transfer: Option<usize>,
    /// Buffer view of the transfer matrices, where the header has a transfer order.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub matrices: Option<usize>,
    /// Buffer view of one byte per vertex; absent when all are valid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub valid: Option<usize>,
    /// Transfer of back sides.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub back: Option<Back>,
}

/// Transfer of the back sides of some vertices.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Back {
    /// How many.
    pub count: usize,
    /// Buffer view of their indices within the primitive, u32, ascending.
    pub vertices: usize,
    /// Buffer view of their coefficients.
    pub transfer: usize,
    /// Buffer view of their transfer matrices, where the header has a transfer order.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub matrices: Option<usize>,
}

/// What a header says of the whole transfer: everything but its arrays.
#[derive(Clone, Debug, PartialEq)]
pub struct Meaning {
    pub order: Order,
    pub channels: usize,
    pub kind: TransferKind,
    pub samples: u32,
    pub seed: u64,
    pub made: Provenance,
    pub precision: Precision,
    /// Linear albedo of everything, in place of base colours, textures and vertex colours.
    pub albedo: Option<[f32; 3]>,
    /// SHA-256 of the source in hex; empty when unknown.
    pub source_hash: String,
    /// Order of transferred radiance, where there are matrices.
    pub transfer_order: Option<Order>,
    /// How all surfaces reflect, in place of what materials say.
    pub brdf: Option<Brdf>,
    /// Where the transfer lies if it is not in the file itself.
    pub beside: Option<Beside>,
}

impl Meaning {
    /// What `transfer` means.
    pub fn of(transfer: &Transfer, source_hash: &str, albedo: Option<[f32; 3]>) -> Self {
        Self {
            order: transfer.order,
            channels: transfer.channels,
            kind: transfer.kind,
            samples: transfer.samples,
            seed: transfer.seed,
            made: transfer.made.clone(),
            precision: transfer.precision,
            albedo,
            source_hash: source_hash.to_owned(),
            transfer_order: transfer.matrices.as_ref().map(|matrices| matrices.order),
            brdf: None,
            beside: None,
        }
    }
}

/// The extension's JSON.
pub fn to_json(meaning: &Meaning, primitives: &[Primitive]) -> Value {
    let (kind, bounces) = kind(meaning.kind);
    let header = Header {
        order: meaning.order.get(),
        channels: meaning.channels,
        kind: kind.to_owned(),
        bounces,
        samples: meaning.samples,
        seed: match meaning.seed {
            exact @ ..=EXACT => exact.into(),
            large => large.to_string().into(),
        },
        albedo: meaning.albedo,
        source: match meaning.source_hash.as_str() {
            "" => String::new(),
            hash => format!("sha256:{hash}"),
        },
        error: meaning.made.error,
        tracer: meaning.made.tracer.clone(),
        bake: meaning
            .made
            .bake
            .as_ref()
            .map(|hash| format!("sha256:{hash}")),
        transfer_order: meaning.transfer_order.map(Order::get),
        brdf: meaning.brdf,
        bin: meaning.beside.clone(),
    };
    let mut json = serde_json::Map::new();
    json.insert("version".to_owned(), VERSION.into());
    for (key, token) in tokens(meaning.precision) {
        json.insert(key.to_owned(), token.into());
    }
    let mut header = serde_json::json!(header);
    json.append(header.as_object_mut().expect("a struct is an object"));
    json.insert("generator".to_owned(), generator().into());
    json.insert("primitives".to_owned(), serde_json::json!(primitives));
    Value::Object(json)
}

/// The token of a kind, and how many bounces.
pub fn kind(kind: TransferKind) -> (&'static str, u32) {
    match kind {
        TransferKind::Unshadowed => ("unshadowed", 0),
        TransferKind::Shadowed { bounces } => ("shadowed", bounces),
    }
}

/// Who wrote the file.
pub fn generator() -> String {
    format!("relume {}", env!("CARGO_PKG_VERSION"))
}

/// Why the JSON of an extension is not understood.
#[derive(Debug)]
pub enum HeaderError {
    /// Of a version to come.
    Newer(u64),
    /// Anything else, as the end of "RELUME_transfer …".
    Wrong(String),
}

/// Reads the extension's JSON; every token, count and kind is checked.
pub fn from_json(json: &Value) -> Result<(Meaning, Vec<Primitive>), HeaderError> {
    let wrong = |what: String| HeaderError::Wrong(what);
    match json.get("version").and_then(Value::as_u64) {
        Some(VERSION) => {}
        Some(newer) if newer > VERSION => return Err(HeaderError::Newer(newer)),
        _ => return Err(wrong("has no version that is known".to_owned())),
    }
    let precision = precision(json).map_err(wrong)?;
    let header = Header::deserialize(json).map_err(|e| wrong(format!("has {}", shown(&e))))?;
    let primitives = json.get("primitives").unwrap_or(&Value::Null);
    let primitives = Vec::deserialize(primitives);
    let primitives = primitives.map_err(|e| wrong(format!("has primitives with {}", shown(&e))))?;
    Ok((header.meaning(precision).map_err(wrong)?, primitives))
}

/// The precision, once every token is known.
fn precision(json: &Value) -> Result<Precision, String> {
    let all = Precision::ALL;
    let named = all.into_iter().find(|p| json["precision"] == p.token());
    for (key, token) in tokens(named.unwrap_or_default()) {
        let found = json.get(key).unwrap_or(&Value::Null);
        if found != token {
            let known = match key {
                "precision" => all.map(Precision::token).join("\" or \""),
                _ => token.to_owned(),
            };
            return Err(format!("has {key} {}, not \"{known}\"", shown(found)));
        }
    }
    Ok(named.unwrap_or_default())
}

impl Header {
    fn meaning(&self, precision: Precision) -> Result<Meaning, String> {
        let order = Order::new(self.order).map_err(|e| format!("has an impossible order: {e}"))?;
        if !matches!(self.channels, 1 | 3) {
            return Err(format!("has {} channels, not 1 or 3", self.channels));
        }
        let kind = match (self.kind.as_str(), self.bounces) {
            ("unshadowed", 0) => TransferKind::Unshadowed,
            ("shadowed", bounces) => TransferKind::Shadowed { bounces },
            (other, bounces) => {
                let other = shown(&Value::from(other));
                return Err(format!("has kind {other} with {bounces} bounces"));
            }
        };
        let seed = match &self.seed {
            Value::String(text) => text.parse().ok(),
            number => number.as_u64(),
        };
        let hash = hash_of(&self.source).ok_or("has a source that is no sha256")?;
        let bake = self.bake.as_deref().unwrap_or_default();
        let bake = hash_of(bake).ok_or("has a bake that is no sha256")?;
        if !self.error.is_none_or(|error| error > 0.0 && error < 1.0) {
            return Err("has an error outside 0…1".to_owned());
        }
        let inside = |albedo: [f32; 3]| albedo.iter().all(|a| (0.0..=1.0).contains(a));
        if !self.albedo.is_none_or(inside) {
            return Err("has an albedo outside 0…1".to_owned());
        }
        let transfer_order = self.transfer_order.map(Order::new).transpose();
        let whole = |beside: &Beside| beside.crc32.len() == 8 && beside.crc32.bytes().all(is_hex);
        if !self.bin.as_ref().is_none_or(whole) {
            return Err("has a bin without a crc32".to_owned());
        }
        Ok(Meaning {
            order,
            channels: self.channels,
            kind,
            samples: self.samples,
            seed: seed.ok_or_else(|| format!("has seed {}", shown(&self.seed)))?,
            made: Provenance {
                error: self.error,
                tracer: self.tracer.as_deref().map(crate::files::printable),
                bake: Some(bake.to_owned()).filter(|hash| !hash.is_empty()),
            },
            precision,
            albedo: self.albedo,
            source_hash: hash.to_owned(),
            transfer_order: transfer_order
                .map_err(|e| format!("has an impossible transferOrder: {e}"))?,
            brdf: self.brdf.map(Brdf::checked).transpose()?,
            beside: self.bin.clone(),
        })
    }
}

/// The digits of `sha256:…`; none where nothing stands.
fn hash_of(text: &str) -> Option<&str> {
    match text.strip_prefix("sha256:") {
        _ if text.is_empty() => Some(""),
        Some(hash) if hash.len() == 64 && hash.bytes().all(is_hex) => Some(hash),
        _ => None,
    }
}

fn is_hex(byte: u8) -> bool {
    matches!(byte, b'0'..=b'9' | b'a'..=b'f')
}

/// A value or a complaint about one, fit for one line.
fn shown(value: &impl ToString) -> String {
    crate::files::printable(&value.to_string().chars().take(80).collect::<String>())
}

#[cfg(test)]
mod tests;
