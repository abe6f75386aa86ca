//! Vertices of a real mesh, each with a view.

use std::error::Error;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use glam::DVec3;
use relume::asset::Transfer;
use relume::bake::{self, BakeOptions, Monitor};
use relume::basis::{Angle, Euler, EulerRotation, Order};
use relume::brdf::Brdf;
use relume::light::{self, IncidentLight, LightOptions, ShLight};
use relume::reference::{
    EstimateOptions, Seen, Sources, estimate_outgoing, receivers_at, sh_radiance,
};
use relume::scene::{self, ImportOptions, World};
use relume::shade::TransferredRadiance;

use crate::operator::by_azimuth;
use crate::ways::{Eye, Space, azimuth};

/// A mesh, and which vertices are seen from where.
pub struct Mesh {
    pub world: World,
    pub vertices: Vec<usize>,
    eyes: Vec<Eye>,
}

/// A vertex under the light, and who looks at it.
pub struct Pair {
    pub eye: Eye,
    /// By space; of the green plane.
    transferred: [Vec<f32>; 3],
}

/// Path-traced radiance of all pairs.
pub struct Paths {
    pub mean: Vec<f64>,
    pub noise: f64,
}

impl Mesh {
    /// About `count` vertices, each seen from a direction of its own; as many directions as pixels would see, cosine-distributed.
    pub fn load(path: &Path, count: usize) -> Result<Self, Box<dyn Error>> {
        let world = World::new(&scene::load(path, &ImportOptions::default())?);
        let step = (world.positions.len() / count).max(1);
        let vertices: Vec<usize> = (0..world.positions.len()).step_by(step).collect();
        let eye = |(k, &vertex): (usize, &usize)| {
            // A plane lattice of the plastic number.
            let lattice = |a: f64| ((k as f64 + 0.5) * a).fract();
            let (u, v) = (
                lattice(0.754_877_666_246_693),
                lattice(0.569_840_290_998_053_3),
            );
            let (sin, cos) = (std::f64::consts::TAU * v).sin_cos();
            let local = DVec3::new(u.sqrt() * cos, u.sqrt() * sin, (1.0 - u).sqrt());
            let normal = world.normals[vertex].as_dvec3().normalize();
            Eye {
                local: local.as_vec3().to_array(),
                normal,
                world: (Euler::z_to(normal, Angle::ZERO).matrix() * local).normalize(),
            }
        };
        let eyes = vertices.iter().enumerate().map(eye).collect();
        Ok(Self {
            world,
            vertices,
            eyes,
        })
    }

    pub fn eyes(&self) -> &[Eye] {
        &self.eyes
    }

    pub fn bake(&self, orders: [Order; 2], samples: u32) -> Result<Transfer, Box<dyn Error>> {
        let options = BakeOptions {
            order: orders[0],
            transfer_order: Some(orders[1]),
            samples,
            ..BakeOptions::default()
        };
        let monitor = Monitor {
            progress: &|_| (),
            cancelled: &AtomicBool::new(false),
        };
        Ok(bake::bake(&self.world, &options, &monitor)?.transfer)
    }

    /// Transferred radiance at the vertices.
    pub fn pairs(&self, transfer: &Transfer) -> Result<Vec<Pair>, Box<dyn Error>> {
        let light = IncidentLight::Distant(sky(transfer.order)?);
        let transferred = TransferredRadiance::new(transfer, &light).ok_or("no matrices")?;
        let order = transferred.order;
        let rotation = EulerRotation::new(order);
        let pair = |(&vertex, eye): (&usize, &Eye)| {
            let green = &transferred.front[(3 * vertex + 1) * order.count()..][..order.count()];
            Pair::new(green, *eye, order, &rotation)
        };
        Ok(self.vertices.iter().zip(&self.eyes).map(pair).collect())
    }

