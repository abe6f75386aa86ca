//! Poses, against directions worked out by hand.

use glam::DVec3;

use super::*;

/// Where the pose of a quad takes its +x, +y and +z, and its middle.
fn axes(pose: Value) -> ([DVec3; 3], DVec3) {
    let mut entry = pose;
    entry["quad"] = json!([1, 1]);
    entry["radiance"] = json!(1);
    let pose = one(&entry).world_from_emitter;
    (
        DVec3::AXES.map(|axis| pose.transform_vector3(axis)),
        pose.translation,
    )
}

fn near(found: [DVec3; 3], expected: [[f64; 3]; 3]) {
    for (a, b) in found.into_iter().zip(expected) {
        // A dozen operations on numbers of size 1.
        assert!(a.distance(b.into()) < 1e-14, "{found:?} for {expected:?}");
    }
}

#[test]
fn a_position_moves_and_a_scale_stretches_about_it() {
    let (found, middle) = axes(json!({"position": [1, 2, 3], "scale": 2}));
    near(found, [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]]);
    assert_eq!(middle, DVec3::new(1.0, 2.0, 3.0));
}

#[test]
fn turns_are_right_handed_and_apply_in_order() {
    // A quarter about +y brings +z to +x and +x to −z.
    let (found, _) = axes(json!({"rotate": [[0, 1, 0, 90]]}));
    near(found, [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]);
    // Then a quarter about +z brings +x to +y and +y to −x. The position is not turned.
    let (found, middle) =
        axes(json!({"rotate": [[0, 2, 0, 90], [0, 0, 1, 90]], "position": [5, 0, 0]}));
    near(found, [[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(middle, DVec3::new(5.0, 0.0, 0.0));
    let (found, _) = axes(json!({"rotate": []}));
    near(found, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
}

#[test]
fn the_side_that_shines_looks_at_the_target_with_its_top_up() {
    // Ahead: nothing turns.
    let (found, _) = axes(json!({"target": [0, 0, 7]}));
    near(found, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    // To +x: right-handed, up stays +y, so x goes to −z.
    let (found, _) = axes(json!({"target": [3, 0, 0]}));
    near(found, [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]);
    // From (0, 1, 0) to (0, 0, 1): down at 45°; the top leans forward, x stays.
    let half = 0.5_f64.sqrt();
    let (found, _) = axes(json!({"position": [0, 1, 0], "target": [0, 0, 1]}));
    near(
        found,
        [[1.0, 0.0, 0.0], [0.0, half, half], [0.0, -half, half]],
    );
}

#[test]
fn straight_up_or_down_the_top_is_toward_x() {
    // z = −y and y = +x make x = y × z = +x × −y = −z.
    let (found, _) = axes(json!({"position": [1, 2, 3], "target": [1, 0, 3], "scale": 3}));
    near(found, [[0.0, 0.0, -3.0], [3.0, 0.0, 0.0], [0.0, -3.0, 0.0]]);
    // z = +y and y = +x make x = +x × +y = +z.
    let (found, _) = axes(json!({"target": [0, 4, 0]}));
    near(found, [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
}
