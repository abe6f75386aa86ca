use std::collections::{BTreeMap, BTreeSet};

use glam::{DAffine3, DQuat, Vec2, Vec3};

use super::super::normals::position_key;
use super::super::{Group, Material};
use super::*;

fn instance(mesh: usize, world_from_object: DAffine3) -> Instance {
    Instance {
        mesh,
        node: 0,
        primitive: 0,
        world_from_object,
    }
}

/// A box of 2 × 1 × 0.5 whose faces have vertices, normals and coordinates of their own, in two material groups.
fn seamed_box() -> Scene {
    let mut mesh = Mesh::default();
    let mut groups = [Vec::new(), Vec::new()];
    for (face, (axis, sign)) in [
        (0, 1.0),
        (0, -1.0),
        (1, 1.0),
        (1, -1.0),
        (2, 1.0),
        (2, -1.0),
    ]
    .into_iter()
    .enumerate()
    {
        let first = mesh.positions.len() as u32;
        let mut normal = Vec3::ZERO;
        normal[axis] = sign;
        for (u, v) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0f32)] {
            let mut p = Vec3::ZERO;
            p[axis] = if sign > 0.0 { 1.0 } else { 0.0 };
            p[(axis + 1) % 3] = if sign > 0.0 { u } else { v };
            p[(axis + 2) % 3] = if sign > 0.0 { v } else { u };
            mesh.positions.push(p * Vec3::new(2.0, 1.0, 0.5));
            mesh.normals.push(normal);
            mesh.uvs.push(Vec2::new(u, v));
            mesh.colors.push([u, v, 0.5]);
            mesh.alphas.push(u);
        }
        let corners = [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|i| first + i));
        groups[face % 2].extend(corners);
    }
    mesh.groups = groups
        .into_iter()
        .enumerate()
        .map(|(material, triangles)| Group {
            material,
            triangles,
        })
        .collect();
    mesh.input_vertices = mesh.positions.len();
    Scene {
        meshes: vec![mesh],
        materials: vec![
            Material::diffuse("a", [0.5; 3]),
            Material::diffuse("b", [0.1; 3]),
        ],
        instances: vec![instance(0, DAffine3::IDENTITY)],
        ..Scene::default()
    }
}

/// How often each edge occurs in each direction, by position.
fn edge_balance(world: &World) -> BTreeMap<[[u32; 3]; 2], i32> {
    let mut balance = BTreeMap::new();
    for t in &world.triangles {
        for k in 0..3 {
            let [a, b] = [t[k], t[(k + 1) % 3]].map(|i| position_key(world.positions[i as usize]));
            *balance.entry([a, b]).or_insert(0) += 1;
            *balance.entry([b, a]).or_insert(0) -= 1;
        }
    }
    balance
}

fn total_area(world: &World) -> f64 {
    let triangles = world.triangles.iter();
    let corners = triangles.map(|t| t.map(|i| world.positions[i as usize].as_dvec3()));
    corners.map(area).sum()
}

fn longest(world: &World) -> f64 {
    let triangles = world.triangles.iter();
    let corners = triangles.map(|t| t.map(|i| world.positions[i as usize].as_dvec3()));
    corners.map(longest_edge).fold(0.0, f64::max)
}

/// f32 positions of unit size are off by 6e-8; the limit itself is kept to 1e-6.
const ROUNDING: f64 = 2e-6;

#[test]
fn a_closed_mesh_with_seams_stays_closed_and_keeps_its_area() {
    let scene = seamed_box();
    // Ratios to the edges that are, and are not, powers of two; a skewed and mirrored stand as well.
    let skewed = DAffine3::from_scale_rotation_translation(
        DVec3::new(-1.5, 1.0, 3.0),
        DQuat::from_xyzw(0.1, 0.2, 0.3, 0.9).normalize(),
        DVec3::new(10.0, -3.0, 0.2),
    );
    for (stand, rounding) in [(DAffine3::IDENTITY, ROUNDING), (skewed, 1e-5)] {
        for max_edge in [1.0, 0.5, 0.3, 0.11] {
            let mut scene = scene.clone();
            scene.instances[0].world_from_object = stand;
            let before = World::new(&scene);
            let after = World::new(&tessellate(&scene, max_edge).unwrap());
            if stand == DAffine3::IDENTITY {
                assert!(
                    edge_balance(&after).values().all(|&n| n == 0),
                    "cracks at {max_edge}"
                );
            }
            assert!(longest(&after) <= max_edge * (1.0 + rounding));
            let (a, b) = (total_area(&before), total_area(&after));
            assert!((a - b).abs() < 1e-6 * a, "{a} became {b}");
        }
    }
}

