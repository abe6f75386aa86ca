//! What is written is read back.

use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3};

use super::*;
use crate::light::HdrImage;
use crate::light::emitter::Shape;

fn emitters() -> Vec<Emitter> {
    let mesh = |mesh| Shape::Mesh(mesh);
    let emitter = |name: &str, shape, pattern| Emitter {
        name: name.to_owned(),
        shape,
        pattern,
        two_sided: false,
        exponent: 0,
        world_from_emitter: DAffine3::IDENTITY,
    };
    let mut falling = emitter(
        "a \"name\"\n",
        mesh(EmitterMesh::disc(0.3)),
        Pattern::Uniform([0.1, 1e20, 1e-30]),
    );
    (falling.two_sided, falling.exponent) = (true, 5);
    falling.world_from_emitter = DAffine3::from_scale_rotation_translation(
        DVec3::splat(0.037),
        DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -3.0).normalize(), 2.7),
        DVec3::new(1e5, -2.0, 0.1),
    );
    let faces = Pattern::PerFace((0..6).map(|i| [i as f32, 0.3, 0.7]).collect());
    let corners = Pattern::PerVertex(vec![[0.1; 3], [0.2; 3], [0.0, 5.0, 1.0], [1.0; 3]]);
    let mut turned = emitter("half", mesh(EmitterMesh::quad(2.0, 1.0)), corners);
    turned.world_from_emitter = DAffine3::from_quat(DQuat::from_rotation_y(std::f64::consts::PI));
    vec![
        emitter(
            "ball",
            Shape::Sphere { radius: 0.25 },
            Pattern::Uniform([3.0; 3]),
        ),
        falling,
        emitter(
            "box",
            mesh(EmitterMesh::cuboid(DVec3::new(1.0, 2.0, 3.0))),
            faces,
        ),
        turned,
    ]
}

#[test]
fn everything_but_textures_comes_back() {
    let set = Emitters::new(emitters()).unwrap();
    let text = to_json(&set).unwrap();
    let (back, warnings) = from_json(text.as_bytes(), Path::new("")).unwrap();
    assert_eq!(warnings, [""; 0]);
    assert_eq!(back.emitters().len(), set.emitters().len());
    for (a, b) in set.emitters().iter().zip(back.emitters()) {
        let (mut a, mut b) = (a.clone(), b.clone());
        let (from, to) = (a.world_from_emitter, b.world_from_emitter);
        for i in 0..3 {
            let size = from.matrix3.col(i).length();
            assert!((from.matrix3.col(i) - to.matrix3.col(i)).length() < 1e-12 * size);
        }
        assert_eq!(from.translation, to.translation);
        b.world_from_emitter = from;
        if let (Shape::Mesh(a), Shape::Mesh(b)) = (&mut a.shape, &mut b.shape) {
            // Only textures need them.
            (a.uvs, b.uvs) = (Vec::new(), Vec::new());
        }
        assert_eq!(a, b);
    }
    assert_eq!(
        to_json(&back).unwrap().lines().count(),
        text.lines().count()
    );
}

#[test]
fn textures_are_refused_and_so_are_meshes_that_are_none() {
    let mut set = emitters();
    let Shape::Mesh(_) = set[3].shape else {
        panic!("a quad");
    };
    set[3].pattern = Pattern::Texture {
        image: Arc::new(HdrImage::decode(&pfm()).unwrap().0),
        factor: [1.0; 3],
    };
    let refused = line(to_json(&Emitters::new(set).unwrap()));
    assert!(refused.contains("\"half\" has a texture"), "{refused}");
    let corners = json!([[0, 0, 0], [1, 0, 0], [0, 1, 0]]);
    for (mesh, said) in [
        (json!({"positions": corners}), "\"mesh\""),
        (
            json!({"positions": corners, "faces": [[0, 1, 1.5]]}),
            "\"mesh\"",
        ),
        (
            json!({"positions": corners, "faces": [[0, 1, 2]], "uvs": []}),
            "\"mesh\"",
        ),
        (json!({"positions": corners, "faces": [[0, 1, 3]]}), "3"),
        (json!({"positions": corners, "faces": [[0, 1]]}), "corners"),
        (json!({"positions": corners, "faces": []}), "face"),
    ] {
        let entry = json!({"mesh": mesh, "radiance": 1});
        let refused = line(in_folder(Path::new(""), &entry));
        assert!(refused.contains(said), "{refused}");
    }
    let entry = json!({"mesh": {"positions": corners, "faces": [[0, 1, 2]]}, "radiance": 1});
    let Shape::Mesh(mesh) = one(&entry).shape else {
        panic!("a mesh");
    };
    assert_eq!(mesh.faces, [[0, 1, 2]]);
}
