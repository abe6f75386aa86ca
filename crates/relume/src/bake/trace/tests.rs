use glam::{Vec2, Vec3};

use super::super::sampling::vertex_seed;
use super::test_worlds::{mesh_of, world_of};
use super::*;
use crate::scene::{AlphaMode, Group, Material, Sampler, Texture, World, Wrap};
use crate::simd::Level;

fn solid(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> World {
    world_of(
        mesh_of(positions, triangles),
        vec![Material::diffuse("grey", [0.5; 3])],
        vec![],
    )
}

/// A closed, bumpy torus: many corners of valence 6, none where coordinates are round.
fn bumpy_torus(rings: u32, sides: u32) -> World {
    let at = |i: u32, j: u32| {
        let a = f64::from(i) / f64::from(rings) * std::f64::consts::TAU;
        let b = f64::from(j) / f64::from(sides) * std::f64::consts::TAU;
        let r = 0.4 + 0.05 * libm::sin(7.0 * a + 3.0 * b);
        let ring = 1.0 + r * libm::cos(b);
        glam::DVec3::new(ring * libm::cos(a), r * libm::sin(b), ring * libm::sin(a)).as_vec3()
    };
    let index = |i: u32, j: u32| (i % rings) * sides + j % sides;
    let positions = (0..rings)
        .flat_map(|i| (0..sides).map(move |j| (i, j)))
        .map(|(i, j)| at(i, j));
    let triangles = (0..rings)
        .flat_map(|i| (0..sides).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [
                index(i, j),
                index(i, j + 1),
                index(i + 1, j + 1),
                index(i + 1, j),
            ];
            [[a, b, c], [a, c, d]]
        });
    solid(positions.collect(), triangles.collect())
}

fn rays(directions: &[Vec3]) -> Rays {
    directions.iter().copied().collect()
}

/// A deterministic stream of numbers in 0…1.
fn numbers(seed: u64) -> impl FnMut() -> f32 {
    let mut count = 0.0;
    move || {
        count += 1.0;
        (vertex_seed(Vec3::new(count, 0.0, 0.0), Vec3::ZERO, seed) >> 40) as f32 / (1 << 24) as f32
    }
}

#[test]
fn no_ray_leaks_through_corners_and_edges_of_a_closed_mesh() {
    // 5.7 % of such rays pass through an ordinary ray-triangle test. The origin lies inside the tube: every ray must meet it.
    let world = bumpy_torus(96, 48);
    let tracer = Tracer::new(&world);
    let mut number = numbers(1);
    let (mut cast, mut leaked) = (0, 0);
    let mut hits = Vec::new();
    while cast < 1_000_000 {
        let a = number() * std::f32::consts::TAU;
        let ring = 1.0 + 0.2 * (number() - 0.5);
        let origin = Vec3::new(ring * a.cos(), 0.2 * (number() - 0.5), ring * a.sin());
        let targets: Vec<Vec3> = world
            .triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let [a, b, c] = [a, b, c].map(|i| world.positions[i as usize]);
                let split = number();
                [a, b, a.lerp(b, split), b.lerp(c, split), (c + a) * 0.5]
            })
            .collect();
        let directions: Vec<Vec3> = targets.iter().map(|p| (p - origin).normalize()).collect();
        hits.resize(directions.len(), Hit::MISS);
        tracer.closest_from(origin, &rays(&directions), &mut hits);
        cast += hits.len();
        // A ray may only meet a front first where it grazes a silhouette: there it leaves and enters at one point, its target.
        leaked += std::iter::zip(&hits, &targets)
            .filter(|(hit, target)| {
                let beyond = hit.t > target.distance(origin) * (1.0 + 1e-6);
                !hit.is_hit() || (hit.front && beyond)
            })
            .count();
    }
    assert_eq!(leaked, 0, "of {cast} rays");
}

