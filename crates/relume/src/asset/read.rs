//! `.glb` in, asset out.

use std::path::Path;

use serde_json::Value;

use super::header::{self, HeaderError, Meaning, Primitive};
use super::{Asset, AssetError, beside, container, merge, strip, views};
use super::{BackTransfer, Gather, Matrices, Transfer};
use crate::files::{Rows, printable};
use crate::scene::gltf::{self, Maps};
use crate::scene::{Instance, Scene};
use beside::Source;
use views::{Bytes, Views};

/// Reads a baked `.glb`, and the `.bin` beside it where that holds the transfer.
///
/// The scene's document is the one that was baked, without the transfer, so that writing the asset again gives the same bytes. Every
/// length, token and number is checked; errors name the file.
pub fn read(path: &Path) -> Result<Asset, AssetError> {
    bytes(path)
        .and_then(|bytes| from_bytes(&bytes, Some(path)))
        .map_err(|error| error.of(path))
}

/// The content of a regular file that is not longer than a `.glb` can be.
fn bytes(path: &Path) -> Result<Vec<u8>, AssetError> {
    let metadata = std::fs::metadata(path)?;
    if !metadata.is_file() {
        return Err(AssetError::Container("it is no regular file".to_owned()));
    }
    if metadata.len() > u64::from(u32::MAX) {
        return Err(AssetError::Container("it is longer than 4 GiB".to_owned()));
    }
    Ok(std::fs::read(path)?)
}

/// [`read`] from memory; refuses an asset whose transfer is not in it.
pub fn from_glb(bytes: &[u8]) -> Result<Asset, AssetError> {
    from_bytes(bytes, None)
}

fn from_bytes(bytes: &[u8], path: Option<&Path>) -> Result<Asset, AssetError> {
    let (json, bin) = container::split(bytes)?;
    let json: Value = serde_json::from_slice(json)
        .map_err(|error| AssetError::Container(format!("its JSON is damaged: {error}")))?;
    // Before the scene is read: without transfer there is no point.
    if !nodes(&json).any(|node| extension(node).is_some()) {
        return Err(AssetError::NoTransfer);
    }
    let glossy = nodes(&json)
        .filter_map(extension)
        .any(|header| !header["transferOrder"].is_null());
    let maps = if glossy { Maps::All } else { Maps::Color };
    assemble(&json, bin, gltf::with_maps(bytes, maps)?, path)
}

fn nodes(json: &Value) -> impl Iterator<Item = &Value> {
    json["nodes"].as_array().into_iter().flatten()
}

fn extension(node: &Value) -> Option<&Value> {
    node["extensions"].get(header::NAME)
}

/// Joins the scene of a file with the transfer in its JSON and binary chunk, or beside `path`.
fn assemble(
    json: &Value,
    bin: &[u8],
    mut scene: Scene,
    path: Option<&Path>,
) -> Result<Asset, AssetError> {
    let headers = headers(json, &scene)?;
    let Some((first, (meaning, _))) = headers.iter().flatten().next() else {
        return Err(AssetError::NoTransfer);
    };
    let meaning = meaning.clone();
    let mut gathered = Gathered::new(
        &meaning,
        Views::new(json, bytes_of(&meaning, json, bin, path)?),
    );
    let mut entries = Vec::with_capacity(scene.instances.len());
    for instance in &scene.instances {
        let entry = entry_of(&headers, instance, &meaning)?;
        if entry.same_as.is_none() {
            let vertices = scene.meshes[instance.mesh].positions.len();
            gathered.add(instance, entry, vertices)?;
        }
        entries.push(entry.clone());
    }
    let reflection = meaning
        .brdf
        .map(|brdf| brdf.reflection(|table, count| gathered.views.triples(table, count)));
    let reflection = reflection
        .transpose()
        .map_err(|what| wrong(*first, &what))?;
    let transfer = gathered.finish(json)?;
    merge::apply(&mut scene, &entries)?;
    if let Some(document) = &mut scene.document {
        let length = strip::strip(&mut document.json, document.bin.len());
        document.bin.truncate(length);
        document.bin.shrink_to_fit();
    }
    if let Some(albedo) = meaning.albedo {
        crate::scene::override_albedo(&mut scene, albedo)?;
    }
    if let Some(reflection) = reflection {
        crate::scene::override_reflection(&mut scene, reflection);
    }
    scene.source_hash = meaning.source_hash;
    Ok(Asset { scene, transfer })
}

