//! Light of emitters frame after frame: only what a moved emitter affects is found again.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::occluders::Ball;
use super::{Emitter, Pattern, Placed, light_at_vertices};
use crate::basis::Order;
use crate::light::VertexLight;

/// An emitter that was affected within so many frames is likely to be again.
const RESTLESS: u32 = 30;

/// Which emitters are found anew in every frame. The others' light is kept.
#[derive(Clone, Debug, Default)]
pub(in crate::light) struct Restless {
    /// Frames since each was last affected.
    still: Vec<u32>,
    is_restless: Vec<bool>,
    last: Option<Placed>,
}

/// What has changed since the last frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::light) enum Change {
    /// Nothing.
    None,
    /// Only light of restless emitters.
    Restless,
    /// Which emitters are restless, or light of others.
    Others,
}

impl Restless {
    /// Takes the next frame, for points in a ball.
    pub(in crate::light) fn next(&mut self, placed: &Placed, ball: &Ball) -> Change {
        let count = placed.emitters().len();
        let last = self.last.replace(placed.clone());
        let Some(last) = last.filter(|last| last.emitters().len() == count) else {
            self.still = vec![RESTLESS; count];
            self.is_restless = vec![false; count];
            return Change::Others;
        };
        let pairs = placed.emitters().iter().zip(last.emitters());
        let moved: Vec<bool> = pairs.map(|(now, before)| !is_same(now, before)).collect();
        if !moved.contains(&true) {
            self.still.iter_mut().for_each(|n| *n = n.saturating_add(1));
            return Change::None;
        }
        let affected = affected(&moved, [placed, &last], ball);
        let settled_one = affected.iter().zip(&self.is_restless);
        let others = settled_one
            .clone()
            .any(|(affected, restless)| *affected && !restless);
        for (still, affected) in self.still.iter_mut().zip(&affected) {
            *still = if *affected {
                0
            } else {
                still.saturating_add(1)
            };
        }
        if !others {
            return Change::Restless;
        }
        // Only now that something has to be found anyway do others come to rest.
        self.is_restless = self.still.iter().map(|&frames| frames < RESTLESS).collect();
        Change::Others
    }

    /// The emitters as they stand, those black that are not restless: they hide, and do not shine.
    pub(in crate::light) fn moving(&self, placed: &Placed) -> Placed {
        placed.with_black(|emitter| !self.is_restless[emitter])
    }

    /// The emitters as they stand, the restless ones black.
    pub(in crate::light) fn resting(&self, placed: &Placed) -> Placed {
        placed.with_black(|emitter| self.is_restless[emitter])
    }
}

/// Whether nothing of an emitter has changed; images are taken for the same where they are the same in memory.
fn is_same(a: &Emitter, b: &Emitter) -> bool {
    let patterns = match (&a.pattern, &b.pattern) {
        (
            Pattern::Texture { image, factor },
            Pattern::Texture {
                image: other,
                factor: by,
            },
        ) => Arc::ptr_eq(image, other) && factor == by,
        (a, b) => a == b,
    };
    patterns
        && a.world_from_emitter == b.world_from_emitter
        && (a.two_sided, a.exponent) == (b.two_sided, b.exponent)
        && a.shape == b.shape
}

/// Emitters that have moved, and those that one of them may hide, now or before, from somewhere in the ball.
fn affected(moved: &[bool], frames: [&Placed; 2], ball: &Ball) -> Vec<bool> {
    let balls = frames.map(|placed| emitter_balls(placed, moved.len()));
    let hidden = |emitter: usize| {
        let (now, movers) = (balls[0][emitter], moved.iter().enumerate());
        let mut movers = movers.filter(|(_, moved)| **moved);
        movers.any(|(i, _)| balls.iter().any(|all| ball.may_hide(&now, &all[i])))
    };
    (0..moved.len()).map(|i| moved[i] || hidden(i)).collect()
}

/// Of each emitter, a ball that holds all of it; nothing at the origin of one without faces.
fn emitter_balls(placed: &Placed, count: usize) -> Vec<Ball> {
    let mut parts: Vec<Vec<Ball>> = vec![Vec::new(); count];
    for polygon in &placed.polygons {
        parts[polygon.emitter].push(Ball::of(polygon));
    }
    for sphere in &placed.spheres {
        parts[sphere.emitter].push(sphere.ball());
    }
    let whole = |parts: Vec<Ball>| {
        if parts.is_empty() {
            return Ball {
                centre: DVec3::ZERO,
                radius: 0.0,
            };
        }
        let centre = Ball::around(parts.iter().map(|part| part.centre)).centre;
        let reach = |part: &Ball| part.centre.distance(centre) + part.radius;
        Ball {
            centre,
            radius: parts.iter().map(reach).fold(0.0, f64::max),
        }
    };
    parts.into_iter().map(whole).collect()
}

/// Exact light at the vertices of one object, frame after frame.
///
/// As [`light_at_vertices`], within rounding (1e-6 of the largest coefficient): but light of emitters that rest, and that nothing that moves may hide, is found
/// once and kept. So a frame in which one of many emitters moves costs as much as that one alone.
#[derive(Clone, Debug)]
pub struct LightSession {
    positions: Vec<Vec3>,
    order: Order,
    ball: Ball,
    restless: Restless,
    resting: VertexLight,
    light: VertexLight,
}

impl LightSession {
    /// For light of `order` at these positions.
    pub fn new(positions: &[Vec3], order: Order) -> Self {
        let dark = VertexLight::new(order, vec![[0.0; 3]; positions.len() * order.count()]);
        Self {
            positions: positions.to_vec(),
            order,
            ball: Ball::around(positions.iter().map(|p| p.as_dvec3())),
            restless: Restless::default(),
            resting: dark.clone(),
            light: dark,
        }
    }

    /// Incident light at each position in the next frame.
    pub fn light(&mut self, placed: &Placed) -> &VertexLight {
        let of = |placed: &Placed| light_at_vertices(&self.positions, placed, self.order);
        match self.restless.next(placed, &self.ball) {
            Change::None => return &self.light,
            Change::Restless => (),
            Change::Others => self.resting = of(&self.restless.resting(placed)),
        }
        let moving = of(&self.restless.moving(placed));
        self.light = self.resting.plus_vertices(&moving);
        &self.light
    }
}