#[test]
fn rays_along_the_axes_meet_the_corners_and_edges_of_a_box() {
    let corner =
        |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0;
    let quads = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let triangles = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    let world = solid((0..8).map(corner).collect(), triangles);
    let steps = [-1.0, 0.0, 1.0];
    let directions: Vec<Vec3> = steps
        .iter()
        .flat_map(|&x| {
            steps
                .iter()
                .flat_map(move |&y| steps.map(|z| Vec3::new(x, y, z)))
        })
        .filter_map(Vec3::try_normalize)
        .collect();
    let mut hits = vec![Hit::MISS; directions.len()];
    Tracer::new(&world).closest_from(Vec3::ZERO, &rays(&directions), &mut hits);
    for (hit, d) in hits.iter().zip(&directions) {
        assert!(hit.is_hit() && !hit.front, "{d} leaks");
        assert!(
            (hit.t - 1.0 / d.abs().max_element()).abs() < 1e-6,
            "{d} meets at {}",
            hit.t
        );
    }
}

#[test]
fn every_hit_is_the_nearest_by_a_plain_search_in_f64() {
    let world = bumpy_torus(24, 12);
    let tracer = Tracer::new(&world);
    let mut number = numbers(2);
    for _ in 0..200 {
        let [origin, normal] =
            [(); 2].map(|()| Vec3::from([number(), number(), number()]) * 4.0 - 2.0);
        let tangent = normal.normalize().any_orthonormal_vector();
        let directions: Vec<Vec3> = (0..77)
            .map(|i| (normal.normalize() + tangent * (i as f32 / 40.0 - 1.0)).normalize())
            .collect();
        let mut hits = vec![Hit::MISS; directions.len()];
        tracer.closest_from(origin, &rays(&directions), &mut hits);
        for (hit, &d) in hits.iter().zip(&directions) {
            let expected = plain_search(&world, origin, d);
            assert_eq!(hit.is_hit(), expected.is_some());
            if let Some((t, triangle)) = expected {
                assert!(
                    (f64::from(hit.t) - t).abs() < 2e-6 * t.max(1.0),
                    "{} for {t}",
                    hit.t
                );
                let world_point =
                    world.interpolate(hit.triangle, hit.weights(), |i| world.positions[i]);
                assert!(
                    (world_point - (origin + d * hit.t)).length() < 1e-5,
                    "{triangle} {hit:?}"
                );
            }
        }
    }
}

/// Möller–Trumbore over every triangle, in f64, nearest first.
fn plain_search(world: &World, origin: Vec3, d: Vec3) -> Option<(f64, u32)> {
    let d = d.as_dvec3();
    let hits = (0..world.triangles.len() as u32).filter_map(|i| {
        let [a, b, c] = world.corners(i).map(Vec3::as_dvec3);
        let (e1, e2) = (b - a, c - a);
        let p = d.cross(e2);
        let det = e1.dot(p);
        let s = origin.as_dvec3() - a;
        let q = s.cross(e1);
        let (u, v, t) = (s.dot(p) / det, d.dot(q) / det, e2.dot(q) / det);
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some((t, i))
    });
    hits.min_by(|a, b| a.0.total_cmp(&b.0))
}

#[test]
fn a_ray_finds_the_same_whoever_travels_with_it() {
    let world = bumpy_torus(48, 24);
    let tracer = Tracer::new(&world);
    let mut number = numbers(3);
    let origin = Vec3::new(0.1, 1.5, -0.2);
    let directions: Vec<Vec3> = (0..1000)
        .map(|_| (Vec3::from([number(), number(), number()]) - 0.5).normalize())
        .collect();
    let mut together = vec![Hit::MISS; directions.len()];
    tracer.closest_from(origin, &rays(&directions), &mut together);
    for (d, expected) in directions.iter().zip(&together) {
        let mut alone = [Hit::MISS];
        tracer.closest_from(origin, &rays(&[*d]), &mut alone);
        assert_eq!(alone[0], *expected);
    }
}

