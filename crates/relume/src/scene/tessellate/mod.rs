//! Splitting long edges without cracks, because a floor of four vertices has four transfer vectors.

mod refine;
#[cfg(test)]
mod tests;

use glam::DVec3;

use super::error::{MAX_TRIANGLES, MAX_VERTICES};
use super::{Instance, Mesh, Scene, SceneError, World};
use refine::Refined;

/// [`auto_max_edge`] is the diagonal of the scene's bounds divided by this.
const EDGES_PER_DIAGONAL: f64 = 64.0;
/// [`coarseness`] above this deserves a warning: shadows are blurred over a tenth of the scene. Measured: scans 0.006 to 0.023, detailed
/// game models up to 0.07, a room with undivided walls 0.13, the Cornell box 0.70.
pub const TOO_COARSE: f64 = 0.1;

/// Splits every edge that is longer than `max_edge` (metres, in the space of the scene's root) at its midpoint, again and again until
/// none is, to a part in a million.
///
/// Whether an edge is split depends on the positions of its two ends alone, so triangles that share it split it alike, across seams, material groups
/// and primitives: what had no cracks gets none. A triangle with one, two or three split edges becomes two, three or four; of the two ways to
/// cut three, the shorter diagonal wins. Input vertices stay first with their indices ([`Mesh::input_vertices`] is kept); new
/// ones take the mean of their edge's ends, normals normalised again. Every instance gets a mesh of its own, since its scale is its own, in the
/// order of the instances. Meshes without instances disappear.
///
/// # Errors
///
/// A length that is not positive and finite, or so short that the result would have more than 2²⁷ vertices or 2²⁸ triangles; this is estimated from
/// areas and edges before anything is split, and counted before every round.
pub fn tessellate(scene: &Scene, max_edge: f64) -> Result<Scene, SceneError> {
    if !(max_edge > 0.0 && max_edge.is_finite()) {
        return Err(SceneError::MaxEdge(max_edge));
    }
    check_estimate(scene, max_edge)?;
    let mut result = Scene {
        meshes: Vec::with_capacity(scene.instances.len()),
        materials: scene.materials.clone(),
        textures: scene.textures.clone(),
        instances: Vec::with_capacity(scene.instances.len()),
        document: scene.document.clone(),
        source_hash: scene.source_hash.clone(),
        albedo_override: scene.albedo_override,
        reflection_override: scene.reflection_override.clone(),
        warnings: scene.warnings.clone(),
    };
    let (mut vertices, mut triangles) = (0, 0);
    for (index, instance) in scene.instances.iter().enumerate() {
        let mesh = &scene.meshes[instance.mesh];
        let mut refined = Refined::new(mesh.clone(), world_positions(mesh, instance), max_edge);
        while let Some(growth) = refined.next_round() {
            let after = [
                ("vertices", vertices + growth.vertices, MAX_VERTICES),
                ("triangles", triangles + growth.triangles, MAX_TRIANGLES),
            ];
            for (what, count, limit) in after {
                check_count(max_edge, what, count as f64, limit)?;
            }
            refined.split();
        }
        let mesh = refined.into_mesh();
        vertices += mesh.positions.len() as u64;
        triangles += mesh.triangle_count() as u64;
        result.meshes.push(mesh);
        result.instances.push(Instance {
            mesh: index,
            ..instance.clone()
        });
    }
    Ok(result)
}

/// The positions as [`World`] has them, so that meshes that meet in the world meet here.
fn world_positions(mesh: &Mesh, instance: &Instance) -> Vec<DVec3> {
    let to_world = instance.world_from_object;
    let positions = mesh.positions.iter();
    positions
        .map(|p| to_world.transform_point3(p.as_dvec3()).as_vec3().as_dvec3())
        .collect()
}

fn check_count(
    max_edge: f64,
    what: &'static str,
    count: f64,
    limit: u64,
) -> Result<(), SceneError> {
    if count <= limit as f64 {
        return Ok(());
    }
    Err(SceneError::TooFine {
        max_edge,
        what,
        count,
        limit,
    })
}

/// Refuses at once what must end in too many triangles: each has at most the area √3/4·max_edge², and an edge of length L takes at least
/// L/max_edge of them.
fn check_estimate(scene: &Scene, max_edge: f64) -> Result<(), SceneError> {
    let mut least = 0.0;
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        let world = world_positions(mesh, instance);
        for corners in mesh.triangles() {
            let [a, b, c] = corners.map(|i| world[i as usize]);
            let by_area = area([a, b, c]) / (3f64.sqrt() / 4.0 * max_edge * max_edge);
            least += by_area
                .max(longest_edge([a, b, c]) / max_edge)
                .max(1.0)
                .floor();
        }
    }
    check_count(max_edge, "triangles", least, MAX_TRIANGLES)
}

fn area([a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).cross(c - a).length() / 2.0
}

fn longest_edge([a, b, c]: [DVec3; 3]) -> f64 {
    a.distance(b).max(b.distance(c)).max(c.distance(a))
}

fn diagonal(world: &World) -> f64 {
    let bounds = world.bounds();
    bounds.map_or(0.0, |(low, high)| low.as_dvec3().distance(high.as_dvec3()))
}

/// The length that `--max-edge auto` stands for: 1/64 of the diagonal of the bounds of all triangles. `None` without triangles.
pub fn auto_max_edge(world: &World) -> Option<f64> {
    let length = diagonal(world) / EDGES_PER_DIAGONAL;
    (length > 0.0).then_some(length)
}

/// How coarse the mesh is for the shadows on it: the mean over the surface of the longest edge of its triangle, divided by the diagonal of the
/// bounds. 0 without triangles; above [`TOO_COARSE`] people should be told.
pub fn coarseness(world: &World) -> f64 {
    let (mut weighted, mut total) = (0.0, 0.0);
    for corners in &world.triangles {
        let corners = corners.map(|i| world.positions[i as usize].as_dvec3());
        let area = area(corners);
        weighted += area * longest_edge(corners);
        total += area;
    }
    let whole = total * diagonal(world);
    if whole > 0.0 { weighted / whole } else { 0.0 }
}
