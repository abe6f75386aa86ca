//! Asset in, `.glb` out.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::{Value, json};

use super::builder::{Builder, array, malformed, object};
use super::container::{self, Container, Part};
use super::header::{self, Back, Beside, Meaning, Primitive};
use super::{Asset, AssetError, Precision, Transfer, beside, fresh, tables, tessellated};
use crate::files::{Rows, write_atomically, write_both_atomically};
use crate::scene::{Instance, Scene};

/// The most bytes a `.glb` can have.
const LIMIT: u64 = u32::MAX as u64;

/// Writes `asset` as a `.glb`: whole or not at all, without a second copy of the transfer in memory.
///
/// Where a `.glb` of 4 GiB would not hold it, the transfer goes to `<name>.bin` beside it, unless a file stands there that is none of
/// Relume's. An older one of ours is removed when the new asset needs none.
///
/// A scene that came from glTF comes back with its JSON and its binary chunk as they were, plus `RELUME_transfer` on every node that has
/// a mesh (docs/format.md); any other becomes a minimal glTF. Refuses, before it touches the disk, more than a `.glb` can hold and
/// what glTF cannot say ([`predicted_size`] refuses the same before a bake). Whether `path` is the input is the caller's to judge:
/// [`same_file`].
pub fn write(asset: &Asset, path: &Path) -> Result<(), AssetError> {
    write_within(asset, path, LIMIT).map_err(|error| error.of(path))
}

/// [`write()`] with another limit to what the `.glb` may hold: for tests.
pub(super) fn write_within(asset: &Asset, path: &Path, limit: u64) -> Result<(), AssetError> {
    match plan(asset, None)?.finish() {
        Ok(container) if container.len() as u64 <= limit => {
            write_atomically(path, |writer| container.write(writer))?;
            beside::forget(path);
            Ok(())
        }
        Ok(_) | Err(AssetError::TooLarge(_)) => write_apart(asset, path),
        Err(error) => Err(error),
    }
}

/// Writes the transfer into a file of its own.
fn write_apart(asset: &Asset, path: &Path) -> Result<(), AssetError> {
    let uri = beside::uri(path)?;
    beside::check_free(path)?;
    let mut builder = plan(asset, Some(uri))?;
    let (json, bin, transfer) = builder.close()?;
    let length = container::total(json.len(), bin.len());
    if length > LIMIT {
        return Err(AssetError::SceneTooLarge(length));
    }
    write_both_atomically(
        &beside::path(path),
        |writer| beside::write(&transfer, writer),
        path,
        |crc, writer| {
            // As long as what stood in its place.
            set_crc(&mut builder.json, &crc);
            let json = serde_json::to_vec(&builder.json)?;
            let container = Container::new(json, bin).map_err(std::io::Error::other)?;
            container.write(writer)
        },
    )?;
    Ok(())
}

/// Puts the hash of the file beside into every header.
fn set_crc(json: &mut Value, crc: &str) {
    let nodes = json.get_mut("nodes").and_then(Value::as_array_mut);
    for node in nodes.into_iter().flatten() {
        let extension = node
            .get_mut("extensions")
            .and_then(|e| e.get_mut(header::NAME));
        if let Some(header) = extension.and_then(|extension| extension.get_mut("bin")) {
            header["crc32"] = crc.into();
        }
    }
}

/// The bytes that [`write()`] writes.
pub fn to_glb(asset: &Asset) -> Result<Vec<u8>, AssetError> {
    let container = plan(asset, None)?.finish()?;
    let mut bytes = Vec::with_capacity(container.len());
    container.write(&mut bytes)?;
    Ok(bytes)
}

/// An upper bound, close, of the size in bytes of the `.glb` that a bake of `scene` will become with so many numbers of transfer on each side
/// of a vertex, in `precision`, together with the `.bin` beside it if there will be one ([`check_place`]).
///
/// Fails for every reason in the scene that would make [`write()`] fail, so that nobody bakes for an hour what cannot be written.
pub fn predicted_size(
    scene: &Scene,
    numbers: usize,
    precision: Precision,
) -> Result<u64, AssetError> {
    // Room for what the extension says of a node, and of a primitive with its views.
    const NODE: u64 = 640;
    const PRIMITIVE: u64 = 640;
    // And of a file beside it with a name of 255 bytes.
    const BESIDE: u64 = 1024;
    check_scene(scene)?;
    let vector = (precision.bytes() * numbers) as u64;
    let alone = scene_alone(scene)?.finish().map_err(|error| match error {
        AssetError::TooLarge(bytes) => AssetError::SceneTooLarge(bytes),
        other => other,
    })?;
    let mut bytes = alone.len() as u64;
    let mut transfer = tables::bytes(scene);
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        let vertices = mesh.positions.len() as u64;
        let backs = double_sided_vertices(scene, instance);
        bytes += NODE + PRIMITIVE * mesh.groups.len().max(1) as u64;
        transfer += vertices * (vector + 1) + backs * (vector + 4);
    }
    if bytes + transfer > LIMIT {
        bytes += BESIDE;
    }
    if bytes > LIMIT {
        return Err(AssetError::SceneTooLarge(bytes));
    }
    Ok(bytes + transfer)
}

