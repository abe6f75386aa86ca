use super::*;
use crate::basis::Order;
use crate::light::project::project;

fn map(layout: Layout, width: usize, height: usize, pixels: Vec<[f32; 3]>) -> EnvMap {
    let image = HdrImage::new(width, height, pixels).unwrap();
    EnvMap::new(image, layout.into()).unwrap()
}

fn constant(layout: Layout, width: usize, height: usize) -> EnvMap {
    map(layout, width, height, vec![[1.0, 0.5, 2.0]; width * height])
}

/// One bright pixel.
fn spot(layout: Layout, [width, height]: [usize; 2], [x, y]: [usize; 2]) -> EnvMap {
    let mut pixels = vec![[0.0; 3]; width * height];
    pixels[y * width + x] = [100.0, 10.0, 1.0];
    map(layout, width, height, pixels)
}

const SIZES: [(Layout, usize, usize); 12] = [
    (Layout::LatLong, 64, 32),
    (Layout::LatLong, 7, 5),
    (Layout::LatLong, 1, 1),
    (Layout::Angular, 65, 65),
    (Layout::Angular, 16, 16),
    (Layout::Angular, 1, 1),
    (Layout::VCross, 48, 64),
    (Layout::VCross, 3, 4),
    (Layout::HCross, 64, 48),
    (Layout::HCross, 4, 3),
    (Layout::Faces, 96, 16),
    (Layout::Faces, 6, 1),
];

#[test]
fn texels_cover_the_sphere_once() {
    for (layout, width, height) in SIZES {
        let map = constant(layout, width, height);
        let mut sum = 0.0;
        for y in 0..height {
            for x in 0..width {
                let solid_angle = map.solid_angle(x, y);
                assert!(solid_angle >= 0.0);
                sum += solid_angle;
            }
        }
        let error = (sum / (4.0 * PI) - 1.0).abs();
        println!("{layout} {width} × {height}: total solid angle off by {error:.1e}, relative");
        // Closed forms to rounding, the angular map by quadrature.
        let bound = if layout == Layout::Angular {
            1e-12
        } else {
            1e-14
        };
        assert!(error < bound, "{layout} {width} × {height}: {error}");
    }
}

#[test]
fn a_constant_map_is_a_constant() {
    let order = Order::new(10).unwrap();
    for (layout, width, height) in SIZES {
        let sums = project(&constant(layout, width, height), order);
        let mean = (4.0 * PI).sqrt();
        let worst = sums
            .iter()
            .enumerate()
            .flat_map(|(i, sum)| {
                let expected = if i == 0 {
                    [mean, 0.5 * mean, 2.0 * mean]
                } else {
                    [0.0; 3]
                };
                (0..3).map(move |channel| (sum[channel] - expected[channel]).abs())
            })
            .fold(0.0, f64::max);
        println!("{layout} {width} × {height}: a constant is off by {worst:.1e}");
        // Lat-long is exact to rounding; the others take points that promise 1e-8 of the mean in each texel.
        let bound = if layout == Layout::LatLong {
            1e-12
        } else {
            1e-8
        };
        assert!(worst < bound, "{layout} {width} × {height}: {worst}");
    }
}

/// The direction that degree 1 points in: (y, z, x) = coefficients 1, 2, 3.
fn degree_one(map: &EnvMap) -> DVec3 {
    let sums = project(map, Order::new(2).unwrap());
    DVec3::new(sums[3][0], sums[1][0], sums[2][0]).normalize()
}

