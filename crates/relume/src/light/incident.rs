//! The light a shading stage takes.

use std::ops::Range;

use crate::basis::Order;

/// Distant radiance as spherical-harmonics coefficients: `L(ω) = Σ c_i Y_i(ω)`, ω pointing away from the scene.
///
/// Linear Rec. 709, scene-referred; no π, cosine or albedo is folded in.
#[derive(Clone, Debug, PartialEq)]
pub struct ShLight {
    order: Order,
    coefficients: Vec<[f32; 3]>,
}

/// The light in front of a baked scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum IncidentLight {
    /// The same at every vertex.
    Distant(ShLight),
    /// The same at every vertex of an object, as where lights are near but objects are small. Vertices of no object are dark.
    PerObject(Vec<ObjectLight>),
    /// Another one at every vertex.
    PerVertex(VertexLight),
}

/// Light of one object.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectLight {
    /// The object's vertices, as in [`crate::scene::World::instance_vertices`].
    pub vertices: Range<usize>,
    /// What arrives there, in the space of the scene's root.
    pub light: ShLight,
}

/// Light of each vertex, in the space of the scene's root.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexLight {
    order: Order,
    coefficients: Vec<[f32; 3]>,
}

impl VertexLight {
    /// Light from coefficients `[vertices][order²]`. Panics when their number is no multiple of `order²`.
    pub fn new(order: Order, coefficients: Vec<[f32; 3]>) -> Self {
        assert_eq!(
            coefficients.len() % order.count(),
            0,
            "as many coefficients for each vertex"
        );
        Self {
            order,
            coefficients,
        }
    }

    /// The order of the expansions.
    pub fn order(&self) -> Order {
        self.order
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.coefficients.len() / self.order.count()
    }

    /// This and a distant light, at the higher of their orders.
    pub fn plus(&self, distant: &ShLight) -> Self {
        let order = self.order.max(distant.order);
        let distant = distant.resized(order);
        let mut coefficients = Vec::with_capacity(self.vertex_count() * order.count());
        for vertex in 0..self.vertex_count() {
            let near = self
                .coefficients(vertex)
                .iter()
                .chain(std::iter::repeat(&[0.0; 3]));
            let pairs = near.zip(distant.coefficients());
            coefficients
                .extend(pairs.map(|(a, b)| std::array::from_fn::<f32, 3, _>(|c| a[c] + b[c])));
        }
        Self {
            order,
            coefficients,
        }
    }

    /// This and another light of the same vertices, at the higher of their orders. Panics where there are more of one than of the other.
    pub fn plus_vertices(&self, other: &Self) -> Self {
        assert_eq!(
            self.vertex_count(),
            other.vertex_count(),
            "the same vertices"
        );
        let order = self.order.max(other.order);
        let mut coefficients = vec![[0.0; 3]; self.vertex_count() * order.count()];
        for (vertex, row) in coefficients.chunks_exact_mut(order.count()).enumerate() {
            for light in [self, other] {
                for (place, value) in row.iter_mut().zip(light.coefficients(vertex)) {
                    *place = std::array::from_fn(|c| place[c] + value[c]);
                }
            }
        }
        Self {
            order,
            coefficients,
        }
    }

    /// The `order²` RGB coefficients of one vertex, index `l(l+1)+m`. Panics where there is no such vertex.
    pub fn coefficients(&self, vertex: usize) -> &[[f32; 3]] {
        let count = self.order.count();
        &self.coefficients[vertex * count..(vertex + 1) * count]
    }
}

impl ShLight {
    /// Light from `order²` coefficients. Panics when their number differs.
    pub fn new(order: Order, coefficients: Vec<[f32; 3]>) -> Self {
        assert_eq!(
            coefficients.len(),
            order.count(),
            "one coefficient per basis function"
        );
        Self {
            order,
            coefficients,
        }
    }

    /// The order of the expansion.
    pub fn order(&self) -> Order {
        self.order
    }

    /// `order²` RGB coefficients, index `l(l+1)+m`.
    pub fn coefficients(&self) -> &[[f32; 3]] {
        &self.coefficients
    }

    /// The same light cut to a lower order, or padded with zeros to a higher one.
    pub fn resized(&self, order: Order) -> Self {
        let mut coefficients = self.coefficients.clone();
        coefficients.resize(order.count(), [0.0; 3]);
        Self {
            order,
            coefficients,
        }
    }
}
