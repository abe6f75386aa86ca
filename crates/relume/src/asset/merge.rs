//! Giving meshes back what the extension says of them and glTF cannot.
//!
//! In a glTF every primitive is a mesh of its own to Relume. Where the extension says that primitives share their vertices
//! (`sameAs`), they become one mesh with several groups of triangles again, so that vertices count once.

use std::collections::BTreeMap;

use super::AssetError;
use super::header::Primitive;
use crate::scene::{Instance, Mesh, Scene};

/// What a mesh is made of; instances of equal recipes share it.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Recipe {
    /// The meshes of the primitives, which have equal vertices.
    meshes: Vec<usize>,
    input_vertices: usize,
}

/// Merges primitives that share their vertices, and sets input vertices. `entries` has one item per instance, and the
/// counts in them have been checked.
pub fn apply(scene: &mut Scene, entries: &[Primitive]) -> Result<(), AssetError> {
    let as_it_is = |(instance, entry): (&Instance, &Primitive)| {
        let inputs = scene.meshes[instance.mesh].input_vertices;
        entry.same_as.is_none() && entry.input_vertices == Some(inputs)
    };
    if scene.instances.iter().zip(entries).all(as_it_is) {
        return Ok(());
    }
    let old = std::mem::take(&mut scene.meshes);
    let mut instances = std::mem::take(&mut scene.instances);
    let mut made: BTreeMap<Recipe, usize> = BTreeMap::new();
    let mut at = 0;
    while at < instances.len() {
        let end = at + run(&instances[at..], &entries[at..])?;
        let recipe = Recipe {
            meshes: instances[at..end].iter().map(|i| i.mesh).collect(),
            input_vertices: entries[at].input_vertices.unwrap_or(0),
        };
        let mesh = match made.get(&recipe) {
            Some(&mesh) => mesh,
            None => {
                let mesh = make(&old, &recipe, &instances[at])?;
                scene.meshes.push(mesh);
                scene.meshes.len() - 1
            }
        };
        made.insert(recipe, mesh);
        instances[at].mesh = mesh;
        scene.instances.push(instances[at].clone());
        at = end;
    }
    Ok(())
}

/// How many instances, from the first, share the vertices of the first.
fn run(instances: &[Instance], entries: &[Primitive]) -> Result<usize, AssetError> {
    let Instance {
        node, primitive, ..
    } = instances[0];
    if entries[0].same_as.is_some() {
        return Err(wrong(
            node,
            "shares the vertices of a primitive without triangles",
        ));
    }
    let rest = instances.iter().zip(entries).skip(1);
    let shared = rest.take_while(|(i, entry)| i.node == node && entry.same_as == Some(primitive));
    Ok(1 + shared.count())
}

fn make(old: &[Mesh], recipe: &Recipe, instance: &Instance) -> Result<Mesh, AssetError> {
    let mut mesh = old[recipe.meshes[0]].clone();
    mesh.input_vertices = recipe.input_vertices;
    for &other in &recipe.meshes[1..] {
        let other = &old[other];
        let equal = mesh.positions == other.positions
            && mesh.normals == other.normals
            && (mesh.uvs == other.uvs || mesh.uvs.is_empty() || other.uvs.is_empty())
            && (mesh.tangents == other.tangents
                || mesh.tangents.is_empty()
                || other.tangents.is_empty())
            && mesh.colors == other.colors
            && mesh.alphas == other.alphas;
        if !equal {
            return Err(wrong(instance.node, "calls vertices the same that differ"));
        }
        // Imported are only the coordinates of textures that are read: not every material need have one.
        if mesh.uvs.is_empty() {
            mesh.uvs.clone_from(&other.uvs);
        }
        if mesh.tangents.is_empty() {
            mesh.tangents.clone_from(&other.tangents);
        }
        mesh.groups.extend(other.groups.iter().cloned());
    }
    if recipe.meshes.len() > 1 {
        // The importer counts the primitives of a mesh in their names.
        let count = format!(", primitive {}", instance.primitive);
        mesh.name = mesh.name.trim_end_matches(&count).to_owned();
    }
    Ok(mesh)
}

fn wrong(node: usize, what: &str) -> AssetError {
    AssetError::Transfer {
        node,
        what: what.to_owned(),
    }
}