/// By hand, for one bright pixel at a named place: degree 1 points at the centroid of the pixel, which by symmetry is:
/// - lat-long 33 × 17: the middle pixel (16, 8) shows longitude 0, latitude 0: +Z. A quarter of the width to the left is +X: with
///   36 × 17 pixels, column 8 of 0…35 has its middle at u = 8.5/36, longitude 95° east of +Z: (sin 95°, 0, cos 95°).
/// - angular 15 × 15: the middle pixel shows −Z.
/// - vertical cross 9 × 12 (faces of 3 × 3): the middle of each face: top +Y, left −X, middle −Z, right +X, below −Y, lowest +Z.
/// - horizontal cross 12 × 9: the same, and the rightmost is +Z.
/// - faces 18 × 3: the fifth square is Direct3D's +Z, our −Z; the last is +Z.
#[test]
fn one_bright_pixel_shines_from_where_it_is() {
    let cases = [
        (spot(Layout::LatLong, [33, 17], [16, 8]), DVec3::Z),
        (
            spot(Layout::LatLong, [36, 17], [8, 8]),
            DVec3::new(95_f64.to_radians().sin(), 0.0, 95_f64.to_radians().cos()),
        ),
        (spot(Layout::Angular, [15, 15], [7, 7]), DVec3::NEG_Z),
        (spot(Layout::VCross, [9, 12], [4, 1]), DVec3::Y),
        (spot(Layout::VCross, [9, 12], [1, 4]), DVec3::NEG_X),
        (spot(Layout::VCross, [9, 12], [4, 4]), DVec3::NEG_Z),
        (spot(Layout::VCross, [9, 12], [7, 4]), DVec3::X),
        (spot(Layout::VCross, [9, 12], [4, 7]), DVec3::NEG_Y),
        (spot(Layout::VCross, [9, 12], [4, 10]), DVec3::Z),
        (spot(Layout::HCross, [12, 9], [4, 1]), DVec3::Y),
        (spot(Layout::HCross, [12, 9], [1, 4]), DVec3::NEG_X),
        (spot(Layout::HCross, [12, 9], [4, 4]), DVec3::NEG_Z),
        (spot(Layout::HCross, [12, 9], [7, 4]), DVec3::X),
        (spot(Layout::HCross, [12, 9], [10, 4]), DVec3::Z),
        (spot(Layout::HCross, [12, 9], [4, 7]), DVec3::NEG_Y),
        (spot(Layout::Faces, [18, 3], [13, 1]), DVec3::NEG_Z),
        (spot(Layout::Faces, [18, 3], [16, 1]), DVec3::Z),
    ];
    for (map, expected) in cases {
        let got = degree_one(&map);
        assert!(
            got.distance(expected) < 1e-9,
            "{}: {got} for {expected}",
            map.layout()
        );
    }
}

/// By hand: in the angular map the ring half way to the rim is at right angles to −Z. A pixel there, above the centre, shows +Y, but
/// the pixel is wide, so the centroid leans a little; a small pixel bounds the lean by its size, 2π/255.
#[test]
fn the_ring_half_way_out_of_an_angular_map_is_across_the_axis() {
    for (x, y, expected) in [
        (127, 63, DVec3::Y),
        (127, 191, DVec3::NEG_Y),
        (191, 127, DVec3::X),
        (63, 127, DVec3::NEG_X),
    ] {
        let got = degree_one(&spot(Layout::Angular, [255, 255], [x, y]));
        assert!(
            got.distance(expected) < PI / 255.0,
            "({x}, {y}): {got} for {expected}"
        );
    }
}

/// Σ Ω Y over the cells of a fine grid inside one texel, Ω = |∂D/∂u × ∂D/∂v| du dv from the layout's own directions.
fn brute_force(
    layout: Layout,
    [width, height]: [usize; 2],
    [x, y]: [usize; 2],
    order: Order,
) -> Vec<f64> {
    let fine = 300;
    let mut sums = vec![0.0; order.count()];
    for i in 0..fine {
        for j in 0..fine {
            let u = (x as f64 + (i as f64 + 0.5) / fine as f64) / width as f64;
            let v = (y as f64 + (j as f64 + 0.5) / fine as f64) / height as f64;
            let h = 1e-6;
            let at = |du: f64, dv: f64| layout.direction(u + du, v + dv);
            let near = (
                at(h, 0.0),
                at(-h, 0.0),
                at(0.0, h),
                at(0.0, -h),
                at(0.0, 0.0),
            );
            if let (Some(right), Some(left), Some(down), Some(up), Some(d)) = near {
                let area = (right - left).cross(down - up).length() / (4.0 * h * h);
                let cell = area / (fine * fine * width * height) as f64;
                for (sum, value) in sums.iter_mut().zip(crate::basis::sh::eval(order, d)) {
                    *sum += cell * value;
                }
            }
        }
    }
    sums
}

