//! What is not written, and how large what is written becomes.

use super::*;
use crate::basis::Order;
use crate::files::Rows;

/// A change that spoils something, and how the error begins or what it holds.
type Case<'a, T> = (&'a dyn Fn(&mut T), &'a str);

#[test]
fn the_predicted_size_is_an_upper_bound_and_close() {
    let halves = [samples::asset(), imported()].map(halves::halved);
    for asset in [samples::asset(), imported()].into_iter().chain(halves) {
        let Transfer {
            order,
            channels,
            precision,
            ..
        } = asset.transfer;
        let predicted = predicted_size(&asset.scene, channels * order.count(), precision).unwrap();
        let actual = glb(&asset).len() as u64;
        assert!(predicted >= actual, "{predicted} for {actual}");
        let (vector, json) = (describe(&asset).bytes_per_vertex as u64, 1500);
        let slack = asset.scene.vertex_count() as u64 * (vector + 5);
        assert!(predicted <= actual + slack + json * asset.scene.instances.len() as u64);
    }
    let mut scene = samples::scene();
    scene.instances = vec![scene.instances[0].clone(); 11_000];
    let order = Order::new(32).unwrap();
    // 110,000 vertices of 12 KiB each for three channels would fit; four times that goes beside the file.
    let size = predicted_size(&scene, 12 * order.count(), Precision::F32).unwrap();
    assert!(size > 110_000 * 4 * 12 * 1024, "{size}");
}

#[test]
fn what_a_glb_cannot_say_is_refused_before_the_bake() {
    let order = Order::new(2).unwrap();
    let refused = |change: &dyn Fn(&mut Scene)| {
        let mut scene = samples::scene();
        change(&mut scene);
        predicted_size(&scene, order.count(), Precision::F16)
            .unwrap_err()
            .to_string()
    };
    let sheared = glam::DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 1.0]);
    let sheared = glam::DAffine3::from_mat3(sheared);
    let cases: [Case<'_, Scene>; 8] = [
        (
            &|s| s.instances[1].mesh = 2,
            "instance 1 names a mesh, material or vertex",
        ),
        (
            &|s| s.meshes[0].groups[1].triangles[0][2] = 17,
            "instance 1 names a mesh, material or",
        ),
        (
            &|s| s.instances[1].world_from_object = sheared,
            "instance \"1\" is sheared",
        ),
        (
            &|s| s.meshes[0].colors[2][1] = 1.5,
            "mesh \"fern\" has vertex colours outside",
        ),
        (
            &|s| s.meshes[1].groups.clear(),
            "mesh \"plate\" has no triangles",
        ),
        (
            &|s| s.meshes[0].positions[3].x = f32::NAN,
            "mesh \"fern\" has coordinates that",
        ),
        (
            &|s| s.meshes[0].normals[3] *= 2.0,
            "mesh \"fern\" has normals that",
        ),
        (
            &|s| s.materials[0].base_color[1] = 2.0,
            "material \"brass\" has a base colour outside",
        ),
    ];
    for (change, expected) in cases {
        let error = refused(change);
        assert!(error.starts_with(expected), "{error}");
    }
}

#[test]
fn transfer_that_does_not_fit_is_not_written() {
    let cases: [Case<'_, Transfer>; 6] = [
        (&|t| _ = t.valid.pop(), "transfer vectors for"),
        (
            &|t| t.coefficients = t.coefficients[1..].to_vec().into(),
            "number of coefficients",
        ),
        (
            &|t| t.coefficients[5] = f32::INFINITY,
            "coefficient 5 is not finite",
        ),
        (&|t| t.channels = 2, "2 channels"),
        (
            &|t| t.back.as_mut().unwrap().vertices.swap(0, 1),
            "ascending",
        ),
        (
            &|t| t.back.as_mut().unwrap().coefficients = Rows::default(),
            "number of coefficients",
        ),
    ];
    for (change, expected) in cases {
        let mut asset = samples::asset();
        change(&mut asset.transfer);
        let error = to_glb(&asset).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}