#[test]
fn input_vertices_stay_first_and_new_ones_are_interpolated() {
    let scene = seamed_box();
    let result = tessellate(&scene, 0.3).unwrap();
    let (old, new) = (&scene.meshes[0], &result.meshes[0]);
    assert_eq!(new.input_vertices, 24);
    assert_eq!(new.positions[..24], old.positions[..]);
    assert_eq!(new.uvs[..24], old.uvs[..]);
    let n = new.positions.len();
    assert!(n > 24);
    assert_eq!(
        [
            new.normals.len(),
            new.uvs.len(),
            new.colors.len(),
            new.alphas.len()
        ],
        [n; 4]
    );
    // On each flat face colour, alpha and uv are the same linear function of the position.
    for i in 0..n {
        let (uv, normal) = (new.uvs[i], new.normals[i]);
        assert!((normal.length() - 1.0).abs() < 1e-6);
        assert_eq!((new.colors[i], new.alphas[i]), ([uv.x, uv.y, 0.5], uv.x));
        let axis = (0..3).find(|&k| normal[k] != 0.0).unwrap();
        let p = new.positions[i] / Vec3::new(2.0, 1.0, 0.5);
        let (u, v) = (p[(axis + 1) % 3], p[(axis + 2) % 3]);
        let expected = if normal[axis] > 0.0 {
            Vec2::new(u, v)
        } else {
            Vec2::new(v, u)
        };
        assert!((uv - expected).length() < 1e-6);
    }
    let world = World::new(&result);
    assert_eq!(world.from_input.iter().filter(|&&input| input).count(), 24);
}

/// Positions of triangles as a set: what is left when numbering is taken away.
fn shape(world: &World) -> BTreeSet<[[u32; 3]; 3]> {
    let triangles = world.triangles.iter();
    triangles
        .map(|t| {
            let mut keys = t.map(|i| position_key(world.positions[i as usize]));
            let least = (0..3).min_by_key(|&i| keys[i]).unwrap();
            keys.rotate_left(least);
            keys
        })
        .collect()
}

#[test]
fn the_numbering_of_vertices_and_corners_does_not_matter() {
    let scene = seamed_box();
    let mut turned = scene.clone();
    let mesh = &mut turned.meshes[0];
    let last = mesh.positions.len() as u32 - 1;
    mesh.positions.reverse();
    mesh.normals.reverse();
    mesh.uvs.reverse();
    mesh.colors.reverse();
    mesh.alphas.reverse();
    for group in &mut mesh.groups {
        group.triangles.reverse();
        for triangle in &mut group.triangles {
            *triangle = triangle.map(|i| last - i);
            triangle.rotate_left(1);
        }
    }
    for max_edge in [0.9, 0.37, 0.2] {
        let [a, b] = [&scene, &turned].map(|s| World::new(&tessellate(s, max_edge).unwrap()));
        assert_eq!(shape(&a), shape(&b));
    }
}

#[test]
fn instances_with_other_transforms_split_a_shared_edge_alike() {
    // Two halves of a floor; one is the other turned over and scaled, so its object space is not the same.
    let mut mesh = Mesh {
        positions: [
            [0.0, 0.0, 0.0],
            [0.0, 0.0, 3.2],
            [1.6, 0.0, 3.2],
            [1.6, 0.0, 0.0],
        ]
        .map(Vec3::from)
        .to_vec(),
        normals: vec![Vec3::Y; 4],
        groups: vec![Group {
            material: 0,
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        }],
        input_vertices: 4,
        ..Mesh::default()
    };
    let mut scene = Scene {
        materials: vec![Material::diffuse("a", [0.5; 3])],
        instances: vec![instance(0, DAffine3::IDENTITY)],
        ..Scene::default()
    };
    scene.meshes.push(mesh.clone());
    mesh.positions.iter_mut().for_each(|p| *p /= 3.0);
    scene.meshes.push(mesh);
    let turned = DAffine3::from_scale_rotation_translation(
        DVec3::splat(3.0),
        DQuat::from_xyzw(0.0, 1.0, 0.0, 0.0),
        DVec3::new(0.0, 0.0, f64::from(3.2f32)),
    );
    scene.instances.push(instance(1, turned));
    // 3.2 is exactly eight times 0.4.
    let result = tessellate(&scene, f64::from(3.2f32) / 8.0).unwrap();
    let world = World::new(&result);
    let on_edge = |range: &std::ops::Range<usize>| {
        let points = range.clone().map(|i| world.positions[i]);
        let on = points
            .filter(|p| p.x.abs() < 1e-5)
            .map(|p| (p.z * 1e4).round() as i64);
        on.collect::<BTreeSet<_>>()
    };
    let [first, second] = [0, 1].map(|i| on_edge(&world.instance_vertices[i]));
    assert_eq!(first.len(), 9);
    assert_eq!(first, second);
}

#[test]
fn each_instance_is_measured_by_its_own_scale() {
    let mut scene = seamed_box();
    scene
        .instances
        .push(instance(0, DAffine3::from_scale(DVec3::splat(4.0))));
    let result = tessellate(&scene, 1.0).unwrap();
    assert_eq!(result.meshes.len(), 2);
    assert_eq!([result.instances[0].mesh, result.instances[1].mesh], [0, 1]);
    assert!(result.meshes[1].positions.len() > 4 * result.meshes[0].positions.len());
}

