//! Packets through the tree.
//!
//! A packet goes down together. Near the top, groups of its rays are held against a node's boxes by their frusta, then ray by ray; near the
//! bottom triangles are small beside the gaps between rays, and the few rays of a group that reach a node are each held against all of its boxes
//! at once.

use super::Hit;
use super::ground::Ground;
use super::leaf::Leaf;
use super::occluders::Occluders;
use super::packet::{Packet, bits};
use super::rays::{PACKET, Rays};
use super::tree::Child;
use crate::simd::{Kernel, Lanes};

/// All rays, packet by packet.
pub struct Cast<'a, S> {
    pub ground: Ground<'a>,
    pub rays: &'a Rays,
    pub sought: S,
}

/// What is sought along rays.
pub trait Sought {
    /// Looks for it along those of packet `i`.
    fn seek<L: Lanes, const G: usize>(&mut self, ground: &Ground, rays: &Rays, i: usize);
}

impl<S: Sought> Kernel for Cast<'_, S> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self) {
        for i in 0..self.rays.words() {
            match PACKET / L::COUNT {
                4 => self.sought.seek::<L, 4>(&self.ground, self.rays, i),
                _ => self.sought.seek::<L, 8>(&self.ground, self.rays, i),
            }
        }
    }
}

/// The first surface along each ray.
pub struct Closest<'a>(pub &'a mut [Hit]);

impl Sought for Closest<'_> {
    #[inline(always)]
    fn seek<L: Lanes, const G: usize>(&mut self, ground: &Ground, rays: &Rays, i: usize) {
        let mut packet = Packet::<L, G>::new(rays, i);
        walk::<L, G, NEAREST>(ground, &mut packet);
        let first = i * PACKET;
        let hits = self.0[first..]
            .iter_mut()
            .zip(packet.triangles)
            .zip(packet.t);
        for (k, ((hit, triangle), t)) in hits.enumerate() {
            *hit = ground
                .tracer
                .hit(ground.origin, rays.get(first + k), triangle, t);
        }
    }
}

/// Which rays meet a surface before a distance, one for each: bit i mod 64 of `hidden[i / 64]`.
pub struct Before<'a> {
    pub until: &'a [f32],
    pub hidden: &'a mut [u64],
}

impl Sought for Before<'_> {
    #[inline(always)]
    fn seek<L: Lanes, const G: usize>(&mut self, ground: &Ground, rays: &Rays, i: usize) {
        let until = &self.until[i * PACKET..];
        let until = &until[..until.len().min(PACKET)];
        let mut packet = Packet::<L, G>::until(rays, i, until);
        let all = packet.alive;
        walk::<L, G, BEFORE>(ground, &mut packet);
        self.hidden[i] = all & !packet.alive;
    }
}

/// Which rays meet nothing.
pub struct Open<'a> {
    pub open: &'a mut [u64],
    pub occluders: &'a mut Occluders,
}

impl Sought for Open<'_> {
    #[inline(always)]
    fn seek<L: Lanes, const G: usize>(&mut self, ground: &Ground, rays: &Rays, i: usize) {
        let mut packet = Packet::<L, G>::new(rays, i);
        self.try_last(ground, &mut packet);
        walk::<L, G, ANY>(ground, &mut packet);
        for group in &packet.groups {
            if let Some(leaf) = group.occluder {
                self.occluders.remember(group.frustum.middle, leaf);
            }
        }
        self.open[i] = packet.alive;
    }
}

impl Open<'_> {
    /// Tries what stopped rays there before, on the whole packet: neighbouring groups often remember the same.
    #[inline(always)]
    fn try_last<L: Lanes, const G: usize>(&mut self, ground: &Ground, packet: &mut Packet<L, G>) {
        let mut tried = None;
        for g in 0..G {
            if packet.alive == 0 {
                return;
            }
            let middle = packet.groups[g].frustum.middle;
            let last = self.occluders.leaf(middle, ground.tree.sizes.len());
            let Some(leaf) = last.filter(|_| last != tried) else {
                continue;
            };
            tried = last;
            let before = packet.alive;
            meet_leaf::<L, G, ANY>(ground, leaf, packet.alive, packet);
            if packet.alive == before {
                self.occluders.forget(middle);
            }
        }
    }
}

/// A node or leaf still to visit, the rays that reach it, and its squared distance.
#[derive(Clone, Copy)]
struct Visit {
    rays: u64,
    child: Child,
    distance: f32,
}

/// The first surface along each ray.
const NEAREST: u8 = 0;
/// Any surface before a distance.
const BEFORE: u8 = 1;
/// Any surface at all.
const ANY: u8 = 2;

/// Room on the stack for all but degenerate trees.
const ROOM: usize = 256;
/// As many rays of a group are held one by one against the boxes of a node.
const FEW: u32 = 3;
/// As many rays of a group are held one by one against the triangles of a leaf.
const FEW_AT_LEAF: u32 = 8;