#[test]
fn every_instruction_set_finds_the_same_and_open_rays_are_those_that_miss() {
    let world = bumpy_torus(48, 24);
    let plain = Tracer::with_level(&world, Level::PORTABLE);
    let mut number = numbers(4);
    // What one origin leaves behind is tried from all others, and in other trees.
    let mut occluders = Occluders::default();
    for (count, narrow) in [1, 63, 64, 65, 1000]
        .into_iter()
        .flat_map(|count| [(count, false), (count, true)])
    {
        let origin = Vec3::new(number(), number(), number());
        // Half of them through corners, where doubt is largest. In a narrow bundle whole groups reach the same leaves.
        let corners = if narrow { 8 } else { world.positions.len() };
        let through = |i: usize| world.positions[i % corners] - origin;
        let directions: Vec<Vec3> = (0..count)
            .map(|i| {
                let aside = Vec3::new(number(), number(), number()) - 0.5;
                match (i % 2 == 0, narrow) {
                    (true, _) => through(7 * i),
                    (false, true) => through(3) + aside * 0.1,
                    (false, false) => aside,
                }
            })
            .map(Vec3::normalize)
            .collect();
        let rays = rays(&directions);
        let mut expected = vec![Hit::MISS; count];
        plain.closest_from(origin, &rays, &mut expected);
        let missed: Vec<usize> = (0..count).filter(|&i| !expected[i].is_hit()).collect();
        for &level in Level::here() {
            let tracer = Tracer::with_level(&world, level);
            let mut hits = vec![Hit::MISS; count];
            tracer.closest_from(origin, &rays, &mut hits);
            assert_eq!(hits, expected, "{level}");
            let mut open = vec![0; rays.words()];
            tracer.open_from(origin, &rays, &mut open, &mut occluders);
            assert_eq!(rays_of(&open).collect::<Vec<_>>(), missed, "{level}");
            // Just behind the surface, at it, and just before it.
            for (past, is_hidden) in [(1.0001, true), (1.0, false), (0.9999, false)] {
                let until = |hit: &Hit| if hit.is_hit() { past * hit.t } else { 9.0 };
                let until: Vec<f32> = hits.iter().map(until).collect();
                let mut hidden = vec![0; rays.words()];
                tracer.hidden_from(origin, &rays, &until, &mut hidden);
                let found: Vec<bool> = (0..count)
                    .map(|i| hidden[i / 64] >> (i % 64) & 1 != 0)
                    .collect();
                let expected: Vec<bool> = hits.iter().map(|h| h.is_hit() && is_hidden).collect();
                assert_eq!(found, expected, "{level}, until {past}");
            }
        }
    }
}

#[test]
fn an_alpha_mask_lets_rays_through_its_holes() {
    // A square facing +z whose left half is a hole, before a solid square.
    let square =
        |z: f32| [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, z));
    let mut mesh = mesh_of(
        [square(1.0), square(0.0)].concat(),
        vec![[0, 1, 2], [0, 2, 3]],
    );
    mesh.groups.push(Group {
        material: 1,
        triangles: vec![[4, 5, 6], [4, 6, 7]],
    });
    mesh.uvs = mesh.positions.iter().map(|p| Vec2::new(p.x, p.y)).collect();
    let mut leaf = Material::diffuse("leaf", [1.0; 3]);
    leaf.alpha = AlphaMode::Mask(0.5);
    leaf.base_color_texture = Some(0);
    let sampler = Sampler {
        wrap_u: Wrap::Clamp,
        wrap_v: Wrap::Clamp,
        nearest: true,
    };
    let texture = Texture {
        width: 2,
        height: 1,
        texels: vec![[0, 0, 0, 0], [255, 255, 255, 255]],
        sampler,
    };
    let world = world_of(
        mesh,
        vec![leaf, Material::diffuse("wall", [0.5; 3])],
        vec![texture],
    );
    let origin = Vec3::new(0.5, 0.5, 3.0);
    let directions = [0.2, 0.8].map(|x| (Vec3::new(x, 0.4, 1.0) - origin).normalize());
    let mut hits = [Hit::MISS; 2];
    Tracer::new(&world).closest_from(origin, &rays(&directions), &mut hits);
    assert!(hits[0].t > 2.5 && hits[1].t < 2.5, "{hits:?}");
    assert!(hits.iter().all(|hit| hit.front));
    // Without the wall, the sky is seen through the hole alone: by few rays, and by many that go down the tree together.
    let mut leaf_alone = world.clone();
    leaf_alone.triangles.truncate(2);
    let tracer = Tracer::new(&leaf_alone);
    for count in [2, 64] {
        let x = |i: u32| (i as f32 + 0.5) / count as f32;
        let directions: Vec<Vec3> = (0..count)
            .map(|i| (Vec3::new(x(i), 0.4, 1.0) - origin).normalize())
            .collect();
        let mut open = [0];
        tracer.open_from(
            origin,
            &rays(&directions),
            &mut open,
            &mut Occluders::default(),
        );
        assert_eq!(open, [(1 << (count / 2)) - 1]);
        let mut hits = vec![Hit::MISS; directions.len()];
        Tracer::new(&world).closest_from(origin, &rays(&directions), &mut hits);
        let (holes, leaf) = hits.split_at(directions.len() / 2);
        assert!(holes.iter().all(|hit| hit.t > 2.5) && leaf.iter().all(|hit| hit.t < 2.5));
    }
}

