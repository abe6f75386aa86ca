//! The paper's lights, as far as its figures show them, about any mesh.

use glam::{DAffine3, DQuat, DVec3, Vec3};
use relume::light::emitter::{
    Emitter, EmitterError, EmitterMesh, Emitters, Pattern, Placed, Shape,
};

/// A box around an object.
pub struct Bounds {
    middle: DVec3,
    half: DVec3,
}

impl Bounds {
    pub fn of(positions: &[Vec3]) -> Self {
        let low = positions.iter().fold(Vec3::INFINITY, |a, p| a.min(*p));
        let high = positions.iter().fold(Vec3::NEG_INFINITY, |a, p| a.max(*p));
        let (low, high) = (low.as_dvec3(), high.as_dvec3());
        Self {
            middle: 0.5 * (low + high),
            half: 0.5 * (high - low),
        }
    }

    /// A point by shares of the half sides.
    fn at(&self, x: f64, y: f64, z: f64) -> DVec3 {
        self.middle + self.half * DVec3::new(x, y, z)
    }

    fn size(&self) -> f64 {
        self.half.max_element()
    }
}

/// Something that shines toward `target`.
fn emitter(name: &str, mesh: EmitterMesh, pattern: Pattern, at: DVec3, target: DVec3) -> Emitter {
    let turn = DQuat::from_rotation_arc(DVec3::Z, (target - at).normalize_or(DVec3::Z));
    Emitter {
        name: name.to_owned(),
        shape: Shape::Mesh(mesh),
        pattern,
        two_sided: false,
        exponent: 0,
        world_from_emitter: DAffine3::from_rotation_translation(turn, at),
    }
}

/// Fig. 4.1: a square matrix of coloured blocks before the object; with a black bar between, in the rows that hide.
pub fn matrix(bounds: &Bounds, bar: bool) -> Result<Placed, EmitterError> {
    const COLOURS: [[f32; 3]; 4] = [
        [3.0, 0.3, 0.3],
        [0.3, 3.0, 0.3],
        [0.3, 0.3, 3.0],
        [3.0, 3.0, 0.5],
    ];
    let colours = (0..16).map(|i| COLOURS[(i + i / 4) % 4]).collect();
    let side = 2.4 * bounds.size();
    let before = bounds.at(0.0, 0.0, 1.0) + DVec3::Z * (0.7 * bounds.size());
    let blocks = EmitterMesh::blocks(4, 4, side, side, 0.8);
    let mut all = vec![emitter(
        "blocks",
        blocks,
        Pattern::PerFace(colours),
        before,
        bounds.middle,
    )];
    if bar {
        let at = bounds.at(0.0, 0.0, 1.0) + DVec3::Z * (0.35 * bounds.size());
        let mesh = EmitterMesh::quad(0.5 * bounds.size(), side);
        let mut bar = emitter("bar", mesh, Pattern::Uniform([0.0; 3]), at, bounds.middle);
        bar.two_sided = true;
        all.push(bar);
    }
    Ok(Emitters::new(all)?.placed())
}

/// Fig. 4.4(b): two large planes, and three cubes in red, white and green close by.
pub fn near(bounds: &Bounds) -> Result<Placed, EmitterError> {
    let size = bounds.size();
    let plane = |x: f64, z: f64| {
        let at = bounds.at(x, 1.5, z);
        let mesh = EmitterMesh::quad(1.5 * size, 1.5 * size);
        emitter(
            "plane",
            mesh,
            Pattern::Uniform([0.5, 0.5, 0.6]),
            at,
            bounds.middle,
        )
    };
    let cube = |x: f64, y: f64, radiance: [f32; 3]| {
        let at = bounds.at(x, y, 1.0) + DVec3::Z * (0.18 * size);
        let mesh = EmitterMesh::cuboid(DVec3::splat(0.15 * size));
        emitter("cube", mesh, Pattern::Uniform(radiance), at, at + DVec3::Z)
    };
    let all = vec![
        plane(-3.0, 2.0),
        plane(3.0, 2.0),
        cube(-0.6, -0.5, [6.0, 0.6, 0.6]),
        cube(0.0, 0.2, [6.0, 6.0, 6.0]),
        cube(0.6, -0.5, [0.6, 6.0, 0.6]),
    ];
    Ok(Emitters::new(all)?.placed())
}

/// Fig. 4.4(a): three large planes far away.
pub fn far(bounds: &Bounds) -> Result<Placed, EmitterError> {
    let size = bounds.size();
    let plane = |x: f64, y: f64, z: f64| {
        let at = bounds.middle + DVec3::new(x, y, z) * size;
        let mesh = EmitterMesh::quad(6.0 * size, 6.0 * size);
        emitter(
            "plane",
            mesh,
            Pattern::Uniform([1.0, 1.0, 1.0]),
            at,
            bounds.middle,
        )
    };
    let all = vec![
        plane(-12.0, 8.0, 12.0),
        plane(12.0, 8.0, 12.0),
        plane(0.0, 16.0, -8.0),
    ];
    Ok(Emitters::new(all)?.placed())
}
