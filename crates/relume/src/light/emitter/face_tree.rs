//! Which face a ray meets first, without asking all of them.
//!
//! A tree of boxes in f64 of our own: what rays meet is to be the same as if every face was asked, which boxes and rays of f32, as obvhs has them, do not
//! give.

use glam::DVec3;

use super::PlacedPolygon;

/// Faces of a leaf.
const LEAF: usize = 4;
/// As a share of all lengths: how much larger boxes are than what is in them, for rounding.
const ROUNDING: f64 = 1e-12;

/// A binary tree of boxes over polygons, each cut at the median of its longest axis.
#[derive(Clone, Debug)]
pub struct FaceTree {
    /// The root first; none without polygons.
    nodes: Vec<Node>,
    /// Polygons in the order in which leaves hold them.
    order: Vec<u32>,
    /// The farthest that a box reaches from the origin along an axis.
    reach: f64,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    low: DVec3,
    high: DVec3,
    /// Of a leaf its first place in the order; of others the second half's node. The first half's is the next one.
    at: u32,
    /// Polygons of a leaf; 0 of others.
    count: u32,
}

/// A ray as boxes take it.
struct Slabs {
    origin: DVec3,
    inverse: DVec3,
    /// How far a box is widened.
    pad: f64,
}

impl FaceTree {
    /// Boxes hold the balls about polygons, in which rays may meet them.
    pub fn new(polygons: &[PlacedPolygon]) -> Self {
        let mut tree = Self {
            nodes: Vec::new(),
            order: (0..polygons.len() as u32).collect(),
            reach: 0.0,
        };
        if !polygons.is_empty() {
            let mut order = std::mem::take(&mut tree.order);
            tree.add(polygons, &mut order, 0);
            tree.order = order;
            let Node { low, high, .. } = tree.nodes[0];
            tree.reach = low.abs().max(high.abs()).max_element();
        }
        tree
    }

    /// Adds a node over some polygons, whose place in the order begins at `first`, and what is below it.
    fn add(&mut self, polygons: &[PlacedPolygon], order: &mut [u32], first: usize) {
        let each = || order.iter().map(|&i| &polygons[i as usize]);
        // Rays may meet a polygon that much outside its radius.
        let radius = |p: &PlacedPolygon| DVec3::splat(p.radius * (1.0 + 1e-9));
        let low = each().fold(DVec3::INFINITY, |low, p| low.min(p.centre - radius(p)));
        let high = each().fold(DVec3::NEG_INFINITY, |high, p| {
            high.max(p.centre + radius(p))
        });
        let node = self.nodes.len();
        self.nodes.push(Node {
            low,
            high,
            at: first as u32,
            count: order.len() as u32,
        });
        if order.len() <= LEAF {
            return;
        }
        let centres = each().map(|p| p.centre);
        let (least, most) = centres.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), c| {
            (a.min(c), b.max(c))
        });
        let axis = (most - least).max_position();
        let along = |i: &u32| polygons[*i as usize].centre[axis];
        let half = order.len() / 2;
        order.select_nth_unstable_by(half, |a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
        let (left, right) = order.split_at_mut(half);
        self.add(polygons, left, first);
        self.nodes[node].at = self.nodes.len() as u32;
        self.nodes[node].count = 0;
        self.add(polygons, right, first + half);
    }

    /// The polygon that `meet` says is met nearest, and how far away; of several that are, the one of the lowest number.
    pub fn nearest(
        &self,
        origin: DVec3,
        direction: DVec3,
        meet: impl Fn(usize) -> Option<f64>,
    ) -> Option<(usize, f64)> {
        let slabs = Slabs {
            origin,
            inverse: direction.recip(),
            pad: ROUNDING * (self.reach + origin.abs().max_element()),
        };
        let mut best: Option<(usize, f64)> = None;
        let mut waiting: Vec<(f64, usize)> = Vec::with_capacity(64);
        waiting.extend(self.nodes.first().map(|root| (slabs.enter(root), 0)));
        while let Some((entered, at)) = waiting.pop() {
            let until = best.map_or(f64::INFINITY, |(_, distance)| distance);
            // What is met as near as the best may have a lower number.
            if entered.is_nan() || entered > until {
                continue;
            }
            let node = &self.nodes[at];
            if node.count == 0 {
                let halves = [at + 1, node.at as usize].map(|i| (slabs.enter(&self.nodes[i]), i));
                let [near, far] = if halves[1].0 < halves[0].0 {
                    [halves[1], halves[0]]
                } else {
                    halves
                };
                waiting.extend([far, near]);
                continue;
            }
            for &i in &self.order[node.at as usize..][..node.count as usize] {
                let Some(distance) = meet(i as usize) else {
                    continue;
                };
                let found = (i as usize, distance);
                let nearer =
                    |(j, other): (usize, f64)| distance < other || distance == other && found.0 < j;
                if best.is_none_or(nearer) {
                    best = Some(found);
                }
            }
        }
        best
    }
}

impl Slabs {
    /// Where the ray enters a box, in lengths of its direction; NaN where it does not.
    fn enter(&self, node: &Node) -> f64 {
        let a = (node.low - self.pad - self.origin) * self.inverse;
        let b = (node.high + self.pad - self.origin) * self.inverse;
        let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
        if near <= far && far >= 0.0 {
            near
        } else {
            f64::NAN
        }
    }
}
