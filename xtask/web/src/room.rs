//! The gallery's room: a corner that light comes into from the front and from above.

use glam::Vec3;
use relume::scene::{Albedo, Scene, SceneError, Triangles};

const WHITE: [f32; 3] = [0.75, 0.73, 0.7];
const RED: [f32; 3] = [0.65, 0.06, 0.05];
const GREEN: [f32; 3] = [0.12, 0.45, 0.09];
/// Edges of its triangles, metres.
const EDGE: f32 = 0.06;

/// Floor, back wall, a red wall on the left, a low green one on the right, a shelf, and two blocks on the floor.
pub fn room() -> Result<Scene, SceneError> {
    let mut patches = Patches::default();
    let at = Vec3::new;
    patches.add(at(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, WHITE);
    patches.add(at(-1.0, 0.0, -1.0), Vec3::X * 2.0, Vec3::Y * 1.6, WHITE);
    patches.add(at(-1.0, 0.0, 1.0), Vec3::NEG_Z * 2.0, Vec3::Y * 1.6, RED);
    patches.block(at(0.9, 0.0, -1.0), at(1.0, 0.5, 0.4), GREEN);
    patches.block(at(-0.6, 0.95, -0.99), at(0.7, 1.02, -0.6), WHITE);
    patches.block(at(-0.6, 0.0, -0.6), at(-0.1, 0.7, -0.1), WHITE);
    patches.block(at(0.2, 0.0, -0.1), at(0.55, 0.35, 0.25), WHITE);
    Scene::from_triangles(Triangles {
        positions: patches.positions,
        triangles: patches.triangles,
        normals: None,
        albedo: Albedo::PerVertex(patches.albedos),
        double_sided: false,
    })
}

/// Rectangles of small triangles; each has vertices of its own, so that edges stay sharp.
#[derive(Default)]
struct Patches {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    albedos: Vec<[f32; 3]>,
}

impl Patches {
    /// The rectangle with sides `u` and `v` at `corner`, facing along u × v.
    fn add(&mut self, corner: Vec3, u: Vec3, v: Vec3, albedo: [f32; 3]) {
        let cells = |side: Vec3| (side.length() / EDGE).ceil().max(1.0) as u32;
        let (across, along) = (cells(u), cells(v));
        let first = self.positions.len() as u32;
        for j in 0..=along {
            for i in 0..=across {
                let (s, t) = (i as f32 / across as f32, j as f32 / along as f32);
                self.positions.push(corner + u * s + v * t);
                self.albedos.push(albedo);
            }
        }
        let row = across + 1;
        for j in 0..along {
            for i in 0..across {
                let a = first + j * row + i;
                self.triangles.push([a, a + 1, a + row + 1]);
                self.triangles.push([a, a + row + 1, a + row]);
            }
        }
    }

    /// The faces of a box that can be seen from in front, above or aside: all but its bottom, unless that is off the floor.
    fn block(&mut self, low: Vec3, high: Vec3, albedo: [f32; 3]) {
        let size = high - low;
        let (x, y, z) = (Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z);
        self.add(low + z, x, y, albedo);
        self.add(low + x, -x, y, albedo);
        self.add(low, z, y, albedo);
        self.add(low + x + z, -z, y, albedo);
        self.add(low + y, z, x, albedo);
        if low.y > 0.0 {
            self.add(low, x, z, albedo);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_face_outward() {
        let mut patches = Patches::default();
        patches.block(Vec3::splat(0.1), Vec3::ONE, WHITE);
        let middle = Vec3::splat(0.55);
        for [a, b, c] in patches.triangles {
            let [a, b, c] = [a, b, c].map(|i| patches.positions[i as usize]);
            assert!((b - a).cross(c - a).dot(a - middle) > 0.0);
        }
    }
}
