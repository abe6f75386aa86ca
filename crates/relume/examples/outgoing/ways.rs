//! A way to make outgoing radiance of transferred radiance.

use glam::DVec3;
use relume::basis::Order;
use relume::brdf::{self, Reflector};

use crate::grid::Grid;
use crate::harmonics::Harmonics;
use crate::lobes::{Fitted, Plane};
use crate::operator::{Operator, STEPS, start};

/// Where an eye is, in the tangent frame and in the world.
#[derive(Clone, Copy)]
pub struct Eye {
    pub local: [f32; 3],
    pub normal: DVec3,
    pub world: DVec3,
}

/// Which coefficients of transferred radiance a way starts from.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Space {
    /// Of the tangent frame, by azimuth: the rotation is part of the transfer matrix.
    Tangent,
    /// Of the world, by azimuth.
    World,
    /// Of the world, in the library's order.
    Reflector,
}

/// A way, for one material. Under a light it makes a state of a vertex's transferred radiance, and of the state radiance toward an eye.
pub struct Way {
    pub name: &'static str,
    /// The size in words.
    pub label: String,
    /// Bytes of what all vertices of a material share.
    pub material_bytes: usize,
    /// From transferred radiance to the state, by azimuth; none where the state is the transferred radiance.
    pub blocks: Vec<Block>,
    pub basis: Basis,
}

/// Numbers `[rows][columns]` that cosines and sines of an azimuth share.
#[derive(Clone, Default)]
pub struct Block {
    pub columns: usize,
    pub values: Vec<f32>,
}

/// How a state becomes radiance toward an eye.
pub enum Basis {
    /// The library's.
    Reflector(Box<Reflector>),
    /// `o_lμ(θ)`, f32, linear between the steps.
    Table(Table),
    /// Harmonics of the view, of its mirror image, or of the view with the hemisphere stretched to a sphere.
    Harmonics(Harmonics, Direction),
    /// Functions of θ, tabulated, times cos μφ and sin μφ; so many for each μ.
    Separable(Table, Vec<usize>),
    Grid(Grid),
    Plane(Plane),
    Fitted(Fitted),
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    View,
    Mirrored,
    /// [gautron2004]
    Stretched,
}

/// `[STEPS + 1][width]`
pub struct Table {
    width: usize,
    values: Vec<f32>,
}

impl Table {
    pub fn new(rows: impl IntoIterator<Item = Vec<f32>>) -> Self {
        let values: Vec<f32> = rows.into_iter().flatten().collect();
        Self {
            width: values.len() / (STEPS + 1),
            values,
        }
    }

    pub fn bytes(&self) -> usize {
        4 * self.values.len()
    }

    /// The rows on either side of the angle to the normal whose cosine this is, and the weight of the second.
    pub fn around(&self, cosine: f32) -> (&[f32], &[f32], f32) {
        let at = cosine.clamp(0.0, 1.0).acos() * (STEPS as f32 / std::f32::consts::FRAC_PI_2);
        let step = (at as usize).min(STEPS - 1);
        let row = |step: usize| &self.values[step * self.width..][..self.width];
        (row(step), row(step + 1), at - step as f32)
    }
}

/// A direction of the plane along x and y, or x itself.
pub fn azimuth(d: [f32; 3]) -> (f32, f32) {
    let r = (d[0] * d[0] + d[1] * d[1]).sqrt();
    if r > 1e-12 {
        (d[0] / r, d[1] / r)
    } else {
        (1.0, 0.0)
    }
}

impl Way {
    /// The directional table, in the tangent frame.
    pub fn table(operator: &Operator) -> Self {
        let row = |step: usize| operator.step(step).iter().map(|&o| o as f32).collect();
        let table = Table::new((0..=STEPS).map(row));
        Self {
            name: "table, tangent frame",
            label: format!("{} angles", STEPS + 1),
            material_bytes: table.bytes(),
            blocks: Vec::new(),
            basis: Basis::Table(table),
        }
    }

    pub fn space(&self) -> Space {
        match self.basis {
            Basis::Reflector(..) => Space::Reflector,
            Basis::Plane(_) | Basis::Fitted(_) => Space::World,
            _ => Space::Tangent,
        }
    }

    /// Numbers of a state, of each channel.
    pub fn state(&self, order: Order) -> usize {
        match &self.basis {
            Basis::Harmonics(harmonics, _) => harmonics.count(),
            Basis::Separable(_, counts) => counts.iter().zip(0..).map(|(n, mu)| n * pair(mu)).sum(),
            Basis::Grid(grid) => grid.count(),
            _ => order.count(),
        }
    }