/// Where the transfer lies.
fn bytes_of<'a>(
    meaning: &Meaning,
    json: &Value,
    bin: &'a [u8],
    path: Option<&Path>,
) -> Result<Bytes<'a>, AssetError> {
    match (&meaning.beside, path) {
        (None, _) => Ok(Bytes::Chunk(bin)),
        (Some(beside), Some(path)) => Ok(Bytes::File(Source::open(path, beside, json)?)),
        (Some(_), None) => {
            let uri = json["buffers"][1]["uri"].as_str().unwrap_or_default();
            Err(AssetError::Beside {
                name: printable(&uri.chars().take(200).collect::<String>()),
                what: "was not given: these are the bytes of the .glb alone".to_owned(),
            })
        }
    }
}

/// By node: the node and what its extension says.
type Headers = Vec<Option<(usize, (Meaning, Vec<Primitive>))>>;

/// The header of every node that an instance stands on, by node.
fn headers(json: &Value, scene: &Scene) -> Result<Headers, AssetError> {
    let mut headers: Headers = vec![None; nodes(json).count()];
    for node in scene.instances.iter().map(|instance| instance.node) {
        let place = headers.get_mut(node);
        let (Some(place), Some(json)) = (place, json["nodes"].get(node)) else {
            return Err(wrong(node, "stands on a node that is not there"));
        };
        if place.is_some() {
            continue;
        }
        if let Some(extension) = extension(json) {
            let header = header::from_json(extension).map_err(|error| match error {
                HeaderError::Newer(version) => AssetError::Newer(version),
                HeaderError::Wrong(what) => wrong(node, &what),
            })?;
            *place = Some((node, header));
        }
    }
    Ok(headers)
}

/// What the file says of an instance.
fn entry_of<'h>(
    headers: &'h Headers,
    instance: &Instance,
    meaning: &Meaning,
) -> Result<&'h Primitive, AssetError> {
    let Instance {
        node, primitive, ..
    } = *instance;
    let Some((_, (own, primitives))) = &headers[node] else {
        return Err(wrong(node, "is missing, though other nodes have it"));
    };
    if own != meaning {
        return Err(wrong(node, "has another header than other nodes"));
    }
    let entry = primitives.get(primitive);
    let known = entry.filter(|entry| entry.same_as.is_some() || entry.transfer.is_some());
    let what = || format!("has no transfer for primitive {primitive}");
    let entry = known.ok_or_else(|| wrong(node, &what()))?;
    if let Some(first) = entry.same_as {
        // Runs of primitives that share their vertices are whole: nothing else stands between.
        let run = primitives.get(first..primitive).unwrap_or_default();
        let rest = run.get(1..).unwrap_or_default();
        let whole = run.first().is_some_and(|e| e.transfer.is_some())
            && rest.iter().all(|e| e.same_as == Some(first));
        if !whole {
            let what = format!("lets primitive {primitive} share what primitive {first} has not");
            return Err(wrong(node, &what));
        }
    }
    Ok(entry)
}

fn wrong(node: usize, what: &str) -> AssetError {
    AssetError::Transfer {
        node,
        what: what.to_owned(),
    }
}

/// The transfer so far.
struct Gathered<'a> {
    views: Views<'a>,
    /// Everything but its arrays of coefficients.
    transfer: Transfer,
    coefficients: Vec<f32>,
    matrices: Vec<f32>,
    back_vertices: Vec<u32>,
    back_coefficients: Vec<f32>,
    back_matrices: Vec<f32>,
}

