//! Packets through the tree.

use glam::Vec3;

use super::packet::{Candidate, Packet, bits};
use super::rays::{PACKET, Rays};
use super::tree::{Child, LEAF, Tree};
use super::triangle::{Corners, Shapes};
use super::{Hit, Tracer};
use crate::simd::{Kernel, Lanes};

/// The first surface along each ray.
pub struct Closest<'a> {
    pub tracer: &'a Tracer<'a>,
    pub tree: &'a Tree,
    pub origin: Vec3,
    pub rays: &'a Rays,
    pub hits: &'a mut [Hit],
}

/// Which rays meet nothing.
pub struct Open<'a> {
    pub tracer: &'a Tracer<'a>,
    pub tree: &'a Tree,
    pub origin: Vec3,
    pub rays: &'a Rays,
    pub open: &'a mut [u64],
}

impl Kernel for Closest<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        match PACKET / L::COUNT {
            4 => self.packets::<L, 4>(),
            _ => self.packets::<L, 8>(),
        }
    }
}

impl Closest<'_> {
    #[inline(always)]
    fn packets<L: Lanes, const G: usize>(self) {
        let mut distances = [0.0; PACKET];
        for (i, hits) in self.hits.chunks_mut(PACKET).enumerate() {
            let first = i * PACKET;
            let mut packet = Packet::<L, G>::new(self.rays, first);
            walk::<L, G, true>(self.tracer, self.tree, self.origin, &mut packet);
            packet.distances(&mut distances);
            for (k, hit) in hits.iter_mut().enumerate() {
                let direction = self.rays.get(first + k);
                let triangle = packet.triangles[k];
                *hit = self
                    .tracer
                    .hit(self.origin, direction, triangle, distances[k]);
            }
        }
    }
}

impl Kernel for Open<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        match PACKET / L::COUNT {
            4 => self.packets::<L, 4>(),
            _ => self.packets::<L, 8>(),
        }
    }
}

impl Open<'_> {
    #[inline(always)]
    fn packets<L: Lanes, const G: usize>(self) {
        for (i, open) in self.open.iter_mut().enumerate() {
            let mut packet = Packet::<L, G>::new(self.rays, i * PACKET);
            walk::<L, G, false>(self.tracer, self.tree, self.origin, &mut packet);
            *open = packet.open();
        }
    }
}

/// A node or leaf still to visit, the groups of rays that reach it, and its squared distance.
#[derive(Clone, Copy)]
struct Visit {
    child: Child,
    groups: u32,
    distance: f32,
}

/// Room on the stack for all but degenerate trees.
const ROOM: usize = 256;

/// Depth first, the nearest child first, each with the groups of rays whose frusta reach its box.
///
/// `CLOSEST`: to the nearest surface; otherwise a ray is done when it has met any.
#[inline(always)]
fn walk<L: Lanes, const G: usize, const CLOSEST: bool>(
    tracer: &Tracer,
    tree: &Tree,
    origin: Vec3,
    packet: &mut Packet<L, G>,
) {
    if tree.counts.is_empty() {
        return;
    }
    let root = Visit {
        child: Child::ROOT,
        groups: packet.alive(),
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
        let mut groups = visit.groups & packet.alive();
        if CLOSEST {
            for g in bits(groups) {
                groups &= !(u32::from(visit.distance > packet.groups[g].reach) << g);
            }
        }
        if groups == 0 {
            continue;
        }
        if let Some(leaf) = visit.child.leaf() {
            meet_leaf::<L, G, CLOSEST>(tracer, tree, origin, leaf, groups, packet);
        } else {
            depth = push_children::<L, G, CLOSEST>(
                tree,
                origin,
                visit.child.node(),
                groups,
                packet,
                stack,
                depth,
            );
        }
    }
}

