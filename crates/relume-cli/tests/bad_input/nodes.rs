//! glTF nodes that are no tree.

use serde_json::{Value, json};

use super::case::Case;
use super::gltf::changed;

pub fn cases() -> Vec<Case> {
    let tree = |nodes: Value| changed(move |json, _| json["nodes"] = nodes);
    // Each of 28 levels names both nodes of the next: 57 nodes and 2^28 ways down.
    let diamonds: Vec<Value> = (0..57)
        .map(|i| {
            let next = (i + 1) / 2 * 2 + 1;
            match next {
                57.. => json!({"mesh": 0}),
                _ => json!({"children": [next, next + 1]}),
            }
        })
        .collect();
    let crowd = changed(|json, _| {
        json["accessors"][0] = json!({"componentType": 5126, "type": "VEC3", "count": 1 << 24});
        json["nodes"] = vec![json!({"mesh": 0}); 1000].into();
        json["scenes"][0]["nodes"] = (0..1000).collect();
    });
    [
        (
            "a node that is its own child",
            tree(json!([{"mesh": 0, "children": [0]}])),
            "re-export",
        ),
        (
            "a circle of nodes",
            tree(json!([{"mesh": 0}, {"children": [2]}, {"children": [1]}])),
            "own ancestors",
        ),
        (
            "57 nodes and 2^28 ways down",
            tree(diamonds.into()),
            "also a child of node",
        ),
        (
            "the same child twice",
            tree(json!([{"children": [1, 1]}, {"mesh": 0}])),
            "also a child of node 0",
        ),
        (
            "a child that is not there",
            tree(json!([{"mesh": 0, "children": [5]}])),
            "node 5",
        ),
        (
            "a mesh that is not there",
            tree(json!([{"mesh": 3}])),
            "mesh 3",
        ),
        (
            "a scene that is not there",
            changed(|json, _| json["scene"] = 4.into()),
            "scene 4",
        ),
        (
            "a scene that begins with a child",
            changed(|json, _| {
                json["nodes"] = json!([{"mesh": 0}, {"children": [0]}]);
            }),
            "not a root",
        ),
        (
            "a scene with a node twice",
            changed(|json, _| json["scenes"][0]["nodes"] = json!([0, 0])),
            "stands there twice",
        ),
        (
            "a material that is not there",
            changed(|json, _| json["meshes"][0]["primitives"][0]["material"] = 2.into()),
            "material 2",
        ),
        (
            "1000 instances of 2^24 vertices",
            crowd,
            "more than the 134217728",
        ),
    ]
    .into_iter()
    .map(|(name, bytes, part)| Case::scene(name, "a.glb", bytes, part))
    .collect()
}