/// Depth first, the nearest child first.
///
/// For what is `SOUGHT`: [`NEAREST`], [`BEFORE`] or [`ANY`].
#[inline(always)]
fn walk<L: Lanes, const G: usize, const SOUGHT: u8>(ground: &Ground, packet: &mut Packet<L, G>) {
    let tree = ground.tree;
    if tree.counts.is_empty() {
        return;
    }
    let root = Visit {
        rays: packet.alive,
        child: Child::ROOT,
        distance: 0.0,
    };
    let mut fixed = [root; ROOM];
    let mut large = Vec::new();
    let stack: &mut [Visit] = if tree.stack <= ROOM {
        &mut fixed
    } else {
        large.resize(tree.stack, root);
        &mut large
    };
    let mut depth = 1;
    while depth > 0 {
        depth -= 1;
        let visit = stack[depth];
        let mut rays = visit.rays & packet.alive;
        if SOUGHT != ANY {
            for g in 0..G {
                let group = Packet::<L, G>::of_group(rays, g);
                if group != 0 {
                    let past = group & !packet.reach(g, visit.distance);
                    rays &= !Packet::<L, G>::from_group(past, g);
                }
            }
        }
        if rays == 0 {
            continue;
        }
        if let Some(leaf) = visit.child.leaf() {
            meet_leaf::<L, G, SOUGHT>(ground, leaf, rays, packet);
        } else {
            depth = push_children(ground, visit.child.node(), rays, packet, stack, depth);
        }
    }
}

/// Puts the children that some ray reaches on the stack, the nearest on top; returns its new depth.
#[inline(always)]
fn push_children<L: Lanes, const G: usize>(
    ground: &Ground,
    node: usize,
    rays: u64,
    packet: &Packet<L, G>,
    stack: &mut [Visit],
    mut depth: usize,
) -> usize {
    let tree = ground.tree;
    let relative = ground.boxes::<L>(node);
    let mut planes = [[0.0; 16]; 6];
    for (plane, vector) in planes.iter_mut().zip(&relative) {
        vector.store(plane);
    }
    let used = (1_u32 << tree.counts[node]) - 1;
    let mut reached = [0_u64; 16];
    let mut any = 0;
    for g in 0..G {
        let rays = Packet::<L, G>::of_group(rays, g);
        if rays.count_ones() <= FEW {
            for ray in bits(rays) {
                let ray = g * L::COUNT + ray;
                let boxes = packet.meet_boxes(ray, &relative) & used;
                any |= boxes;
                for lane in bits(boxes) {
                    reached[lane] |= 1 << ray;
                }
            }
            continue;
        }
        for lane in bits(packet.groups[g].frustum.boxes(&relative) & used) {
            let low = [planes[0][lane], planes[1][lane], planes[2][lane]];
            let high = [planes[3][lane], planes[4][lane], planes[5][lane]];
            let met = packet.meet_box(g, low, high) & rays;
            any |= u32::from(met != 0) << lane;
            reached[lane] |= Packet::<L, G>::from_group(met, g);
        }
    }
    if any == 0 {
        return depth;
    }
    let distances = squared_distances(&relative);
    let children = &tree.children[node * L::COUNT..][..L::COUNT];
    let bottom = depth;
    for lane in bits(any) {
        let visit = Visit {
            rays: reached[lane],
            child: children[lane],
            distance: distances[lane],
        };
        // Insertion sort: few children are reached.
        let mut place = depth;
        while place > bottom && stack[place - 1].distance < visit.distance {
            stack[place] = stack[place - 1];
            place -= 1;
        }
        stack[place] = visit;
        depth += 1;
        tree.prefetch::<L>(visit.child);
    }
    depth
}

/// From the origin to each box.
#[inline(always)]
fn squared_distances<L: Lanes>(relative: &[L; 8]) -> [f32; 16] {
    let zero = L::splat(0.0);
    let x = relative[0].most(zero - relative[3]).most(zero);
    let y = relative[1].most(zero - relative[4]).most(zero);
    let z = relative[2].most(zero - relative[5]).most(zero);
    let mut distances = [0.0; 16];
    (x * x + y * y + z * z).store(&mut distances);
    distances
}

#[inline(always)]
fn meet_leaf<L: Lanes, const G: usize, const SOUGHT: u8>(
    ground: &Ground,
    leaf: usize,
    rays: u64,
    packet: &mut Packet<L, G>,
) {
    let leaf = Leaf::new(ground, leaf);
    for g in 0..G {
        let rays = Packet::<L, G>::of_group(rays, g);
        if rays.count_ones() <= FEW_AT_LEAF {
            for ray in bits(rays) {
                let ray = g * L::COUNT + ray;
                match SOUGHT {
                    NEAREST => packet.shorten_ray::<false>(ray, &leaf),
                    BEFORE => packet.shorten_ray::<true>(ray, &leaf),
                    _ => packet.stop_ray(ray, &leaf),
                }
            }
        } else {
            match SOUGHT {
                NEAREST => packet.shorten_group::<false>(g, rays, &leaf),
                BEFORE => packet.shorten_group::<true>(g, rays, &leaf),
                _ => packet.stop_group(g, rays, &leaf),
            }
        }
    }
}

/// The rays that met nothing, ascending.
pub fn rays_of(open: &[u64]) -> impl Iterator<Item = usize> + '_ {
    open.iter().enumerate().flat_map(|(word, &set)| {
        let (low, high) = (set as u32, (set >> 32) as u32);
        let at = word * PACKET;
        bits(low)
            .map(move |i| at + i)
            .chain(bits(high).map(move |i| at + 32 + i))
    })
}