/// Refuses a place where an asset of `bytes` bytes ([`predicted_size`]) cannot be written: where its transfer needs a `.bin` beside it, and a
/// file stands there that is none of Relume's.
pub fn check_place(path: &Path, bytes: u64) -> Result<(), AssetError> {
    if bytes <= LIMIT {
        return Ok(());
    }
    let free = beside::uri(path).and_then(|_| beside::check_free(path));
    free.map_err(|error| error.of(path))
}

/// Whether two paths lead to the same existing file, links resolved.
pub fn same_file(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    }
}

fn double_sided_vertices(scene: &Scene, instance: &Instance) -> u64 {
    let mesh = &scene.meshes[instance.mesh];
    let mut seen = vec![false; mesh.positions.len()];
    let groups = mesh.groups.iter();
    for group in groups.filter(|g| scene.materials[g.material].double_sided) {
        for &i in group.triangles.as_flattened() {
            seen[i as usize] = true;
        }
    }
    seen.into_iter().filter(|&seen| seen).count() as u64
}

/// The document without transfer.
fn scene_alone(scene: &Scene) -> Result<Builder<'_>, AssetError> {
    let Some(document) = &scene.document else {
        return fresh::build(scene);
    };
    let mut builder = Builder::of(document)?;
    tessellated::replace(&mut builder, scene)?;
    Ok(builder)
}

/// The document with its transfer; in a file of its own, if that has a URI.
fn plan(asset: &Asset, beside: Option<String>) -> Result<Builder<'_>, AssetError> {
    check_scene(&asset.scene)?;
    check(asset)?;
    let Asset { scene, transfer } = asset;
    let mut builder = scene_alone(scene)?;
    if let Some(uri) = beside {
        builder.put_transfer_beside(uri);
    }
    let entries = entries(&mut builder, asset)?;
    if let Some(gather) = &transfer.gather {
        gather.put(&mut builder)?;
    }
    let mut meaning = Meaning::of(transfer, &scene.source_hash, scene.albedo_override);
    meaning.brdf = tables::put(&mut builder, scene)?;
    meaning.beside = builder.beside().map(|bin| Beside {
        byte_length: bin.len(),
        // Not known before it is written.
        crc32: "0".repeat(8),
    });
    for (node, primitives) in entries {
        let json = header::to_json(&meaning, &primitives);
        let node = object(&mut builder.array("nodes")?[node], "a node")?;
        let extensions = node.entry("extensions").or_insert_with(|| json!({}));
        object(extensions, "extensions")?.insert(header::NAME.to_owned(), json);
    }
    builder.array("extensionsUsed")?.push(header::NAME.into());
    Ok(builder)
}

/// What the extension of each node says of its primitives; their arrays are added.
fn entries<'a>(
    builder: &mut Builder<'a>,
    asset: &'a Asset,
) -> Result<BTreeMap<usize, Vec<Primitive>>, AssetError> {
    let Asset { scene, transfer } = asset;
    let mut nodes: BTreeMap<usize, Vec<Primitive>> = BTreeMap::new();
    let mut first = 0;
    for (i, instance) in scene.instances.iter().enumerate() {
        let mesh = &scene.meshes[instance.mesh];
        let (node, start, run) = match &scene.document {
            Some(_) => (instance.node, instance.primitive, mesh.groups.len().max(1)),
            None => (i, 0, fresh::groups(mesh).count()),
        };
        let places = primitives(builder, node)?.len();
        let entries = nodes.entry(node).or_default();
        entries.resize_with(places, Primitive::default);
        let run = start..start + run;
        let free = entries.get(run.clone());
        if !free.is_some_and(|free| free.iter().all(|e| *e == Primitive::default())) {
            return Err(malformed("two instances stand for the same primitive"));
        }
        let last = first + mesh.positions.len();
        entries[run].fill(Primitive {
            same_as: Some(start),
            ..Primitive::default()
        });
        entries[start] = Primitive {
            input_vertices: Some(mesh.input_vertices),
            ..entry(builder, transfer, first..last)?
        };
        first = last;
    }
    Ok(nodes)
}

/// The primitives of the mesh of a node.
fn primitives<'b>(builder: &'b mut Builder<'_>, node: usize) -> Result<&'b [Value], AssetError> {
    let node = builder.json["nodes"].get(node);
    let mesh = node.and_then(|node| node["mesh"].as_u64());
    let mesh = mesh.ok_or_else(|| malformed("an instance names no node with a mesh"))?;
    let mesh = array(&mut builder.json, "meshes")?.get_mut(mesh as usize);
    let mesh = mesh.ok_or_else(|| malformed("a node names no mesh"))?;
    Ok(array(mesh, "primitives")?)
}

