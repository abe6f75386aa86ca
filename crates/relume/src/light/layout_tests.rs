use std::f64::consts::FRAC_1_SQRT_2;

use super::*;

fn close(layout: Layout, u: f64, v: f64, expected: [f64; 3]) {
    let expected = DVec3::from_array(expected);
    let d = layout.direction(u, v).unwrap();
    assert!(
        d.distance(expected) < 1e-15 * 4.0,
        "{layout} ({u}, {v}): {d} for {expected}"
    );
}

/// By hand, from the definition: longitude 0 is +Z in the centre; going left it grows to π/2, a quarter of the width away at
/// u = 1/4, which is +X; so −X is at u = 3/4, and both ends are −Z. The top row is the latitude +π/2, +Y.
/// Half way up (v = 1/4, latitude π/4) above the centre, y and z are equal.
#[test]
fn lat_long_has_z_in_the_centre_and_x_on_the_left() {
    let layout = Layout::LatLong;
    close(layout, 0.5, 0.5, [0.0, 0.0, 1.0]);
    close(layout, 0.25, 0.5, [1.0, 0.0, 0.0]);
    close(layout, 0.75, 0.5, [-1.0, 0.0, 0.0]);
    close(layout, 0.0, 0.5, [0.0, 0.0, -1.0]);
    close(layout, 1.0, 0.5, [0.0, 0.0, -1.0]);
    close(layout, 0.3, 0.0, [0.0, 1.0, 0.0]);
    close(layout, 0.3, 1.0, [0.0, -1.0, 0.0]);
    close(layout, 0.5, 0.25, [0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2]);
    // An eighth of the width left of the centre: longitude π/4, so x = z.
    close(layout, 0.375, 0.5, [FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2]);
}

/// By hand: the centre is −Z. Half way to the rim r = 1/2, so the angle from −Z is π/2: to the right +X, up +Y. A quarter of the
/// way to the right, the angle is π/4. The rim is +Z all round; beyond it is nothing.
#[test]
fn angular_maps_have_minus_z_in_the_centre_and_plus_z_at_the_rim() {
    let layout = Layout::Angular;
    close(layout, 0.5, 0.5, [0.0, 0.0, -1.0]);
    close(layout, 0.75, 0.5, [1.0, 0.0, 0.0]);
    close(layout, 0.5, 0.25, [0.0, 1.0, 0.0]);
    close(layout, 0.625, 0.5, [FRAC_1_SQRT_2, 0.0, -FRAC_1_SQRT_2]);
    close(layout, 1.0, 0.5, [0.0, 0.0, 1.0]);
    close(layout, 0.5, 0.0, [0.0, 0.0, 1.0]);
    assert_eq!(layout.direction(0.95, 0.95), None);
}

/// By hand, standing inside the cube: ahead is −Z, its picture in the middle. To the right of it is +X, to the left −X, above +Y,
/// below −Y. Looking at +X its picture's right edge touches +Z, so three quarters across that square is between +X and +Z: s = 1/2,
/// direction (1, 0, 1/2). Folding the strip down: below −Y follows +Z hanging upside down; its top edge touches −Y.
#[test]
fn crosses_fold_into_a_cube_around_minus_z() {
    for (layout, columns, rows) in [(Layout::VCross, 3.0, 4.0), (Layout::HCross, 4.0, 3.0)] {
        let at = |x: f64, y: f64, expected| close(layout, x / columns, y / rows, expected);
        at(1.5, 1.5, [0.0, 0.0, -1.0]);
        at(2.5, 1.5, [1.0, 0.0, 0.0]);
        at(0.5, 1.5, [-1.0, 0.0, 0.0]);
        at(1.5, 0.5, [0.0, 1.0, 0.0]);
        at(1.5, 2.5, [0.0, -1.0, 0.0]);
        let n = 1.25_f64.sqrt();
        at(2.75, 1.5, [1.0 / n, 0.0, 0.5 / n]);
        // The upper half of the square above touches +Z, so t = 1/2 leans to +Z.
        at(1.5, 0.25, [0.0, 1.0 / n, 0.5 / n]);
        at(1.5, 1.25, [0.0, 0.5 / n, -1.0 / n]);
        assert_eq!(layout.direction(0.1, 0.1), None);
    }
    // Upper half of the lowest square: near −Y.
    let n = 1.25_f64.sqrt();
    let at = |x: f64, y: f64, expected| close(Layout::VCross, x / 3.0, y / 4.0, expected);
    at(1.5, 3.5, [0.0, 0.0, 1.0]);
    at(1.5, 3.25, [0.0, -0.5 / n, 1.0 / n]);
    // Its right half lies below the right half of −Y, which is +X.
    at(1.75, 3.5, [0.5 / n, 0.0, 1.0 / n]);
    // In the horizontal cross the last square follows +X; its left half is the one near +X.
    let at = |x: f64, y: f64, expected| close(Layout::HCross, x / 4.0, y / 3.0, expected);
    at(3.5, 1.5, [0.0, 0.0, 1.0]);
    at(3.25, 1.5, [0.5 / n, 0.0, 1.0 / n]);
}

