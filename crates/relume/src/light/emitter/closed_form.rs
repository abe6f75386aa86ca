//! Incident light in closed form: exact for polygons and spheres of one radiance, whatever stands before them [wang2018].

use std::borrow::Cow;
use std::f64::consts::PI;
use std::sync::OnceLock;

use glam::DVec3;

use super::pattern::{CellTree, parts};
use super::placed::Shine;
use super::sample::{Incident, LightGradient, Sampler};
use super::sphere::Cap;
use super::views::Views;
use super::visible::{Corner, View};
use super::{MAX_EXPONENT, Placed, PlacedSphere};
use crate::basis::{Order, PolygonHarmonics, PolygonWork, Product, Zonal};

/// Samples emitters in closed form.
///
/// Exact to rounding for flat faces of one radiance, with any exponent (at orders up to 32 less the exponent) and any of them hidden by others, and for
/// spheres that are seen whole. The outline of a sphere that is partly hidden, or hides something, is a polygon of 64 corners. Radiance that varies
/// over a face is summed over cells of its mean: a cell is small enough when the spread of radiance within it, as a share of the face's mean radiance and
/// times the angle in which the cell is seen times the order where that is below 1, is below `tolerance`. Cells are no finer than half a texel, or a 32nd of
/// an edge where radiance is given at corners.
///
/// A point in the plane of a face sees nothing of it; one inside a one-sided sphere sees it black, and nothing beyond.
#[derive(Debug)]
pub struct ClosedForm {
    order: Order,
    tolerance: f64,
    /// By exponent.
    lobes: [OnceLock<Lobe>; MAX_EXPONENT as usize + 1],
}

/// What shines, by its number among its like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Polygon(usize),
    Sphere(usize),
}

/// What one exponent takes.
#[derive(Debug)]
struct Lobe {
    harmonics: PolygonHarmonics,
    /// Each multiplies by a linear function and takes one degree off; the last leaves the order asked for.
    products: Vec<Product>,
}

impl ClosedForm {
    /// Coefficients of `order`; a tolerance of 1/256.
    pub fn new(order: Order) -> Self {
        Self::with_tolerance(order, 1.0 / 256.0)
    }

    /// As the type's text says of `tolerance`.
    pub fn with_tolerance(order: Order, tolerance: f64) -> Self {
        Self {
            order,
            tolerance,
            lobes: Default::default(),
        }
    }

    fn lobe(&self, exponent: u32) -> &Lobe {
        self.lobes[exponent as usize].get_or_init(|| {
            let of = |n: usize| Order::new(n.min(Order::MAX)).expect("1…32");
            // Degree 1 is wanted for distances, whatever the order.
            let least = self.order.get().max(2);
            let highest = (least + exponent as usize).min(Order::MAX);
            Lobe {
                harmonics: PolygonHarmonics::new(of(highest)),
                products: (0..exponent as usize)
                    .map(|k| {
                        let before = highest - k;
                        Product::new(of(before), of(2), of((before - 1).max(least)))
                    })
                    .collect(),
            }
        })
    }
}

impl Sampler for ClosedForm {
    fn order(&self) -> Order {
        self.order
    }

    fn sample(&self, placed: &Placed, at: DVec3) -> Incident {
        self.sum(placed, at, &|_| false, None).0
    }
}

impl ClosedForm {
    /// Incident light and its gradient by the place of the point [annen2004]; of spheres that something hides, as if nothing did.
    pub fn sample_with_gradient(&self, placed: &Placed, at: DVec3) -> (Incident, LightGradient) {
        let none = LightGradient::none(self.order);
        let (incident, gradient) = self.sum(placed, at, &|_| false, Some(none));
        (incident, gradient.expect("as given"))
    }

    /// [`Self::sample_with_gradient`] without solid angles and distances, which black faces take no part in here.
    pub(in crate::light) fn light_with_gradient(
        &self,
        placed: &Placed,
        at: DVec3,
    ) -> (Incident, LightGradient) {
        let is_black =
            |part: Part| matches!(part, Part::Polygon(i) if placed.polygons[i].is_black());
        let none = LightGradient::none(self.order);
        let (incident, gradient) = self.sum(placed, at, &is_black, Some(none));
        (incident, gradient.expect("as given"))
    }

    /// Incident light of all but the parts that `left_out` names, which hide others all the same.
    pub(super) fn sample_without(
        &self,
        placed: &Placed,
        at: DVec3,
        left_out: &dyn Fn(Part) -> bool,
    ) -> Incident {
        self.sum(placed, at, left_out, None).0
    }