/// Adds the arrays of a run of vertices; returns what the extension says of them.
fn entry<'a>(
    builder: &mut Builder<'a>,
    transfer: &'a Transfer,
    vertices: std::ops::Range<usize>,
) -> Result<Primitive, AssetError> {
    let stride = transfer.stride();
    let part = |floats| Part::coefficients(floats, transfer.precision);
    let floats = &transfer.coefficients[vertices.start * stride..vertices.end * stride];
    let valid = &transfer.valid[vertices.clone()];
    let matrices = transfer.matrices.as_ref();
    let size = transfer.matrix_stride();
    let mut entry = Primitive {
        count: Some(vertices.len()),
        transfer: Some(builder.transfer_view(part(floats))?),
        matrices: matrices
            .map(|all| &all.coefficients[vertices.start * size..vertices.end * size])
            .map(|floats| builder.transfer_view(part(floats)))
            .transpose()?,
        ..Primitive::default()
    };
    if !valid.iter().all(|&valid| valid) {
        let bytes: &[u8] = bytemuck::cast_slice(valid);
        entry.valid = Some(builder.transfer_view(Part::Bytes(bytes.into()))?);
    }
    let Some(back) = &transfer.back else {
        return Ok(entry);
    };
    let place = |vertex: usize| back.vertices.partition_point(|&v| (v as usize) < vertex);
    let (from, to) = (place(vertices.start), place(vertices.end));
    if from < to {
        let local = back.vertices[from..to]
            .iter()
            .map(|v| v - vertices.start as u32);
        let local: Vec<u8> = local.flat_map(u32::to_le_bytes).collect();
        let floats = &back.coefficients[from * stride..to * stride];
        entry.back = Some(Back {
            count: to - from,
            vertices: builder.transfer_view(Part::Bytes(local.into()))?,
            transfer: builder.transfer_view(part(floats))?,
            matrices: matrices
                .map(|all| &all.back[from * size..to * size])
                .map(|floats| builder.transfer_view(part(floats)))
                .transpose()?,
        });
    }
    Ok(entry)
}

/// Whether every index of a scene names something.
fn check_scene(scene: &Scene) -> Result<(), AssetError> {
    let materials = scene.materials.len();
    for (i, instance) in scene.instances.iter().enumerate() {
        let whole = scene.meshes.get(instance.mesh).is_some_and(|mesh| {
            let vertices = mesh.positions.len();
            mesh.groups.iter().all(|group| group.material < materials)
                && mesh.triangles().flatten().all(|v| (v as usize) < vertices)
        });
        if !whole {
            let what = "names a mesh, material or vertex that is not there; repair the scene";
            return Err(AssetError::Unwritable(format!("instance {i} {what}")));
        }
    }
    Ok(())
}

/// Whether every array of the transfer has the length it must have, and every number is one.
fn check(asset: &Asset) -> Result<(), AssetError> {
    let Asset { scene, transfer } = asset;
    let wrong = |what: String| Err(AssetError::Mismatch(what));
    let (vertices, vectors) = (scene.vertex_count(), transfer.vertex_count());
    if vertices != vectors {
        return wrong(format!(
            "{vectors} transfer vectors for {vertices} vertices"
        ));
    }
    if !matches!(transfer.channels, 1 | 3) {
        return wrong(format!("{} channels, not 1 or 3", transfer.channels));
    }
    let stride = transfer.stride();
    let no_back = super::BackTransfer {
        vertices: Vec::new(),
        coefficients: Rows::default(),
    };
    let back = transfer.back.as_ref().unwrap_or(&no_back);
    if transfer.coefficients.len() != vertices * stride
        || back.coefficients.len() != back.vertices.len() * stride
    {
        return wrong("its number of coefficients is not vertices · channels · order²".into());
    }
    let size = transfer.matrix_stride();
    let (fronts, backs) = match &transfer.matrices {
        Some(all) => (&*all.coefficients, &*all.back),
        None => Default::default(),
    };
    if fronts.len() != vertices * size || backs.len() != back.vertices.len() * size {
        return wrong("its transfer matrices are not one for each side".into());
    }
    let ascending = back.vertices.is_sorted_by(|a, b| a < b);
    if !ascending
        || back
            .vertices
            .last()
            .is_some_and(|&v| v as usize >= vertices)
    {
        return wrong("its back sides do not name ascending vertices".into());
    }
    if let Some(gather) = &transfer.gather {
        gather
            .check(vertices + back.vertices.len())
            .map_err(AssetError::Mismatch)?;
    }
    let all = transfer.coefficients.iter().chain(&*back.coefficients);
    let all = all.chain(fronts).chain(backs);
    all.enumerate()
        .try_for_each(|(i, &value)| check_number(i, value, transfer.precision))
}

/// Whether coefficient `i` is a number, and one that a file of this precision gives back as it is.
fn check_number(i: usize, value: f32, precision: Precision) -> Result<(), AssetError> {
    if !value.is_finite() {
        let what = format!("coefficient {i} is not finite");
        return Err(AssetError::Mismatch(what));
    }
    let mut stored = [value];
    precision.round(&mut stored)?;
    // Bits, because the two zeros are equal.
    if stored[0].to_bits() != value.to_bits() {
        return Err(AssetError::Unwritable(format!(
            "coefficient {i} of the transfer is {value}, which is no half float; round it with Transfer::to_precision"
        )));
    }
    Ok(())
}