#[test]
fn neighbouring_squares_meet_in_the_same_directions() {
    let eps = 1e-9;
    for (layout, w, h) in [(Layout::VCross, 3.0, 4.0), (Layout::HCross, 4.0, 3.0)] {
        for x in 0..w as usize {
            for y in 0..h as usize {
                let across = |along: f64| {
                    let (x, y) = ((x + 1) as f64, y as f64 + along);
                    (((x - eps) / w, y / h), ((x + eps) / w, y / h))
                };
                let down = |along: f64| {
                    let (x, y) = (x as f64 + along, (y + 1) as f64);
                    ((x / w, (y - eps) / h), (x / w, (y + eps) / h))
                };
                for (p, q) in [across(0.1), across(0.9), down(0.2), down(0.7)] {
                    if p.0.max(q.0) > 1.0 || p.1.max(q.1) > 1.0 {
                        continue;
                    }
                    let pair = (layout.direction(p.0, p.1), layout.direction(q.0, q.1));
                    if let (Some(p), Some(q)) = pair {
                        assert!(p.distance(q) < 1e-7, "{layout} at {x}, {y}");
                    }
                }
            }
        }
    }
}

#[test]
fn place_inverts_direction_everywhere() {
    for layout in Layout::ALL {
        let mut tried = 0;
        for i in 0..97 {
            for j in 0..89 {
                let (u, v) = ((i as f64 + 0.37) / 97.0, (j as f64 + 0.61) / 89.0);
                let Some(d) = layout.direction(u, v) else {
                    continue;
                };
                assert!((d.length() - 1.0).abs() < 1e-14);
                let (u2, v2) = layout.place(3.0 * d);
                assert!(
                    (u - u2).abs() < 1e-12 && (v - v2).abs() < 1e-12,
                    "{layout}: ({u}, {v}) came back as ({u2}, {v2})"
                );
                tried += 1;
            }
        }
        assert!(tried > 97 * 89 * 2 / 5);
    }
}

#[test]
fn shapes_suggest_layouts_and_misfits_are_refused() {
    assert_eq!(Layout::guess(2048, 1024), Ok(Layout::LatLong));
    assert_eq!(Layout::guess(512, 512), Ok(Layout::Angular));
    assert_eq!(Layout::guess(768, 1024), Ok(Layout::VCross));
    assert_eq!(Layout::guess(1024, 768), Ok(Layout::HCross));
    let error = Layout::guess(1000, 513).unwrap_err().to_string();
    assert!(error.contains("1000 × 513") && error.contains("--layout"));
    assert!(
        LayoutChoice::Fixed(Layout::VCross)
            .resolve(1024, 768)
            .is_err()
    );
    assert!(
        LayoutChoice::Fixed(Layout::LatLong)
            .resolve(1000, 513)
            .is_ok()
    );
    assert!(Layout::guess(0, 0).is_err());
}

#[test]
fn names_go_both_ways() {
    for layout in Layout::ALL {
        assert_eq!(layout.to_string().parse(), Ok(layout));
        let choice = LayoutChoice::Fixed(layout);
        assert_eq!(choice.to_string().parse(), Ok(choice));
    }
    assert_eq!("auto".parse(), Ok(LayoutChoice::Auto));
    assert_eq!(LayoutChoice::Auto.to_string(), "auto");
    assert!("mercator".parse::<LayoutChoice>().is_err());
}

/// By hand. Direct3D's cube is left-handed: u to the right and v down on a face, the point (x, y, z) it shows is, for px (1, −v, −u),
/// nx (−1, −v, u), py (u, 1, v), ny (u, −1, −v), pz (u, −v, 1), nz (−u, −v, −1). Turning z over makes it our right-handed one. Taken three
/// quarters across and three quarters down each face, u = v = 1/2.
#[test]
fn the_faces_of_direct3d_are_seen_from_inside_with_z_turned_over() {
    let n = 1.5_f64.sqrt();
    for (face, [x, y, z]) in [
        [1.0, -0.5, -0.5],
        [-1.0, -0.5, 0.5],
        [0.5, 1.0, 0.5],
        [0.5, -1.0, -0.5],
        [0.5, -0.5, 1.0],
        [-0.5, -0.5, -1.0],
    ]
    .into_iter()
    .enumerate()
    {
        let u = (face as f64 + 0.75) / 6.0;
        close(Layout::Faces, u, 0.75, [x / n, y / n, -z / n]);
    }
    assert_eq!(Layout::guess(384, 64), Ok(Layout::Faces));
}