/// Puts the children that some group reaches on the stack, the nearest on top; returns its new depth.
#[inline(always)]
fn push_children<L: Lanes, const G: usize, const CLOSEST: bool>(
    tree: &Tree,
    origin: Vec3,
    node: usize,
    groups: u32,
    packet: &Packet<L, G>,
    stack: &mut [Visit],
    mut depth: usize,
) -> usize {
    let relative = relative_boxes::<L>(tree.node(node), origin);
    let used = (1_u32 << tree.counts[node]) - 1;
    let mut reached = [0_u32; G];
    let mut any = 0;
    for g in bits(groups) {
        let boxes = packet.groups[g].frustum.boxes(&relative) & used;
        reached[g] = boxes;
        any |= boxes;
    }
    if any == 0 {
        return depth;
    }
    let distances = squared_distances(&relative);
    let children = &tree.children[node * L::COUNT..][..L::COUNT];
    let mut planes = [[0.0; 16]; 6];
    for (plane, vector) in planes.iter_mut().zip(&relative) {
        vector.store(plane);
    }
    let bottom = depth;
    for lane in bits(any) {
        let low = [planes[0][lane], planes[1][lane], planes[2][lane]];
        let high = [planes[3][lane], planes[4][lane], planes[5][lane]];
        let mut groups = 0;
        for (g, reached) in reached.iter().enumerate() {
            if reached >> lane & 1 != 0 {
                groups |= u32::from(packet.groups[g].meets(low, high)) << g;
            }
        }
        if groups == 0 {
            continue;
        }
        let visit = Visit {
            child: children[lane],
            groups,
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

/// The least x, y, z and the greatest of a node's boxes, relative to the origin; two more fill up a power of two.
#[inline(always)]
fn relative_boxes<L: Lanes>(bounds: &[f32], origin: Vec3) -> [L; 8] {
    let [x, y, z] = [L::splat(origin.x), L::splat(origin.y), L::splat(origin.z)];
    let zero = L::splat(0.0);
    [
        vector::<L>(bounds, 0) - x,
        vector::<L>(bounds, 1) - y,
        vector::<L>(bounds, 2) - z,
        vector::<L>(bounds, 3) - x,
        vector::<L>(bounds, 4) - y,
        vector::<L>(bounds, 5) - z,
        zero,
        zero,
    ]
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

/// The `k`-th vector of a node or leaf.
#[inline(always)]
fn vector<L: Lanes>(values: &[f32], k: usize) -> L {
    L::load(&values[k * L::COUNT..])
}

#[inline(always)]
fn meet_leaf<L: Lanes, const G: usize, const CLOSEST: bool>(
    tracer: &Tracer,
    tree: &Tree,
    origin: Vec3,
    leaf: usize,
    groups: u32,
    packet: &mut Packet<L, G>,
) {
    let values = tree.leaf(leaf);
    let [x, y, z] = [L::splat(origin.x), L::splat(origin.y), L::splat(origin.z)];
    let corners: Corners<L> = [
        [
            L::load4(values[0]) - x,
            L::load4(values[1]) - y,
            L::load4(values[2]) - z,
        ],
        [
            L::load4(values[3]) - x,
            L::load4(values[4]) - y,
            L::load4(values[5]) - z,
        ],
        [
            L::load4(values[6]) - x,
            L::load4(values[7]) - y,
            L::load4(values[8]) - z,
        ],
    ];
    let triangles = &tree.triangles[leaf * LEAF..][..LEAF];
    let mut shapes = Shapes::empty();
    let useful = shapes.fill(&corners, (1 << tree.sizes[leaf]) - 1);
    let masked = tree.masked[leaf];
    for g in bits(groups) {
        for lane in bits(useful) {
            let triangle = triangles[lane];
            let candidate = Candidate {
                shapes: &shapes,
                corners: &corners,
                lane,
                triangle,
                masked: masked >> lane & 1 != 0,
            };
            let solid = |d| tracer.is_solid(triangle, origin, d);
            if CLOSEST {
                packet.meet_closest(g, &candidate, solid);
            } else {
                packet.meet_any(g, &candidate, solid);
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
