use glam::DVec3;
use serde_json::json;

use super::super::super::World;
use super::Maker;

#[test]
fn transforms_compose_depth_first_and_instances_share_a_mesh() {
    let mut maker = Maker::triangle();
    let half = std::f64::consts::FRAC_1_SQRT_2;
    maker.json["scenes"] = json!([{"nodes": [4]}, {"nodes": [3, 0]}]);
    maker.json["scene"] = 1.into();
    maker.json["nodes"] = json!([
        {"mesh": 0, "translation": [1, 2, 3], "children": [2, 1]},
        {"mesh": 0, "scale": [2, 3, 4]},
        // A quarter turn about y: x goes to −z. Not normalised, as exporters write it.
        {"rotation": [0, 2.0 * half, 0, 2.0 * half], "children": [5]},
        {"mesh": 0, "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.1, 0, 0, 1]},
        {"mesh": 0},
        {"mesh": 0},
        {"mesh": 0, "scale": [0, 1, 1]}
    ]);
    maker.json["scenes"][1]["nodes"]
        .as_array_mut()
        .unwrap()
        .push(6.into());
    let scene = maker.read().unwrap();
    assert_eq!(scene.meshes.len(), 1);
    let nodes: Vec<usize> = scene.instances.iter().map(|i| i.node).collect();
    assert_eq!(nodes, [3, 0, 5, 1]);
    let at = |i: usize, p: DVec3| scene.instances[i].world_from_object.transform_point3(p);
    // Sums in f64: a tenth stays a tenth.
    assert_eq!(at(0, DVec3::X).x, -1.0 + 0.1);
    assert_eq!(at(1, DVec3::ZERO), DVec3::new(1.0, 2.0, 3.0));
    assert!((at(2, DVec3::X) - DVec3::new(1.0, 2.0, 2.0)).length() < 1e-15);
    assert_eq!(at(3, DVec3::ONE), DVec3::new(3.0, 5.0, 7.0));
    assert!(
        scene
            .warnings
            .iter()
            .any(|w| w.contains("1 meshes were left out"))
    );
    // The mirrored instance is turned back: its normal still faces +z.
    let world = World::new(&scene);
    let [a, b, c] = world.corners(0);
    assert!((b - a).cross(c - a).z > 0.0);

    maker.json.as_object_mut().unwrap().remove("scene");
    assert_eq!(maker.read().unwrap().instances[0].node, 4);
    maker.json.as_object_mut().unwrap().remove("scenes");
    let nodes: Vec<usize> = maker
        .read()
        .unwrap()
        .instances
        .iter()
        .map(|i| i.node)
        .collect();
    assert_eq!(nodes, [0, 5, 1, 3, 4]);
}

#[test]
fn only_trees_of_nodes_are_walked() {
    for (nodes, roots, expected) in [
        (
            json!([{"children": [1, 2]}, {"children": [3]}, {"children": [3]}, {"mesh": 0}]),
            json!([0]),
            "also a child of node 1",
        ),
        (
            json!([{"children": [1]}, {"children": [0], "mesh": 0}]),
            json!([0]),
            "their own ancestors",
        ),
        (
            json!([{"mesh": 0}, {"children": [1]}]),
            json!([0]),
            "their own ancestors",
        ),
        (
            json!([{"children": [1]}, {"mesh": 0}]),
            json!([0, 1]),
            "is not a root",
        ),
        (json!([{"mesh": 0}]), json!([0, 0]), "stands there twice"),
        (
            json!([{"mesh": 0}]),
            json!([7]),
            "names node 7, but there are 1",
        ),
        (
            json!([{"children": [9]}]),
            json!([0]),
            "names node 9, but there are 1",
        ),
        (
            json!([{"mesh": 5}]),
            json!([0]),
            "names mesh 5, but there are 1",
        ),
        (
            json!([{"mesh": 0, "scale": [1e300, 1e300, 1e300], "children": [1]}, {"scale": [1e300, 1, 1]}]),
            json!([0]),
            "not finite",
        ),
    ] {
        let mut maker = Maker::triangle();
        maker.json["nodes"] = nodes;
        maker.json["scenes"][0]["nodes"] = roots;
        let message = maker.message();
        assert!(message.contains(expected), "{message}");
    }
    // Deep chains do not exhaust the stack.
    let mut maker = Maker::triangle();
    let chain = (0..200_000).map(|i| json!({"children": [i + 1]}));
    maker.json["nodes"] = chain.chain([json!({"mesh": 0})]).collect();
    assert_eq!(maker.read().unwrap().instances[0].node, 200_000);
}