    fn sum(
        &self,
        placed: &Placed,
        at: DVec3,
        left_out: &dyn Fn(Part) -> bool,
        gradient: Option<LightGradient>,
    ) -> (Incident, Option<LightGradient>) {
        let holds = |s: &&PlacedSphere| s.centre.distance(at) <= s.radius;
        let around = placed.spheres.iter().find(holds);
        let views = Views::new(placed, at, around);
        let mut sum = Sum {
            form: self,
            views: &views,
            incident: Incident::dark(self.order),
            gradient,
        };
        for (i, (sphere, view)) in placed.spheres.iter().zip(&views.spheres).enumerate() {
            if let Some(view) = view.as_ref().filter(|_| !left_out(Part::Sphere(i))) {
                sum.add_sphere(sphere, view, at);
            }
        }
        for (i, view) in views.polygons.iter().enumerate() {
            if let Some(view) = view.as_ref().filter(|_| !left_out(Part::Polygon(i))) {
                sum.add_polygon(placed, i, view, at);
            }
        }
        if let Some(sphere) = around {
            sum.incident.add_inside(sphere, at);
        }
        (sum.incident, sum.gradient)
    }
}

/// Light of one point, as far as it is added up.
struct Sum<'a> {
    form: &'a ClosedForm,
    views: &'a Views,
    incident: Incident,
    gradient: Option<LightGradient>,
}

/// Room for one lobe.
struct Room<'a> {
    lobe: &'a Lobe,
    work: PolygonWork,
    integrals: Vec<f64>,
    /// `[3][count]`.
    gradient: Vec<f64>,
    corners: Vec<DVec3>,
    lines: Vec<DVec3>,
}

impl Sum<'_> {
    fn room<'b>(&self, exponent: u32) -> Room<'b>
    where
        Self: 'b,
    {
        let lobe = self.form.lobe(exponent);
        Room {
            lobe,
            work: lobe.harmonics.work(),
            integrals: vec![0.0; lobe.harmonics.order().count()],
            gradient: vec![0.0; 3 * lobe.harmonics.order().count()],
            corners: Vec::new(),
            lines: Vec::new(),
        }
    }

    fn add_polygon(&mut self, placed: &Placed, index: usize, view: &View, at: DVec3) {
        let polygon = &placed.polygons[index];
        let front = polygon.normal.dot(view.normal) > 0.0;
        if !front && !polygon.two_sided {
            return;
        }
        let occluders = &placed.occluders()[index];
        let others = if front {
            &occluders.before
        } else {
            &occluders.behind
        };
        let others = others.iter().map(|&i| i as usize);
        let before = self.views.before(view, others);
        let mut room = self.room(polygon.exponent);
        match &polygon.shine {
            Shine::Uniform(rgb) => self.add_part(view, &before, *rgb, &mut room),
            Shine::Cells(cells, triangle) => {
                let tree = &cells.triangles[*triangle];
                let corners = placed.corners(polygon);
                let corners = [corners[0], corners[1], corners[2]].map(|c| c - at);
                let descent = Descent {
                    tree,
                    view,
                    before: &before,
                    front,
                };
                self.add_cell(&descent, 0, corners, &mut room);
            }
        }
    }

    fn add_cell(&mut self, descent: &Descent, cell: usize, corners: [DVec3; 3], room: &mut Room) {
        let Descent { tree, view, .. } = *descent;
        let mut turned = corners;
        if !descent.front {
            turned.reverse();
        }
        let part = view.part(&turned);
        let is_leaf = 4 * cell + 1 >= tree.cells.len();
        if is_leaf || descent.is_even(cell, part.angle(), self.form) {
            self.add_part(&part, descent.before, tree.cells[cell].mean, room);
            return;
        }
        let middle = |a: DVec3, b: DVec3| 0.5 * (a + b);
        for (i, part) in parts(corners, middle).into_iter().enumerate() {
            self.add_cell(descent, 4 * cell + 1 + i, part, room);
        }
    }

    /// Adds what is seen of a part of a face, of one radiance.
    fn add_part(&mut self, part: &View, before: &[Vec<Corner>], rgb: [f32; 3], room: &mut Room) {
        let shines = rgb != [0.0; 3];
        let wants_gradient = shines && self.gradient.is_some();
        room.clear();
        let mut solid_angle = 0.0;
        if before.is_empty() {
            solid_angle += room.add(&part.corners, wants_gradient);
        } else {
            for piece in part.pieces(before) {
                solid_angle += room.add(&piece, wants_gradient);
            }
        }
        self.incident.solid_angle += solid_angle;
        // 1/d = cosine / height, and degree 1 holds ∫ ω dω.
        let along = part.normal.dot(first_moment(&room.integrals));
        self.incident.inverse_distance += -along / part.height;
        if shines {
            let (lobe, d) = (room.lobe, -part.normal);
            self.incident.add(&lobe.falloff(&room.integrals, d), rgb);
            if let Some(gradient) = &mut self.gradient {
                let axes = room.gradient.chunks_exact(room.integrals.len());
                let axes: Vec<f64> = axes
                    .flat_map(|axis| lobe.falloff(axis, d).into_owned())
                    .collect();
                gradient.add(&axes, rgb);
            }
        }
    }

    fn add_sphere(&mut self, sphere: &PlacedSphere, view: &View, at: DVec3) {
        let toward = sphere.centre - at;
        let whole = Cap::new(sphere.radius, toward.length());
        let before = self.views.before(view, 0..self.views.polygons.len());
        if before.is_empty() {
            let lobe = Zonal::disc(self.form.order, whole.half_angle).toward(toward.normalize());
            self.incident.add(&lobe, sphere.radiance);
            self.incident.solid_angle += whole.solid_angle();
            self.incident.inverse_distance += whole.inverse_distance();
            self.add_sphere_gradient(sphere, toward);
            return;
        }
        let mut room = self.room(0);
        let so_far = (self.incident.solid_angle, self.incident.inverse_distance);
        self.add_part(view, &before, sphere.radiance, &mut room);
        let share = (self.incident.solid_angle - so_far.0) / whole.solid_angle();
        self.incident.inverse_distance = so_far.1 + share * whole.inverse_distance();
    }
}

