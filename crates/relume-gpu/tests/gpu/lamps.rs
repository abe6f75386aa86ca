//! Emitters in the picture, and radiance that was shaded elsewhere.

use glam::{DAffine3, DQuat, DVec3};
use relume::display::{Camera, VertexRadiance};
use relume::light::emitter::{Emitter, EmitterMesh, Emitters, Pattern, Placed, Shape};
use relume::scene::World;
use relume::shade::bounced;
use relume_gpu::{GpuError, Look, Surface};

use crate::compare::{EDGE, Expected};
use crate::device::{Drawn, Gpu, on_each_back_end};
use crate::scenes::{SIZE, ball, camera, distant, transfer};

on_each_back_end! {
    emitters_stand_in_the_picture
    spheres_are_round
    radiance_shaded_elsewhere_is_shown
}

fn emitter(shape: Shape, pattern: Pattern, at: DVec3) -> Emitter {
    Emitter {
        name: "lamp".to_owned(),
        shape,
        pattern,
        two_sided: false,
        exponent: 0,
        world_from_emitter: DAffine3::from_translation(at),
    }
}

/// Quads that face the camera, turn their backs to it, and stand half behind the ball; with a pattern and an exponent.
fn quads() -> Placed {
    let quad = |pattern, x: f64, turn: f64| {
        let mut made = emitter(
            Shape::Mesh(EmitterMesh::quad(0.6, 0.5)),
            pattern,
            DVec3::ZERO,
        );
        made.world_from_emitter = DAffine3::from_rotation_translation(
            DQuat::from_rotation_y(turn),
            DVec3::new(x, 0.9, 0.3),
        );
        made
    };
    let corners = vec![[2.0, 0.1, 0.1], [0.1, 1.0, 0.1], [0.2, 0.1, 3.0], [1.0; 3]];
    let mut falling = quad(Pattern::Uniform([3.0, 2.0, 1.0]), 1.1, 0.4);
    (falling.exponent, falling.two_sided) = (3, true);
    let set = vec![
        quad(Pattern::PerVertex(corners), -0.6, 0.6),
        quad(Pattern::Uniform([0.7, 0.8, 0.9]), 0.3, 3.3),
        falling,
        {
            let mut behind = quad(Pattern::PerFace(vec![[0.3, 0.2, 0.9]]), 0.0, 0.5);
            behind.world_from_emitter.translation = DVec3::new(-0.9, 0.5, -0.4);
            behind
        },
    ];
    Emitters::new(set).unwrap().placed()
}

fn compare(
    gpu: &Gpu,
    name: &str,
    world: &World,
    placed: &Placed,
    from: &Camera,
) -> (Expected, Drawn) {
    let transfer = transfer(world, 3, 1, false);
    let light = distant(3);
    let mut renderer = gpu.renderer();
    renderer.upload(world, &transfer).unwrap();
    renderer.set_light(&light).unwrap();
    let bare = gpu.draw(&mut renderer, from, &Look::default(), SIZE);
    renderer.show_emitters(Some(placed)).unwrap();
    let drawn = gpu.draw(&mut renderer, from, &Look::default(), SIZE);
    assert_ne!(bare, drawn, "{name}");
    renderer.show_emitters(None).unwrap();
    let without = gpu.draw(&mut renderer, from, &Look::default(), SIZE);
    assert_eq!(bare, without, "{name}");
    let radiance = VertexRadiance::new(&transfer, &light);
    let expected = Expected::with_emitters(
        world,
        &radiance,
        &|_| [0.0; 3],
        Some(placed),
        from,
        SIZE,
        EDGE,
    );
    (expected, drawn)
}

fn emitters_stand_in_the_picture(gpu: &Gpu) {
    let world = ball();
    let (expected, drawn) = compare(gpu, "quads", &world, &quads(), &camera(&world));
    expected.check("quads", &drawn, 1e-4, 1e-4);
}

/// They are drawn by triangles, whose outline is within 0.3 % of the radius.
fn spheres_are_round(gpu: &Gpu) {
    let world = ball();
    let shape = Shape::Sphere { radius: 0.3 };
    let lamp = emitter(
        shape,
        Pattern::Uniform([5.0, 4.0, 3.0]),
        DVec3::new(0.8, 0.9, 0.4),
    );
    let placed = Emitters::new(vec![lamp]).unwrap().placed();
    let (expected, drawn) = compare(gpu, "sphere", &world, &placed, &camera(&world));
    let outside = expected.outside(&drawn, 1e-4, 1e-4);
    assert!(outside <= 3 * 12, "{outside} values along the outline");
}

fn radiance_shaded_elsewhere_is_shown(gpu: &Gpu) {
    let mut world = ball();
    world
        .materials
        .iter_mut()
        .for_each(|m| m.double_sided = true);
    let transfer = transfer(&world, 4, 3, true);
    let light = distant(4);
    let mut sides = bounced(&transfer, &light, 0).unwrap();
    let from = camera(&world);
    let mut renderer = gpu.renderer();
    assert_eq!(renderer.set_radiance(&sides, None), Err(GpuError::NoScene));
    renderer.upload(&world, &transfer).unwrap();
    renderer.set_radiance(&sides, None).unwrap();
    let drawn = gpu.draw(&mut renderer, &from, &Look::default(), SIZE);
    let radiance = VertexRadiance::of_sides(&transfer, sides.clone());
    let expected = Expected::new(&world, &radiance, &|_| [0.0; 3], &from, SIZE, EDGE);
    expected.check("radiance", &drawn, 1e-5, 1e-5);
    // Signs are shown, too.
    sides.front.iter_mut().flatten().for_each(|x| *x = -*x);
    renderer.set_radiance(&sides, None).unwrap();
    let signed = Look {
        surface: Surface::Signed,
        ..Look::default()
    };
    let cold = gpu.draw(&mut renderer, &from, &signed, SIZE);
    let blue = cold.pixels().iter().filter(|p| p[2] > 2.0 * p[0]).count();
    assert!(blue > 1000, "{blue}");
    sides.front.pop();
    assert!(matches!(
        renderer.set_radiance(&sides, None),
        Err(GpuError::Mismatch { .. })
    ));
}
