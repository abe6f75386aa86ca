//! The node tree: which meshes stand where.

use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};

use super::super::SceneError;
use super::json::{Node, Root, get};

/// Largest number in the matrix of a transform: products of three still fit f64.
const MAX_SCALE: f64 = 1e100;

/// A node with a mesh, in depth-first order.
pub(super) struct Placed {
    pub(super) node: usize,
    pub(super) mesh: usize,
    pub(super) world_from_object: DAffine3,
}

/// Walks the default scene (scene 0 if none is named; every root node if there are no scenes) depth first.
///
/// Nodes with two parents and circles of nodes are refused. Also returns how many meshes were left out because their transform flattens them.
pub(super) fn walk(root: &Root) -> Result<(Vec<Placed>, usize), SceneError> {
    let parents = parents(root)?;
    let mut placed = Vec::new();
    let mut flat = 0;
    let mut pending = vec![];
    for &node in roots(root, &parents)?.iter().rev() {
        pending.push((node, DAffine3::IDENTITY));
    }
    while let Some((index, above)) = pending.pop() {
        let node = &root.nodes[index];
        let world = above * local(node);
        let columns = world.matrix3.to_cols_array();
        if !world.is_finite() || columns.iter().any(|x| x.abs() > MAX_SCALE) {
            let problem = "its transform is not finite, or scales past 1e100; re-export";
            return Err(SceneError::gltf(format!("nodes[{index}]"), problem));
        }
        if let Some(mesh) = node.mesh {
            if is_invertible(world.matrix3) {
                placed.push(Placed {
                    node: index,
                    mesh,
                    world_from_object: world,
                });
            } else {
                flat += 1;
            }
        }
        for &child in node.children.iter().rev() {
            pending.push((child, world));
        }
    }
    Ok((placed, flat))
}

/// The parent of each node, once it is sure that the nodes form trees.
fn parents(root: &Root) -> Result<Vec<Option<usize>>, SceneError> {
    let mut parents = vec![None; root.nodes.len()];
    for (index, node) in root.nodes.iter().enumerate() {
        let place = || format!("nodes[{index}]");
        for &child in &node.children {
            get(&root.nodes, child, "node", &place())?;
            if let Some(other) = parents[child].replace(index) {
                let problem =
                    format!("its child {child} is also a child of node {other}; re-export");
                return Err(SceneError::gltf(place(), problem));
            }
        }
    }
    // With one parent each, whatever cannot be reached from a node without one lies on a circle.
    let mut reached = 0;
    let mut pending: Vec<usize> = (0..parents.len())
        .filter(|&i| parents[i].is_none())
        .collect();
    while let Some(index) = pending.pop() {
        reached += 1;
        pending.extend(&root.nodes[index].children);
    }
    if reached < parents.len() {
        return Err(SceneError::gltf(
            "nodes",
            "some are their own ancestors; re-export",
        ));
    }
    Ok(parents)
}

fn roots(root: &Root, parents: &[Option<usize>]) -> Result<Vec<usize>, SceneError> {
    if root.scenes.is_empty() && root.scene.is_none() {
        return Ok((0..parents.len())
            .filter(|&i| parents[i].is_none())
            .collect());
    }
    let index = root.scene.unwrap_or(0);
    let scene = get(&root.scenes, index, "scene", "scene")?;
    let place = format!("scenes[{index}]");
    let mut seen = vec![false; parents.len()];
    for &node in &scene.nodes {
        get(&root.nodes, node, "node", &place)?;
        if parents[node].is_some() || std::mem::replace(&mut seen[node], true) {
            let problem = format!("node {node} is not a root, or stands there twice; re-export");
            return Err(SceneError::gltf(place, problem));
        }
    }
    Ok(scene.nodes.clone())
}

/// The node's own transform: its matrix, or translation · rotation · scale.
fn local(node: &Node) -> DAffine3 {
    if let Some(matrix) = &node.matrix {
        return DAffine3::from_mat4(DMat4::from_cols_array(matrix));
    }
    let rotation = node.rotation.map_or(DQuat::IDENTITY, |q| {
        let q = DQuat::from_array(q);
        let length = q.length();
        if length > 0.0 {
            q / length
        } else {
            DQuat::IDENTITY
        }
    });
    DAffine3::from_scale_rotation_translation(
        node.scale.map_or(DVec3::ONE, DVec3::from),
        rotation,
        node.translation.map_or(DVec3::ZERO, DVec3::from),
    )
}

/// Whether the matrix keeps volume, relative to the lengths of its columns: neither zero nor lost in rounding.
fn is_invertible(m: DMat3) -> bool {
    let lengths = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
    lengths > 0.0 && m.determinant().abs() > 1e-12 * lengths && m.inverse().is_finite()
}