    /// The same radiance by paths that see the light's expansion itself.
    pub fn paths(&self, brdf: &Brdf, order: Order, paths: u32) -> Result<Paths, Box<dyn Error>> {
        let light = sky(order)?;
        let options = EstimateOptions {
            bounces: 0,
            paths,
            ..EstimateOptions::default()
        };
        let surfaces = |_, _| brdf.clone();
        let found = estimate_outgoing(
            &self.world,
            &surfaces,
            &self.seen()?,
            &Sources::distant(&sh_radiance(&light)),
            &options,
        );
        let sum =
            |value: &dyn Fn(usize) -> f64| (0..found.len()).map(|i| value(i).powi(2)).sum::<f64>();
        let noise = sum(&|i| found[i].standard_error[1]) / sum(&|i| found[i].mean[1]);
        Ok(Paths {
            mean: found.iter().map(|estimate| estimate.mean[1]).collect(),
            noise: noise.sqrt(),
        })
    }

    /// The vertices as the path tracer takes them: a corner of a triangle.
    fn seen(&self) -> Result<Vec<Seen>, Box<dyn Error>> {
        let mut corners = vec![None; self.world.positions.len()];
        for (triangle, vertices) in self.world.triangles.iter().enumerate() {
            for (corner, &vertex) in vertices.iter().enumerate() {
                corners[vertex as usize].get_or_insert((triangle as u32, corner));
            }
        }
        let receivers = receivers_at(&self.world, &self.vertices);
        let mut all = Vec::new();
        for ((&vertex, receiver), eye) in self.vertices.iter().zip(receivers).zip(&self.eyes) {
            let (triangle, corner) = corners[vertex].ok_or("a vertex that no triangle uses")?;
            let mut weights = [0.0; 3];
            weights[corner] = 1.0;
            all.push(Seen {
                receiver,
                triangle,
                weights,
                toward_eye: eye.world,
            });
        }
        Ok(all)
    }
}

pub fn sky(order: Order) -> Result<ShLight, Box<dyn Error>> {
    let (sky, _) = light::load(&"sky:30,3".parse()?, &LightOptions::default())?;
    Ok(sky.project(order))
}

impl Pair {
    pub fn new(world: &[f32], eye: Eye, order: Order, rotation: &EulerRotation) -> Self {
        let in_world: Vec<f64> = world.iter().map(|&a| a.into()).collect();
        let (mut local, mut scratch) = (in_world.clone(), vec![0.0; order.count()]);
        let to_local = Euler::z_to(eye.normal, Angle::ZERO).inverse();
        rotation.apply(&to_local, &mut local, &mut scratch);
        let transferred = [
            by_azimuth(order, &local),
            by_azimuth(order, &in_world),
            world.to_vec(),
        ];
        Self { eye, transferred }
    }

    /// Of the transferred radiance.
    pub fn order(&self) -> Order {
        let count = self.transferred[0].len();
        Order::from_count(count).expect("an expansion")
    }

    pub fn transferred(&self, space: Space) -> &[f32] {
        &self.transferred[space as usize]
    }

    /// Radiance toward the eye, where `row` is the exact reflection toward its polar angle, by azimuth.
    pub fn reflect(&self, row: &[f64]) -> f64 {
        let a = &self.transferred[Space::Tangent as usize];
        let order = a.len().isqrt();
        let (x, y) = azimuth(self.eye.local);
        let phi = f64::from(y).atan2(x.into());
        let (mut a, mut row, mut total) = (a.as_slice(), row, 0.0);
        for mu in 0..order {
            let size = order - mu;
            let (sin, cos) = (mu as f64 * phi).sin_cos();
            let waves: &[f64] = if mu == 0 { &[1.0] } else { &[cos, sin] };
            for wave in waves {
                let pairs = a.iter().zip(&row[..size]);
                total += wave * pairs.map(|(&a, o)| f64::from(a) * o).sum::<f64>();
                a = &a[size..];
            }
            row = &row[size..];
        }
        total
    }
}