impl<'a> Gathered<'a> {
    fn new(meaning: &Meaning, views: Views<'a>) -> Self {
        Self {
            views,
            transfer: Transfer {
                order: meaning.order,
                channels: meaning.channels,
                kind: meaning.kind,
                samples: meaning.samples,
                seed: meaning.seed,
                made: meaning.made.clone(),
                precision: meaning.precision,
                coefficients: Rows::default(),
                valid: Vec::new(),
                back: None,
                gather: None,
                matrices: meaning.transfer_order.map(|order| Matrices {
                    order,
                    coefficients: Rows::default(),
                    back: Rows::default(),
                }),
            },
            coefficients: Vec::new(),
            matrices: Vec::new(),
            back_vertices: Vec::new(),
            back_coefficients: Vec::new(),
            back_matrices: Vec::new(),
        }
    }

    /// Appends one instance of `vertices` vertices.
    fn add(
        &mut self,
        instance: &Instance,
        entry: &Primitive,
        vertices: usize,
    ) -> Result<(), AssetError> {
        let fail = |what: String| {
            let what = format!("of primitive {} {what}", instance.primitive);
            wrong(instance.node, &what)
        };
        if entry.count != Some(vertices) {
            let count = entry.count.unwrap_or(0);
            let what = format!("counts {count} vertices, but there are {vertices}");
            return Err(fail(what));
        }
        if entry.input_vertices.is_none_or(|inputs| inputs > vertices) {
            return Err(fail("has a wrong inputVertices".to_owned()));
        }
        let (stride, precision) = (self.transfer.stride(), self.transfer.precision);
        let first = self.transfer.vertex_count();
        let view = entry.transfer.unwrap_or(usize::MAX);
        let views = &mut self.views;
        views
            .floats(view, (vertices, stride), precision, &mut self.coefficients)
            .map_err(fail)?;
        let size = self.transfer.matrix_stride();
        if size > 0 {
            let view = entry.matrices.unwrap_or(usize::MAX);
            views
                .floats(view, (vertices, size), precision, &mut self.matrices)
                .map_err(fail)?;
        }
        match entry.valid {
            Some(view) => views
                .flags(view, vertices, &mut self.transfer.valid)
                .map_err(fail)?,
            None => self.transfer.valid.resize(first + vertices, true),
        }
        if let Some(back) = &entry.back {
            let local = views
                .ascending(back.vertices, back.count, vertices)
                .map_err(fail)?;
            let offset = u32::try_from(first + vertices).map(|_| first as u32);
            let offset = offset.map_err(|_| fail("ends past 2³² vertices".to_owned()))?;
            self.back_vertices.extend(local.iter().map(|v| v + offset));
            views
                .floats(
                    back.transfer,
                    (back.count, stride),
                    precision,
                    &mut self.back_coefficients,
                )
                .map_err(fail)?;
            if size > 0 {
                let view = back.matrices.unwrap_or(usize::MAX);
                let places = &mut self.back_matrices;
                views
                    .floats(view, (back.count, size), precision, places)
                    .map_err(fail)?;
            }
        }
        Ok(())
    }

    fn finish(mut self, json: &Value) -> Result<Transfer, AssetError> {
        let sides = self.transfer.vertex_count() + self.back_vertices.len();
        let gather = Gather::take(json, &mut self.views, sides).map_err(AssetError::Gather)?;
        self.views.finish()?;
        let back = BackTransfer {
            vertices: self.back_vertices,
            coefficients: self.back_coefficients.into(),
        };
        let matrices = self.transfer.matrices.map(|all| Matrices {
            coefficients: self.matrices.into(),
            back: self.back_matrices.into(),
            ..all
        });
        Ok(Transfer {
            matrices,
            coefficients: self.coefficients.into(),
            back: Some(back).filter(|back| !back.vertices.is_empty()),
            gather,
            ..self.transfer
        })
    }
}