    /// Writes the state that transferred radiance `a` makes.
    pub fn light(&self, a: &[f32], state: &mut [f32], scratch: &mut Vec<f32>) {
        match &self.basis {
            Basis::Grid(grid) => {
                scratch.resize(grid.amplitudes(), 0.0);
                multiply(&self.blocks, a, scratch);
                grid.spread(scratch, state);
            }
            _ if self.blocks.is_empty() => state.copy_from_slice(a),
            _ => multiply(&self.blocks, a, state),
        }
    }

    /// Radiance toward an eye.
    pub fn view(&self, state: &[f32], eye: &Eye, scratch: &mut Scratch) -> f32 {
        match &self.basis {
            Basis::Reflector(reflector) => scratch.reflector(reflector, state, eye),
            Basis::Table(table) => toward(table, state, eye.local),
            Basis::Harmonics(harmonics, direction) => {
                harmonics.sum(state, direction.of(eye.local), None)
            }
            Basis::Separable(table, counts) => separable(table, counts, state, eye.local),
            Basis::Grid(grid) => grid.at(state, eye.local),
            Basis::Plane(plane) => plane.sum(state, eye),
            Basis::Fitted(lobe) => lobe.sum(state, eye),
        }
    }
}

impl Direction {
    fn of(self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        match self {
            Self::View => [x, y, z],
            Self::Mirrored => [-x, -y, z],
            Self::Stretched => {
                let scale = (4.0 * z / (1.0 + z)).sqrt();
                [scale * x, scale * y, 2.0 * z - 1.0]
            }
        }
    }
}

/// What a thread writes on.
pub struct Scratch {
    o: Vec<f64>,
    terms: brdf::Scratch,
}

impl Scratch {
    pub fn new(order: Order) -> Self {
        Self {
            o: vec![0.0; 3 * order.count()],
            terms: brdf::Scratch::new(order),
        }
    }

    fn reflector(&mut self, reflector: &Reflector, state: &[f32], eye: &Eye) -> f32 {
        // What the BRDF has of its own is all there is to it.
        let finish = brdf::Finish {
            base_color: DVec3::ONE,
            metallic: 1.0,
            roughness: 1.0,
        };
        reflector.toward(&finish, eye.normal, eye.world, &mut self.terms, &mut self.o);
        let pairs = self.o.iter().zip(state);
        pairs.map(|(o, &a)| o * f64::from(a)).sum::<f64>() as f32
    }
}

/// Cosine and sine, but for μ = 0.
pub fn pair(mu: usize) -> usize {
    if mu == 0 { 1 } else { 2 }
}

fn multiply(blocks: &[Block], a: &[f32], state: &mut [f32]) {
    let (mut a, mut state) = (a, state);
    for (mu, block) in blocks.iter().enumerate() {
        let rows = block.values.len() / block.columns;
        for _ in 0..pair(mu) {
            let (from, to);
            (from, a) = a.split_at(block.columns);
            (to, state) = state.split_at_mut(rows);
            for (to, row) in to.iter_mut().zip(block.values.chunks_exact(block.columns)) {
                *to = row.iter().zip(from).map(|(m, a)| m * a).sum();
            }
        }
    }
}

/// `Σ o_lμ(θ) (a_lμ cos μφ + a_l−μ sin μφ)`
fn toward(table: &Table, a: &[f32], d: [f32; 3]) -> f32 {
    let (low, high, t) = table.around(d[2]);
    let (x, y) = azimuth(d);
    let order = a.len().isqrt();
    let (mut a, mut re, mut im, mut total) = (a, 1.0, 0.0, 0.0);
    for mu in 0..order {
        let size = order - mu;
        let first = start(order, mu);
        let (low, high) = (&low[first..][..size], &high[first..][..size]);
        let (cosines, rest) = a.split_at(size);
        let (sines, rest) = if mu == 0 {
            (cosines, rest)
        } else {
            rest.split_at(size)
        };
        let mut sum = 0.0;
        for l in 0..size {
            let o = low[l] + t * (high[l] - low[l]);
            sum += o * (re * cosines[l] + im * sines[l]);
        }
        total += sum;
        (re, im) = (re * x - im * y, im * x + re * y);
        a = rest;
    }
    total
}

fn separable(table: &Table, counts: &[usize], state: &[f32], d: [f32; 3]) -> f32 {
    let (low, high, t) = table.around(d[2]);
    let (x, y) = azimuth(d);
    let (mut state, mut at) = (state, 0);
    let (mut re, mut im, mut total) = (1.0, 0.0, 0.0);
    for (mu, &size) in counts.iter().enumerate() {
        let (cosines, rest) = state.split_at(size);
        let (sines, rest) = if mu == 0 {
            (cosines, rest)
        } else {
            rest.split_at(size)
        };
        for k in 0..size {
            let g = low[at + k] + t * (high[at + k] - low[at + k]);
            total += g * (re * cosines[k] + im * sines[k]);
        }
        (re, im) = (re * x - im * y, im * x + re * y);
        at += size;
        state = rest;
    }
    total
}
