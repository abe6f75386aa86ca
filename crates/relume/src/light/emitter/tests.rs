//! Shapes, patterns and what rays meet of them.

use super::*;

mod exact;
mod rays;
mod samplers;
mod session;

pub fn of(shape: Shape, pattern: Pattern) -> Emitter {
    Emitter {
        name: "lamp".to_owned(),
        shape,
        pattern,
        two_sided: false,
        exponent: 0,
        world_from_emitter: DAffine3::IDENTITY,
    }
}

fn placed(emitter: Emitter) -> Placed {
    Emitters::new(vec![emitter]).unwrap().placed()
}

#[test]
fn shapes_have_the_area_they_should_and_face_outward() {
    let area = |mesh: EmitterMesh| -> f64 {
        let placed = placed(of(Shape::Mesh(mesh), Pattern::Uniform([1.0; 3])));
        let areas = placed
            .polygons
            .iter()
            .map(|p| shapes::area_vector(placed.corners(p)).length());
        areas.sum()
    };
    assert!((area(EmitterMesh::quad(2.0, 3.0)) - 6.0).abs() < 1e-12);
    assert!((area(EmitterMesh::disc(2.0)) - 4.0 * std::f64::consts::PI).abs() < 1e-12);
    assert!((area(EmitterMesh::blocks(4, 2, 4.0, 2.0, 0.5)) - 2.0).abs() < 1e-12);
    assert!((area(EmitterMesh::cuboid(DVec3::new(1.0, 2.0, 3.0))) - 22.0).abs() < 1e-12);
    assert!((area(EmitterMesh::sphere(1.0)) - 4.0 * std::f64::consts::PI).abs() < 1e-9);
    for mesh in [EmitterMesh::cuboid(DVec3::ONE), EmitterMesh::sphere(1.0)] {
        let placed = placed(of(Shape::Mesh(mesh), Pattern::Uniform([1.0; 3])));
        assert!(placed.polygons.iter().all(|p| p.normal.dot(p.centre) > 0.0));
    }
}

#[test]
fn rays_meet_the_nearest_side_and_see_its_radiance() {
    let mut panel = of(
        Shape::Mesh(EmitterMesh::quad(2.0, 2.0)),
        Pattern::Uniform([1.0, 2.0, 3.0]),
    );
    panel.exponent = 2;
    let ball = Emitter {
        world_from_emitter: DAffine3::from_translation(DVec3::new(0.0, 0.0, -3.0)),
        ..of(Shape::Sphere { radius: 1.0 }, Pattern::Uniform([5.0; 3]))
    };
    let placed = Emitters::new(vec![panel, ball]).unwrap().placed();
    let hit =
        |origin: [f64; 3], direction: [f64; 3]| placed.first_hit(origin.into(), direction.into());
    let front = hit([0.5, 0.0, 2.0], [0.0, 0.0, -2.0]).unwrap();
    assert_eq!((front.distance, front.radiance), (1.0, [1.0, 2.0, 3.0]));
    let slanted = hit([1.0, 0.0, 1.0], [-1.0, 0.0, -1.0]).unwrap();
    assert!((slanted.radiance[2] - 1.5).abs() < 1e-6);
    // Its back is black, and hides the ball from behind it.
    assert_eq!(
        hit([0.0, 0.0, -1.0], [0.0, 0.0, 1.0]).unwrap().radiance,
        [0.0; 3]
    );
    assert_eq!(
        hit([0.0, 0.0, -1.0], [0.0, 0.0, -1.0]).unwrap().radiance,
        [5.0; 3]
    );
    assert_eq!(
        hit([0.0, 0.0, -3.0], [1.0, 0.0, 0.0]).unwrap().radiance,
        [0.0; 3]
    );
    assert_eq!(hit([1.5, 0.0, 2.0], [0.0, 0.0, -1.0]), None);
}

#[test]
fn patterns_are_read_where_a_ray_meets_them_and_their_cells_keep_the_mean() {
    let texels = vec![
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
    ];
    let image = Arc::new(HdrImage::new(2, 2, texels).unwrap());
    let factor = [2.0; 3];
    let screen = of(
        Shape::Mesh(EmitterMesh::quad(2.0, 2.0)),
        Pattern::Texture { image, factor },
    );
    let screen = placed(screen);
    let at = |x: f64, y: f64| {
        screen
            .first_hit(DVec3::new(x, y, 1.0), DVec3::NEG_Z)
            .unwrap()
            .radiance
    };
    let near = |a: [f32; 3], b: [f32; 3]| (0..3).all(|c| (a[c] - b[c]).abs() < 1e-5);
    assert!(
        near(at(-0.5, 0.5), [2.0, 0.0, 0.0]),
        "top left: {:?}",
        at(-0.5, 0.5)
    );
    assert!(near(at(0.5, 0.5), [0.0, 2.0, 0.0]));
    assert!(near(at(-0.5, -0.5), [0.0, 0.0, 2.0]));
    assert!(near(at(0.0, 0.0), [1.0, 1.0, 1.0]));

    let corners = EmitterMesh::quad(2.0, 2.0);
    let pattern = Pattern::PerVertex(vec![[0.0; 3], [1.0; 3], [2.0; 3], [1.0; 3]]);
    let slope = placed(of(Shape::Mesh(corners), pattern));
    let seen = slope
        .first_hit(DVec3::new(0.25, -0.5, 1.0), DVec3::NEG_Z)
        .unwrap();
    assert!((seen.radiance[0] - 0.875).abs() < 1e-6);
    for placed in [&screen, &slope] {
        for polygon in &placed.polygons {
            let placed::Shine::Cells(cells, i) = &polygon.shine else {
                panic!("cells")
            };
            let tree = &cells.triangles[*i].cells;
            let (root, leaves) = (tree[0], &tree[tree.len() / 4..]);
            let mean: f32 =
                leaves.iter().map(|cell| cell.mean[0]).sum::<f32>() / leaves.len() as f32;
            assert!((mean - root.mean[0]).abs() < 1e-5);
            let inside = |cell: &pattern::Cell| (cell.mean[0] - root.mean[0]).abs() <= root.spread;
            assert!(leaves.iter().all(inside));
        }
    }
}