#[test]
fn no_corner_has_a_negative_share() {
    // Toward points on the edges of slivers, where rounding decides on which side of an edge they are.
    let mut next = numbers(5);
    let mut point = || Vec3::new(next(), next(), next()) - 0.5;
    let mut outside = 0;
    for i in 0..100_000 {
        let (a, along) = (point(), point());
        let corners = [a, a + along, a + along * 0.5 + point() * 1e-5];
        let (origin, share) = (point() * 3.0, (i % 64) as f32 / 63.0);
        let target = corners[i % 3].lerp(corners[(i + 1) % 3], share);
        let (u, v, _) = triangle::weights(corners, origin, (target - origin).normalize());
        let shares = [1.0 - u - v, u, v];
        assert!(shares.iter().all(|w| (0.0..=1.0).contains(w)), "{shares:?}");
        outside += usize::from(shares.contains(&0.0));
    }
    assert!(outside > 1000, "{outside}");
    let point = [Vec3::ONE; 3];
    assert_eq!(triangle::weights(point, Vec3::ZERO, Vec3::X).0, 0.0);
}

#[test]
fn a_world_without_triangles_is_all_sky() {
    let mut hits = [Hit::MISS];
    Tracer::new(&World::default()).closest_from(Vec3::ZERO, &rays(&[Vec3::Y]), &mut hits);
    assert_eq!(hits, [Hit::MISS]);
}

/// Ours beside a tracer that shares no code with it, where that is installed.
#[cfg(all(feature = "embree", any(unix, windows)))]
#[test]
fn embree_finds_what_we_find() {
    let world = bumpy_torus(96, 48);
    let path = std::env::var_os("RELUME_EMBREE").map(std::path::PathBuf::from);
    let embree = match Tracer::with_embree(&world, path.as_deref()) {
        Ok(embree) => embree,
        Err(embree::EmbreeError::Load(_)) if path.is_none() => {
            println!(
                "skipped: embree_finds_what_we_find: needs libembree4 in the system's folders, or RELUME_EMBREE=/absolute/path/to/it"
            );
            return;
        }
        Err(error) => panic!("{error}"),
    };
    let ours = Tracer::new(&world);
    let mut number = numbers(6);
    let mut apart = 0;
    for _ in 0..40 {
        let origin = Vec3::new(number(), number(), number()) * 3.0 - 1.5;
        let directions: Vec<Vec3> = (0..500)
            .map(|_| (Vec3::new(number(), number(), number()) - 0.5).normalize())
            .collect();
        let rays = rays(&directions);
        let (mut a, mut b) = ([Hit::MISS; 500], [Hit::MISS; 500]);
        ours.closest_from(origin, &rays, &mut a);
        embree.closest_from(origin, &rays, &mut b);
        let same = |(a, b): &(&Hit, &Hit)| {
            a.triangle == b.triangle && (a.t == b.t || (a.t - b.t).abs() < 1e-5 * a.t)
        };
        apart += a.iter().zip(&b).filter(|pair| !same(pair)).count();
        let mut open = vec![0; rays.words()];
        embree.open_from(origin, &rays, &mut open, &mut Occluders::default());
        let missed = (0..500).filter(|&i| !b[i].is_hit());
        assert!(rays_of(&open).eq(missed), "what Embree itself says differs");
    }
    // Rays along edges may go either way, and touch or miss a silhouette.
    assert!(apart <= 2, "{apart} of 20000 rays");
}
