//! Cube maps of the device against those of the CPU, and against the closed form.

use glam::{DQuat, DVec3};
use relume::basis::Order;
use relume::light::HdrImage;
use relume::light::emitter::{
    ClosedForm, CubeMap, EmitterMesh, Incident, Pattern, Placed, Sampler, Shape,
};
use relume_gpu::{CubeSampler, GpuError};

use crate::device::{Gpu, on_each_back_end};
use crate::emitters::{emitter, panel, placed};

on_each_back_end! {
    faces_are_those_of_the_cpu
    black_bodies_and_black_backs_are_told_apart
    exponents_and_radiance_by_vertex_are_those_of_the_cpu
    spheres_are_those_of_the_cpu
    many_points_are_many_rows
    it_nears_the_closed_form
    nothing_is_seen_of_nothing
    what_does_not_fit_is_refused
}

/// In f32 against f64: radiance times a weight of 24 bits each, some thousand of them in sums of 6·32 and then 32.
const ROUNDING: f64 = 1e-5;

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

fn sampler(gpu: &Gpu, n: usize, size: u32) -> CubeSampler {
    CubeSampler::new(&gpu.device, &gpu.queue, order(n), size).unwrap()
}

fn points() -> Vec<DVec3> {
    let point = |i: i32| {
        let [x, y, z] = [7, 31, 59].map(|k| f64::from(i * k % 23) / 23.0 - 0.5);
        DVec3::new(x, y, z)
    };
    (0..9).map(point).collect()
}

/// The largest difference of two samples: of coefficients as a share of what radiance `largest` all around would give, of solid angles of 4π, of inverse
/// distances of 4π/m.
fn apart(a: &Incident, b: &Incident, largest: f64) -> f64 {
    let all = 4.0 * std::f64::consts::PI;
    let pairs = a
        .coefficients
        .iter()
        .flatten()
        .zip(b.coefficients.iter().flatten());
    let coefficients = pairs.map(|(a, b)| (a - b).abs() / (largest * all.sqrt()));
    coefficients
        .chain([
            (a.solid_angle - b.solid_angle).abs() / all,
            (a.inverse_distance - b.inverse_distance).abs() / all,
        ])
        .fold(0.0, f64::max)
}

/// The device and the CPU, but for `flips` pixels that the rasteriser gives to the other side of an edge. A pixel is 4/k² steradians at most, and no basis function of the
/// orders here is larger than 2.
fn check(gpu: &Gpu, name: &str, placed: &Placed, n: usize, largest: f64, flips: f64) {
    let k = 32;
    let found = sampler(gpu, n, k).sample(placed, &points()).unwrap();
    let twin = CubeMap::new(order(n), k);
    let mut most = 0.0_f64;
    for (found, &at) in found.iter().zip(&points()) {
        let expected = twin.sample(placed, at);
        assert!(expected.solid_angle > 0.05, "{name}: nothing to see");
        most = most.max(apart(found, &expected, largest));
    }
    println!("{name}: {most:.1e}");
    let pixel = 4.0 / f64::from(k * k);
    let share = 2.0 * pixel / (4.0 * std::f64::consts::PI).sqrt();
    assert!(most < ROUNDING + flips * share, "{name}: {most:e}");
}

/// Lamps on all sides, one behind another, one on both of whose sides points stand.
fn lamps() -> Vec<relume::light::emitter::Emitter> {
    let mut both = panel(0.4, [1.0, 2.0, 3.0], [0.1, 0.2, 0.1], [1.0, 0.3, 0.2]);
    both.two_sided = true;
    let disc = Shape::Mesh(EmitterMesh::disc(0.7));
    vec![
        panel(1.1, [3.0, 2.0, 1.0], [0.3, 1.5, 0.2], [0.1, -1.0, 0.05]),
        panel(4.0, [1.0, 1.0, 2.0], [0.2, 3.0, 0.1], [0.02, -1.0, 0.03]),
        emitter(
            disc,
            [2.0; 3],
            [-1.6, 0.1, 0.3],
            DQuat::from_rotation_y(1.4),
        ),
        panel(0.9, [1.0, 3.0, 1.0], [0.2, -0.3, -1.7], [0.0, 0.1, 1.0]),
        both,
    ]
}

fn faces_are_those_of_the_cpu(gpu: &Gpu) {
    let lamps = placed(lamps());
    for n in [1, 4, 5] {
        check(gpu, &format!("order {n}"), &lamps, n, 3.0, 2.0);
    }
}

fn black_bodies_and_black_backs_are_told_apart(gpu: &Gpu) {
    // A black front covers solid angle; a black back hides, and does not count.
    let front = panel(1.0, [0.0; 3], [0.0, 1.2, 0.1], [0.0, -1.0, 0.0]);
    let back = panel(1.0, [5.0; 3], [1.4, 0.1, 0.0], [1.0, 0.0, 0.0]);
    let behind = panel(3.0, [4.0; 3], [2.6, 0.1, 0.0], [-1.0, 0.0, 0.0]);
    let placed = placed(vec![front, back, behind]);
    check(gpu, "black", &placed, 3, 4.0, 1.0);
    let at = DVec3::new(0.1, 0.0, 0.0);
    let seen = sampler(gpu, 3, 32).sample(&placed, &[at]).unwrap();
    let (all, found) = (CubeMap::new(order(3), 32).sample(&placed, at), &seen[0]);
    assert!(found.solid_angle > 0.3 && (found.solid_angle - all.solid_angle).abs() < 0.02);
}