/// A face that is not flat, one that crosses itself, and one without a corner.
fn broken_meshes() -> [EmitterMesh; 3] {
    let quad = || EmitterMesh::quad(1.0, 1.0);
    let bent = EmitterMesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 1.0), DVec3::Y],
        ..quad()
    };
    let crossed = EmitterMesh {
        faces: vec![vec![0, 2, 1, 3]],
        ..quad()
    };
    let missing = EmitterMesh {
        faces: vec![vec![0, 1, 9]],
        ..quad()
    };
    [bent, crossed, missing]
}

#[test]
fn what_is_no_emitter_is_refused_in_one_line() {
    let quad = || EmitterMesh::quad(1.0, 1.0);
    let white = || Pattern::Uniform([1.0; 3]);
    let refused = |emitter: Emitter| Emitters::new(vec![emitter]).unwrap_err().to_string();
    let [bent, crossed, missing] = broken_meshes();
    let mesh = |mesh| of(Shape::Mesh(mesh), white());
    let sheared = DAffine3::from_scale(DVec3::new(1.0, 2.0, 1.0));
    for (message, needle) in [
        (refused(mesh(bent)), "flat and convex"),
        (refused(mesh(crossed)), "flat and convex"),
        (refused(mesh(missing)), "three corners"),
        (
            refused(of(Shape::Mesh(quad()), Pattern::PerFace(vec![]))),
            "0 radiances",
        ),
        (
            refused(of(Shape::Mesh(quad()), Pattern::Uniform([-1.0, 0.0, 0.0]))),
            "not negative",
        ),
        (
            refused(of(Shape::Mesh(quad()), Pattern::Uniform([f32::NAN; 3]))),
            "finite",
        ),
        (
            refused(of(Shape::Sphere { radius: 0.0 }, white())),
            "radius 0",
        ),
        (
            refused(Emitter {
                exponent: 9,
                ..mesh(quad())
            }),
            "exponent 9",
        ),
        (
            refused(Emitter {
                exponent: 1,
                ..of(Shape::Sphere { radius: 1.0 }, white())
            }),
            "sphere",
        ),
        (
            refused(Emitter {
                world_from_emitter: sheared,
                ..mesh(quad())
            }),
            "uniform scale",
        ),
    ] {
        assert!(
            message.contains(needle) && message.contains("lamp"),
            "{message}"
        );
        assert_eq!(message.lines().count(), 1);
    }
}

#[test]
fn faces_without_area_are_left_out_with_their_radiance() {
    let mut mesh = EmitterMesh::blocks(2, 1, 2.0, 1.0, 1.0);
    mesh.faces.insert(1, vec![0, 1, 1]);
    let radiance = vec![[1.0; 3], [2.0; 3], [3.0; 3]];
    let placed = placed(of(Shape::Mesh(mesh), Pattern::PerFace(radiance)));
    assert_eq!(placed.polygons.len(), 2);
    let right = placed
        .first_hit(DVec3::new(0.5, 0.0, 1.0), DVec3::NEG_Z)
        .unwrap();
    assert_eq!(right.radiance, [3.0; 3]);
}

#[test]
fn cells_of_many_emitters_take_no_more_than_those_of_one() {
    let slope = || {
        let pattern = Pattern::PerVertex(vec![[0.0; 3], [1.0; 3], [2.0; 3], [1.0; 3]]);
        of(Shape::Mesh(EmitterMesh::quad(1.0, 1.0)), pattern)
    };
    let cells = |count: usize| -> usize {
        let set = Emitters::new(vec![slope(); count]).unwrap();
        let trees = set.cells.iter().flatten().flat_map(|c| &c.triangles);
        trees.map(|tree| tree.cells.len()).sum()
    };
    // Linear radiance is cut five times: 1 + 4 + … + 4⁵ cells for each of two triangles. Three thousand such are cut four times.
    assert_eq!(cells(1), 2 * 1365);
    assert_eq!(cells(3000), 6000 * 341);
}

#[test]
fn a_mesh_without_any_area_is_no_emitter() {
    let mut mesh = EmitterMesh::quad(1.0, 1.0);
    mesh.faces = vec![vec![0, 1, 1], vec![2, 2, 2]];
    let refused = Emitters::new(vec![of(
        Shape::Mesh(mesh.clone()),
        Pattern::Uniform([1.0; 3]),
    )]);
    let message =
        "emitter \"lamp\": none of its faces has an area; make it larger, or leave it out";
    assert_eq!(refused.unwrap_err().to_string(), message);
    mesh.faces.push(vec![0, 1, 2]);
    let kept = Emitters::new(vec![of(Shape::Mesh(mesh), Pattern::Uniform([1.0; 3]))]).unwrap();
    assert_eq!(kept.placed().polygons().len(), 1);
}