#[test]
fn nothing_changes_where_every_edge_is_short() {
    let scene = seamed_box();
    let once = tessellate(&scene, 0.2).unwrap();
    let twice = tessellate(&once, 0.2).unwrap();
    let untouched = tessellate(&scene, 100.0).unwrap();
    for (a, b) in [(&once, &twice), (&scene, &untouched)] {
        assert_eq!(a.meshes[0].positions, b.meshes[0].positions);
        assert!(a.meshes[0].triangles().eq(b.meshes[0].triangles()));
    }
}

#[test]
fn too_fine_and_meaningless_lengths_are_refused_at_once() {
    let scene = seamed_box();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            tessellate(&scene, bad),
            Err(SceneError::MaxEdge(_))
        ));
    }
    for tiny in [1e-5, 1e-300] {
        let error = tessellate(&scene, tiny).unwrap_err();
        assert!(matches!(error, SceneError::TooFine { .. }));
        assert!(error.to_string().contains("--max-edge"), "{error}");
    }
}

#[test]
fn slivers_end_too() {
    // A needle that only edge-by-edge halving of the long sides can end.
    let mut scene = seamed_box();
    scene.meshes[0].positions.truncate(3);
    scene.meshes[0].positions[..3].copy_from_slice(&[
        Vec3::ZERO,
        Vec3::new(100.0, 0.001, 0.0),
        Vec3::new(99.0, 0.002, 0.0),
    ]);
    scene.meshes[0].groups[0].triangles = vec![[0, 1, 2]];
    scene.meshes[0].groups[1].triangles.clear();
    scene.meshes[0].normals.truncate(3);
    scene.meshes[0].uvs.clear();
    scene.meshes[0].colors.clear();
    scene.meshes[0].alphas.clear();
    let world = World::new(&tessellate(&scene, 0.5).unwrap());
    // Positions near 100 are rounded to 4e-6.
    assert!(longest(&world) <= 0.5 + 2e-5);
    // Eight halvings take 100 below 0.5; each makes at most four triangles of one.
    assert!(
        world.triangles.len() <= 4usize.pow(8),
        "{}",
        world.triangles.len()
    );
}

#[cfg(feature = "import")]
#[test]
fn real_meshes_are_judged_coarse_or_fine() {
    let test = "real_meshes_are_judged_coarse_or_fine";
    for (name, coarse) in [
        ("armadillo_10k.ply", false),
        ("armadillo_43k.obj", false),
        ("stanford_bunny_36k.ply", false),
        ("max_planck_5k.obj", false),
        ("flight_helmet.glb", false),
        ("utah_teapot.obj", false),
        ("damaged_helmet.glb", false),
        ("avocado.glb", true),
        ("prt_wall_with_pillars.obj", false),
        ("prt_head_big_ears.obj", false),
        ("cornell_box.obj", true),
        ("room_teapot_pillars.gltf", true),
        ("crytek_sponza_core.obj", true),
        ("domed_building.glb", true),
    ] {
        let path = crate::test_data::shared_or_skip(test, &format!("meshes/{name}"));
        let Some(path) = path else { return };
        let scene = super::super::load(&path, &Default::default()).unwrap();
        let world = World::new(&scene);
        let measure = coarseness(&world);
        println!(
            "{name}: {measure:.4} auto {:.4}",
            auto_max_edge(&world).unwrap()
        );
        assert_eq!(measure > TOO_COARSE, coarse, "{name}: {measure}");
        if coarse {
            let fine = tessellate(&scene, auto_max_edge(&world).unwrap()).unwrap();
            let after = coarseness(&World::new(&fine));
            println!(
                "   {} -> {} triangles",
                scene.triangle_count(),
                fine.triangle_count()
            );
            assert!(
                after < TOO_COARSE / 5.0,
                "{name}: {after} after --max-edge auto"
            );
        }
    }
}

#[cfg(feature = "import")]
#[test]
fn a_real_closed_mesh_stays_closed() {
    let test = "a_real_closed_mesh_stays_closed";
    let path = crate::test_data::shared_or_skip(test, "meshes/armadillo_10k.ply");
    let Some(path) = path else { return };
    let scene = super::super::load(&path, &Default::default()).unwrap();
    let before = World::new(&scene);
    let after = World::new(&tessellate(&scene, 0.012).unwrap());
    assert!(after.triangles.len() > 2 * before.triangles.len());
    assert!(edge_balance(&after).values().all(|&n| n == 0));
    assert!(longest(&after) <= 0.012 * (1.0 + 1e-5));
    let (a, b) = (total_area(&before), total_area(&after));
    assert!((a - b).abs() < 1e-6 * a, "{a} became {b}");
}