/// Single texels against brute force. Covers the separable path, whose axes are turned, and the rim of a disc.
#[test]
fn texels_are_patches_of_constant_radiance() {
    let order = Order::new(6).unwrap();
    for (layout, size, place) in [
        (Layout::LatLong, [8, 4], [6, 0]),
        (Layout::LatLong, [5, 3], [1, 2]),
        (Layout::Angular, [6, 6], [4, 1]),
        (Layout::Angular, [8, 8], [0, 3]),
        (Layout::Angular, [8, 8], [1, 1]),
        (Layout::VCross, [3, 4], [1, 3]),
        (Layout::VCross, [6, 8], [2, 6]),
        (Layout::HCross, [8, 6], [7, 2]),
    ] {
        let expected = brute_force(layout, size, place, order);
        let got = project(&spot(layout, size, place), order);
        for (i, (got, expected_i)) in got.iter().zip(&expected).enumerate() {
            let error = (got[0] / 100.0 - expected_i).abs() / expected[0];
            // The midpoint rule over 300 × 300 cells; at the rim of the disc, cells are in or out.
            assert!(
                error < 2e-4,
                "{layout} {size:?} {place:?}, coefficient {i}: off by {error}"
            );
        }
        let solid_angle = spot(layout, size, place).solid_angle(place[0], place[1]);
        let from_sum = expected[0] * (4.0 * PI).sqrt();
        assert!(
            (solid_angle / from_sum - 1.0).abs() < 2e-4,
            "{layout} {size:?} {place:?}"
        );
    }
}

/// Texel centres get their own value back, and neighbours blend, also over the edges of faces, the poles and the seam.
#[test]
fn lookups_interpolate_without_seams() {
    // A function that is linear over the sphere, so that bilinear lookups are close to it everywhere.
    let shade = |d: DVec3| [2.0 + d.x, 2.0 + d.y, 2.0 + d.z].map(|value| value as f32);
    for (layout, width, height) in [
        (Layout::LatLong, 128, 64),
        (Layout::Angular, 128, 128),
        (Layout::VCross, 96, 128),
        (Layout::HCross, 128, 96),
    ] {
        let mut pixels = Vec::new();
        for y in 0..height {
            for x in 0..width {
                let (u, v) = (
                    (x as f64 + 0.5) / width as f64,
                    (y as f64 + 0.5) / height as f64,
                );
                // Outside: a value that would show.
                pixels.push(layout.direction(u, v).map_or([1e6; 3], shade));
            }
        }
        let map = map(layout, width, height, pixels);
        for i in 0..4000 {
            let z = 1.0 - (2 * i + 1) as f64 / 4000.0;
            let turn = f64::from(i) * 2.399_963;
            let ring = (1.0 - z * z).sqrt();
            let d = DVec3::new(ring * turn.cos(), z, ring * turn.sin());
            let (got, expected) = (map.radiance(d), shade(d));
            for channel in 0..3 {
                // A texel is up to 2π/128 = 0.05 wide.
                assert!(
                    (got[channel] - expected[channel]).abs() < 0.025,
                    "{layout} {d}: {got:?} for {expected:?}"
                );
            }
        }
        for d in [
            DVec3::X,
            DVec3::Y,
            DVec3::Z,
            DVec3::ONE,
            DVec3::ZERO,
            DVec3::NAN,
        ] {
            for d in [d, -d] {
                assert!(map.radiance(d).iter().all(|value| value.is_finite()));
            }
        }
    }
}

#[cfg(feature = "bake")]
#[test]
fn projection_has_the_same_bits_on_any_number_of_threads() {
    let order = Order::new(5).unwrap();
    for layout in Layout::ALL {
        let (width, height) = match layout {
            Layout::LatLong => (40, 20),
            Layout::Angular => (40, 40),
            Layout::VCross => (30, 40),
            Layout::HCross => (40, 30),
            Layout::Faces => (60, 10),
        };
        let pixels = (0..width * height)
            .map(|i| {
                [
                    (i * 37 % 101) as f32 / 7.0,
                    (i * 53 % 97) as f32,
                    1.0 / (i + 1) as f32,
                ]
            })
            .collect();
        let map = map(layout, width, height, pixels);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.unwrap().install(|| project(&map, order))
        };
        assert_eq!(on(1), on(7));
    }
}
