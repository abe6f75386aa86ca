//! Near emitters to draw with.

use glam::{DAffine3, DQuat, DVec3};
use relume::light::emitter::{Emitter, EmitterMesh, Emitters, Pattern, Placed, Shape};

pub fn emitter(shape: Shape, radiance: [f32; 3], at: [f64; 3], turn: DQuat) -> Emitter {
    Emitter {
        name: "lamp".into(),
        shape,
        pattern: Pattern::Uniform(radiance),
        two_sided: false,
        exponent: 0,
        world_from_emitter: DAffine3::from_rotation_translation(turn, at.into()),
    }
}

/// A panel that looks along `toward`.
pub fn panel(side: f64, radiance: [f32; 3], at: [f64; 3], toward: [f64; 3]) -> Emitter {
    let turn = DQuat::from_rotation_arc(DVec3::Z, DVec3::from(toward).normalize());
    let quad = Shape::Mesh(EmitterMesh::quad(side, side));
    emitter(quad, radiance, at, turn)
}

pub fn placed(emitters: Vec<Emitter>) -> Placed {
    Emitters::new(emitters).unwrap().placed()
}
