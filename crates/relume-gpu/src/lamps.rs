//! Emitters in the picture: triangles that shine as the emitters do.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use relume::light::emitter::{Pattern, Placed, PlacedPolygon, PlacedSphere};
use wgpu::{Buffer, BufferUsages, Device, PrimitiveTopology, RenderPass, RenderPipeline};

use crate::GpuError;
use crate::layouts::LampVertex;
use crate::mesh::buffer;
use crate::pipeline::{Depth, Pipeline, shader};
use crate::pipelines::{Kind, VIEW, ViewPass};

/// What is added to [`VIEW`].
const LAMPS: &str = include_str!("shaders/lamps.wgsl");
/// Triangles from a sphere's equator to its pole, and a quarter around.
const SPHERE: usize = 12;
/// Parts of a side of a triangle whose radiance is an image.
const IMAGE: usize = 16;

/// The module.
pub fn source() -> String {
    format!("{VIEW}\n{LAMPS}")
}

/// Emitters where they stand, and the pipeline that draws them.
pub struct Lamps {
    pipeline: RenderPipeline,
    /// Three for each triangle.
    corners: Buffer,
    count: u32,
}

impl Lamps {
    /// Uploads all faces and spheres; makes the pipeline, unless `last` has one.
    pub fn new(
        device: &Device,
        view: &ViewPass,
        placed: &Placed,
        last: Option<Self>,
    ) -> Result<Self, GpuError> {
        let corners = corners(placed);
        let bytes = bytemuck::cast_slice(&corners);
        Ok(Self {
            corners: buffer(device, "emitters", bytes, BufferUsages::VERTEX)?,
            count: corners.len() as u32,
            pipeline: match last {
                Some(last) => last.pipeline,
                None => pipeline(device, view),
            },
        })
    }

    /// Draws them; the view is bound.
    pub fn draw(&self, pass: &mut RenderPass) {
        pass.set_pipeline(&self.pipeline);
        pass.set_vertex_buffer(0, self.corners.slice(..));
        pass.draw(0..self.count, 0..1);
    }
}

fn pipeline(device: &Device, view: &ViewPass) -> RenderPipeline {
    let pipeline = Pipeline {
        shader: &shader(device, "lamps", &source()),
        vertex: "lamp_vertex",
        fragment: "lamp",
        groups: &[&view.view],
        target: view.target,
        mesh: Some((LampVertex::LAYOUT, PrimitiveTopology::TriangleList)),
        depth: Some(Depth::Nearer),
        constants: &Kind::default().constants(view.target),
    };
    pipeline.create(device)
}

fn corners(placed: &Placed) -> Vec<LampVertex> {
    let mut corners = Vec::new();
    for polygon in placed.polygons() {
        add_polygon(placed, polygon, &mut corners);
    }
    for sphere in placed.spheres() {
        add_sphere(sphere, &mut corners);
    }
    corners
}

fn add_polygon(placed: &Placed, polygon: &PlacedPolygon, corners: &mut Vec<LampVertex>) {
    let at = |point: DVec3| LampVertex {
        position: point.as_vec3().to_array(),
        normal: polygon.normal.as_vec3().to_array(),
        radiance: placed.radiance_toward(polygon, point, polygon.normal),
        shine: [polygon.exponent as f32, f32::from(polygon.two_sided)],
    };
    let emitter = &placed.emitters()[polygon.emitter];
    let is_image = matches!(emitter.pattern, Pattern::Texture { .. });
    let places = placed.corners(polygon);
    for pair in places[1..].windows(2) {
        let [a, b, c] = [places[0], pair[0], pair[1]];
        let parts = if is_image { IMAGE } else { 1 };
        let grid =
            |i: usize, j: usize| a + ((b - a) * i as f64 + (c - a) * j as f64) / parts as f64;
        for i in 0..parts {
            for j in 0..parts - i {
                corners.extend([grid(i, j), grid(i + 1, j), grid(i, j + 1)].map(at));
                if i + j + 1 < parts {
                    let upper = [grid(i + 1, j), grid(i + 1, j + 1), grid(i, j + 1)];
                    corners.extend(upper.map(at));
                }
            }
        }
    }
}

fn add_sphere(sphere: &PlacedSphere, corners: &mut Vec<LampVertex>) {
    let direction = |i: usize, j: usize| {
        let (latitude, longitude) = (
            PI * i as f64 / (2 * SPHERE) as f64,
            TAU * j as f64 / (4 * SPHERE) as f64,
        );
        let (across, up) = (latitude.sin(), latitude.cos());
        DVec3::new(across * longitude.sin(), up, across * longitude.cos())
    };
    for (i, j) in (0..2 * SPHERE).flat_map(|i| (0..4 * SPHERE).map(move |j| (i, j))) {
        let quad = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| direction(i, j));
        let normal = quad.iter().sum::<DVec3>().normalize().as_vec3().to_array();
        let at = |direction: DVec3| LampVertex {
            position: (sphere.centre + sphere.radius * direction)
                .as_vec3()
                .to_array(),
            normal,
            radiance: sphere.radiance,
            shine: [0.0, f32::from(sphere.two_sided)],
        };
        corners.extend([quad[0], quad[1], quad[2], quad[0], quad[2], quad[3]].map(at));
    }
}