impl Sum<'_> {
    /// By central differences of what is known in closed form.
    fn add_sphere_gradient(&mut self, sphere: &PlacedSphere, toward: DVec3) {
        let Some(gradient) = &mut self.gradient else {
            return;
        };
        let step = 1e-5 * (toward.length() - sphere.radius);
        let order = self.form.order;
        let lobe = |toward: DVec3| {
            let cap = Cap::new(sphere.radius, toward.length());
            Zonal::disc(order, cap.half_angle).toward(toward.normalize())
        };
        let difference = |axis: DVec3| -> Vec<f64> {
            let (after, before) = (lobe(toward - axis * step), lobe(toward + axis * step));
            let pairs = after.iter().zip(&before);
            pairs.map(|(a, b)| (a - b) / (2.0 * step)).collect()
        };
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(difference).concat();
        gradient.add(&axes, sphere.radiance);
    }
}

impl Room<'_> {
    fn clear(&mut self) {
        self.integrals.fill(0.0);
        self.gradient.fill(0.0);
    }

    /// Adds a convex piece, and gives its solid angle.
    fn add(&mut self, piece: &[Corner], wants_gradient: bool) -> f64 {
        let harmonics = &self.lobe.harmonics;
        self.corners.clear();
        self.corners.extend(piece.iter().map(|c| c.at));
        if wants_gradient {
            self.lines.clear();
            self.lines.extend(piece.iter().map(|c| c.line));
            harmonics.add_gradient(
                &self.corners,
                &self.lines,
                &mut self.work,
                &mut self.gradient,
            );
        }
        harmonics.add(&self.corners, &mut self.work, &mut self.integrals)
    }
}

impl Lobe {
    /// Coefficients times the exponent's power of the cosine d·ω.
    fn falloff<'a>(&self, values: &'a [f64], d: DVec3) -> Cow<'a, [f64]> {
        let mut values = Cow::Borrowed(values);
        for product in &self.products {
            let mut lower = vec![0.0; product.orders()[2].count()];
            product.multiply(&values, &linear(d), &mut lower);
            values = Cow::Owned(lower);
        }
        values
    }
}

/// A walk down the cells of a triangle.
#[derive(Clone, Copy)]
struct Descent<'a> {
    tree: &'a CellTree,
    view: &'a View,
    before: &'a [Vec<Corner>],
    front: bool,
}

impl Descent<'_> {
    /// Whether a cell seen under `angle` may stand for its parts.
    fn is_even(&self, cell: usize, angle: f64, form: &ClosedForm) -> bool {
        let largest = |rgb: [f32; 3]| f64::from(rgb[0].max(rgb[1]).max(rgb[2]));
        let turn = (angle * form.order.get() as f64).min(1.0);
        let spread = f64::from(self.tree.cells[cell].spread);
        spread * turn <= form.tolerance * largest(self.tree.cells[0].mean)
    }
}

/// `∫ ω dω` from the integrals of degree 1.
fn first_moment(integrals: &[f64]) -> DVec3 {
    DVec3::new(integrals[3], integrals[1], integrals[2]) * (4.0 * PI / 3.0).sqrt()
}

/// Coefficients of d·ω.
fn linear(d: DVec3) -> [f64; 4] {
    let scale = (4.0 * PI / 3.0).sqrt();
    [0.0, scale * d.y, scale * d.z, scale * d.x]
}