fn exponents_and_radiance_by_vertex_are_those_of_the_cpu(gpu: &Gpu) {
    let mut lobe = panel(1.5, [3.0, 2.0, 1.0], [0.2, 1.5, 0.1], [0.3, -1.0, 0.1]);
    lobe.exponent = 4;
    let mut slope = panel(1.4, [1.0; 3], [-1.5, 0.1, 0.2], [1.0, 0.1, 0.0]);
    slope.pattern = Pattern::PerVertex(vec![[0.0; 3], [1.0; 3], [3.0; 3], [2.0, 0.0, 1.0]]);
    let mut blocks = EmitterMesh::blocks(3, 2, 2.0, 2.0, 0.7);
    blocks.uvs.clear();
    // Turned, so that no edge runs along a row of pixels.
    let mut blocks = emitter(
        Shape::Mesh(blocks),
        [1.0; 3],
        [0.1, 0.0, -1.8],
        DQuat::from_rotation_z(0.3),
    );
    blocks.pattern = Pattern::PerFace((0..6).map(|i| [i as f32 * 0.5, 1.0, 2.0]).collect());
    for (name, emitter, flips) in [
        ("exponent", lobe, 1.0),
        ("by vertex", slope, 1.0),
        ("by face", blocks, 1.0),
    ] {
        check(gpu, name, &placed(vec![emitter]), 5, 3.0, flips);
    }
}

fn spheres_are_those_of_the_cpu(gpu: &Gpu) {
    let globe =
        |radius, radiance, at| emitter(Shape::Sphere { radius }, radiance, at, DQuat::IDENTITY);
    let mut around = globe(9.0, [0.5, 0.4, 0.3], [1.0, 0.0, 0.0]);
    let small = globe(0.5, [3.0, 1.0, 2.0], [0.1, 1.4, 0.2]);
    // Found at every pixel, and none is off.
    check(
        gpu,
        "spheres",
        &placed(vec![small.clone(), around.clone()]),
        4,
        3.0,
        2.0,
    );
    around.two_sided = true;
    let half_hidden = panel(1.0, [2.0; 3], [0.1, 1.1, 0.9], [0.0, -1.0, 0.1]);
    check(
        gpu,
        "inside",
        &placed(vec![small, around, half_hidden]),
        4,
        3.0,
        8.0,
    );
}

/// More than are drawn at once, and the same as one by one.
fn many_points_are_many_rows(gpu: &Gpu) {
    let lamps = placed(lamps());
    let mut sampler = sampler(gpu, 4, 16);
    let all: Vec<DVec3> = (0..sampler.capacity() + 5)
        .map(|i| points()[i % 9] * (1.0 + 0.001 * i as f64))
        .collect();
    let found = sampler.sample(&lamps, &all).unwrap();
    assert_eq!(found.len(), all.len());
    // But for rounding, which depends on where in the atlas a map lies.
    for i in [0, 17, all.len() - 6, all.len() - 5, all.len() - 1] {
        let alone = sampler.sample(&lamps, &[all[i]]).unwrap();
        assert!(apart(&found[i], &alone[0], 3.0) < ROUNDING, "point {i}");
    }
}

/// The map's own error: a pixel at each edge is in or out, an error of the order of its edges' pixels' square root; less with more pixels.
fn it_nears_the_closed_form(gpu: &Gpu) {
    let lamps = placed(lamps());
    let form = ClosedForm::new(order(4));
    let mut errors = Vec::new();
    for k in [16, 128] {
        let found = sampler(gpu, 4, k).sample(&lamps, &points()).unwrap();
        let points = points();
        let off = found
            .iter()
            .zip(&points)
            .map(|(found, &at)| apart(found, &form.sample(&lamps, at), 3.0));
        errors.push(off.fold(0.0, f64::max));
    }
    println!("{errors:?}");
    assert!(errors[0] < 2e-2 && errors[1] < 3e-3, "{errors:?}");
}

fn nothing_is_seen_of_nothing(gpu: &Gpu) {
    let mut sampler = sampler(gpu, 3, 8);
    let dark = Incident::dark(order(3));
    // After something, so that nothing is left of it.
    sampler.sample(&placed(lamps()), &points()).unwrap();
    assert_eq!(
        sampler.sample(&placed(vec![]), &points()).unwrap(),
        vec![dark; 9]
    );
    assert_eq!(sampler.sample(&placed(lamps()), &[]).unwrap(), vec![]);
}

fn what_does_not_fit_is_refused(gpu: &Gpu) {
    for size in [0, 2000] {
        let refused = CubeSampler::new(&gpu.device, &gpu.queue, order(3), size);
        assert!(matches!(refused.err(), Some(GpuError::CubeSize { .. })));
    }
    let mut screen = panel(1.0, [1.0; 3], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]);
    let image = HdrImage::new(1, 1, vec![[1.0; 3]]).unwrap();
    screen.pattern = Pattern::Texture {
        image: image.into(),
        factor: [1.0; 3],
    };
    let refused = sampler(gpu, 3, 8).sample(&placed(vec![screen]), &points());
    let message = refused.unwrap_err().to_string();
    assert!(message.contains("\"lamp\" has a texture") && message.lines().count() == 1);
}
