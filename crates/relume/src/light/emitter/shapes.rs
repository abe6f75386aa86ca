//! Meshes to make emitters of, and what is asked of any.

use std::f64::consts::PI;

use glam::{DVec3, Vec2};

use super::{EmitterMesh, Pattern};

/// Faces whose area is below this share of their size squared are none.
pub const THIN: f64 = 1e-12;
/// Corners of a disc.
const ROUND: u32 = 48;

impl EmitterMesh {
    /// A rectangle in the plane z = 0 about the origin that shines toward +z, the top of its texture toward +y.
    pub fn quad(width: f64, height: f64) -> Self {
        let (x, y) = (0.5 * width, 0.5 * height);
        let corner = |u: f32, v: f32| {
            (
                DVec3::new(
                    if u < 0.5 { -x } else { x },
                    if v < 0.5 { y } else { -y },
                    0.0,
                ),
                Vec2::new(u, v),
            )
        };
        let corners = [
            corner(0.0, 1.0),
            corner(1.0, 1.0),
            corner(1.0, 0.0),
            corner(0.0, 0.0),
        ];
        Self {
            positions: corners.map(|c| c.0).to_vec(),
            uvs: corners.map(|c| c.1).to_vec(),
            faces: vec![vec![0, 1, 2, 3]],
        }
    }

    /// A disc in the plane z = 0 about the origin that shines toward +z: a regular polygon of 48 corners and of the disc's area.
    pub fn disc(radius: f64) -> Self {
        let step = 2.0 * PI / f64::from(ROUND);
        let radius = radius * (step / libm::sin(step)).sqrt();
        let on_rim = |i: u32| {
            let (sin, cos) = libm::sincos(step * f64::from(i));
            DVec3::new(radius * cos, radius * sin, 0.0)
        };
        let positions: Vec<DVec3> = (0..ROUND).map(on_rim).collect();
        let uv = |p: &DVec3| {
            Vec2::new(
                (0.5 + 0.5 * p.x / radius) as f32,
                (0.5 - 0.5 * p.y / radius) as f32,
            )
        };
        Self {
            uvs: positions.iter().map(uv).collect(),
            positions,
            faces: vec![(0..ROUND).collect()],
        }
    }

    /// `columns` × `rows` rectangles in the plane z = 0, together `width` × `height` about the origin, that shine toward +z: row after row from
    /// the top, each `fill` (0…1) of its cell's sides. The matrix of coloured blocks [sun2005, Fig. 4.1].
    pub fn blocks(columns: u32, rows: u32, width: f64, height: f64, fill: f64) -> Self {
        let mut mesh = Self::default();
        let cell = DVec3::new(width / f64::from(columns), height / f64::from(rows), 0.0);
        for row in 0..rows {
            for column in 0..columns {
                let middle = DVec3::new(
                    cell.x * (f64::from(column) + 0.5) - 0.5 * width,
                    0.5 * height - cell.y * (f64::from(row) + 0.5),
                    0.0,
                );
                let first = mesh.positions.len() as u32;
                for (x, y) in [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)] {
                    mesh.positions
                        .push(middle + DVec3::new(x * fill * cell.x, y * fill * cell.y, 0.0));
                }
                mesh.faces.push((first..first + 4).collect());
            }
        }
        mesh
    }

    /// A box about the origin that shines outward.
    pub fn cuboid(size: DVec3) -> Self {
        let corner = |i: u32| {
            let sign = |bit: u32| if i & bit == 0 { -0.5 } else { 0.5 };
            size * DVec3::new(sign(1), sign(2), sign(4))
        };
        let faces = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        Self {
            positions: (0..8).map(corner).collect(),
            uvs: Vec::new(),
            faces: faces.map(Vec::from).to_vec(),
        }
    }

    /// A sphere of 320 triangles about the origin whose corners stand as far out as gives it the sphere's cross-section, on the mean.
    pub fn sphere(radius: f64) -> Self {
        let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
        let mut positions = Vec::new();
        for (a, b) in [
            (-1.0, golden),
            (1.0, golden),
            (-1.0, -golden),
            (1.0, -golden),
        ] {
            positions.push(DVec3::new(a, b, 0.0).normalize());
            positions.push(DVec3::new(0.0, a, b).normalize());
            positions.push(DVec3::new(b, 0.0, a).normalize());
        }
        let mut faces = icosahedron(&positions);
        for _ in 0..2 {
            let mut finer = Vec::new();
            for [a, b, c] in faces {
                let [ab, bc, ca] =
                    [(a, b), (b, c), (c, a)].map(|(i, j)| middle(&mut positions, i, j));
                finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
            }
            faces = finer;
        }
        let corners = |face: &[u32; 3]| face.map(|i| positions[i as usize]);
        // A convex body's mean cross-section is a quarter of its surface (Cauchy).
        let surface: f64 = faces
            .iter()
            .map(|f| area_vector(&corners(f)).length())
            .sum();
        let scale = radius * (4.0 * PI / surface).sqrt();
        Self {
            faces: faces.iter().map(|f| f.to_vec()).collect(),
            positions: positions.iter().map(|p| *p * scale).collect(),
            uvs: Vec::new(),
        }
    }
}

/// The faces of the icosahedron with these corners: all triples at the shortest distance from one another.
fn icosahedron(corners: &[DVec3]) -> Vec<[u32; 3]> {
    let near = |i: usize, j: usize| corners[i].distance(corners[j]) < 1.2;
    let mut faces = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                if near(i, j) && near(j, k) && near(k, i) {
                    let outward = corners[i].dot(corners[j].cross(corners[k])) > 0.0;
                    let (i, j, k) = (i as u32, j as u32, k as u32);
                    faces.push(if outward { [i, j, k] } else { [i, k, j] });
                }
            }
        }
    }
    faces
}

/// The corner on the unit sphere between two others, which there may be already.
fn middle(positions: &mut Vec<DVec3>, i: u32, j: u32) -> u32 {
    let between = (positions[i as usize] + positions[j as usize]).normalize();
    let known = positions.iter().position(|p| p.distance(between) < 1e-9);
    known.unwrap_or_else(|| {
        positions.push(between);
        positions.len() - 1
    }) as u32
}

/// The area of a flat polygon times its unit normal.
pub fn area_vector(corners: &[DVec3]) -> DVec3 {
    let fan = corners[1..].windows(2);
    let twice: DVec3 = fan
        .map(|pair| (pair[0] - corners[0]).cross(pair[1] - corners[0]))
        .sum();
    0.5 * twice
}

/// The farthest of the corners from the first.
pub fn size(corners: &[DVec3]) -> f64 {
    corners
        .iter()
        .map(|c| c.distance(corners[0]))
        .fold(0.0, f64::max)
}

/// Leaves faces without area out, and what the pattern says of them.
pub fn drop_degenerate(mesh: &mut EmitterMesh, pattern: &mut Pattern) {
    let keep: Vec<bool> = mesh
        .faces
        .iter()
        .map(|face| {
            let corners: Vec<DVec3> = face.iter().map(|&c| mesh.positions[c as usize]).collect();
            let size = size(&corners);
            area_vector(&corners).length() > THIN * size * size
        })
        .collect();
    let mut kept = keep.iter();
    mesh.faces.retain(|_| *kept.next().unwrap_or(&true));
    if let Pattern::PerFace(radiance) = pattern {
        let mut kept = keep.iter();
        radiance.retain(|_| *kept.next().unwrap_or(&true));
    }
}
