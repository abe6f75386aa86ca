//! Light frame after frame against light of each frame alone.

use glam::{DAffine3, DQuat, Vec3};

use super::exact::apart;
use super::samplers::{at, order, uniform};
use super::*;
use crate::light::adaptive::{
    FirstOrderSession, RefineOptions, Responses, VertexHierarchy, refine_first_order,
};
use crate::light::emitter::{LightSession, light_at_vertices};

fn positions() -> Vec<Vec3> {
    let number = |i: u32, k: u32| (i * k % 101) as f32 / 100.0 - 0.5;
    let point = |i: u32| Vec3::new(number(i, 7), number(i, 31), number(i, 59));
    (0..200).map(point).collect()
}

/// A row of panels above, one panel aside, and a black one that may pass before it.
fn emitters() -> Emitters {
    let panel = |rgb, place| {
        let panel = uniform(EmitterMesh::quad(0.6, 0.6), rgb);
        at(panel, place, DQuat::from_rotation_x(1.5))
    };
    let mut all: Vec<Emitter> = (0..4)
        .map(|i| {
            panel(
                [1.0 + f32::from(i as u8), 2.0, 0.5],
                [f64::from(i) - 1.5, 1.5, 0.0],
            )
        })
        .collect();
    let aside = uniform(EmitterMesh::quad(1.0, 1.0), [5.0, 1.0, 2.0]);
    all.push(at(aside, [0.0, 0.0, -2.5], DQuat::IDENTITY));
    let mut screen = uniform(EmitterMesh::quad(0.5, 0.5), [0.0; 3]);
    screen.two_sided = true;
    all.push(at(screen, [4.0, 0.0, -1.2], DQuat::IDENTITY));
    Emitters::new(all).unwrap()
}

/// Moves a lamp, then the screen across the panel aside, then nothing, then a lamp again, and changes a colour at last.
fn frames() -> Vec<Emitters> {
    let mut set = emitters();
    let mut frames = vec![set.clone()];
    let mut moved = |set: &mut Emitters, emitter: usize, step: DVec3| {
        let pose = set.emitters()[emitter].world_from_emitter;
        let moved = DAffine3::from_translation(step) * pose;
        set.set_pose(emitter, moved).unwrap();
        frames.push(set.clone());
    };
    for _ in 0..5 {
        moved(&mut set, 1, DVec3::new(0.0, -0.05, 0.02));
    }
    for _ in 0..10 {
        moved(&mut set, 5, DVec3::new(-0.8, 0.01, 0.0));
    }
    for _ in 0..40 {
        moved(&mut set, 1, DVec3::ZERO);
    }
    for _ in 0..35 {
        moved(&mut set, 0, DVec3::new(0.01, 0.0, 0.0));
    }
    moved(&mut set, 2, DVec3::new(0.01, 0.0, 0.0));
    let mut coloured = set.emitters().to_vec();
    coloured[3].pattern = Pattern::Uniform([9.0, 0.0, 0.0]);
    frames.push(Emitters::new(coloured).unwrap());
    frames
}

#[test]
fn light_of_a_session_is_that_of_each_frame() {
    let positions = positions();
    let mut session = LightSession::new(&positions, order(4));
    let mut last = None;
    let mut changes = 0;
    for (i, frame) in frames().iter().enumerate() {
        let placed = frame.placed();
        let alone = light_at_vertices(&positions, &placed, order(4));
        let light = session.light(&placed);
        let error = apart(light, &alone);
        assert!(error < 3e-6, "{error} in frame {i}");
        changes += usize::from(last.as_ref().is_some_and(|last| *last != alone));
        last = Some(alone);
    }
    assert!(changes > 40, "{changes}");
}

#[test]
fn samples_of_a_session_are_those_of_each_frame() {
    let positions = positions();
    let hierarchy = VertexHierarchy::new(&positions);
    let form = ClosedForm::new(order(3));
    let responses = Responses::even(positions.len(), order(3));
    let options = RefineOptions {
        epsilon: 1e-3,
        budget: 40,
    };
    let mut session = FirstOrderSession::default();
    for (i, frame) in frames().iter().enumerate() {
        let placed = frame.placed();
        let alone =
            refine_first_order(&hierarchy, &positions, &responses, &form, &placed, &options);
        let found = session.refine(&hierarchy, &positions, &responses, &form, &placed, &options);
        assert_eq!(
            (&found.positions, &found.weights),
            (&alone.positions, &alone.weights)
        );
        let scale = alone.rows.iter().fold(0.0_f32, |a, b| a.max(b.abs()));
        for (a, b) in found.rows.iter().zip(&alone.rows) {
            assert!((a - b).abs() < 1e-6 * scale, "{a} {b} in frame {i}");
        }
    }
}
