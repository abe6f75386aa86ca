//! A light that stands near, as it is edited.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};
use relume::light::emitter::{Emitter, EmitterMesh, Pattern, Shape};

/// An emitter, its radiance apart: as it was made, times a colour and a strength.
#[derive(Clone, Debug)]
pub struct Lamp {
    /// Shape, pose and what else does not change; its pattern is what colour and strength multiply.
    pub emitter: Emitter,
    /// Linear Rec. 709, 0…1.
    pub colour: [f32; 3],
    /// Radiance where colour and pattern are 1.
    pub strength: f32,
}

/// What can be put into a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Made {
    /// A square that shines to one side.
    Panel,
    /// A round one.
    Disc,
    /// A ball.
    Ball,
    /// A box.
    Box,
    /// Three coloured blocks side by side.
    Blocks,
    /// A black square that hides what shines behind it.
    Screen,
}

impl Made {
    /// Each, with its name.
    pub const ALL: [(Self, &str); 6] = [
        (Self::Panel, "panel"),
        (Self::Disc, "disc"),
        (Self::Ball, "ball"),
        (Self::Box, "box"),
        (Self::Blocks, "blocks"),
        (Self::Screen, "screen"),
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::ALL
            .iter()
            .find(|(made, _)| *made == self)
            .map_or("", |(_, name)| name)
    }

    /// One of this size, metres, at `from`, facing `to`.
    pub fn lamp(self, size: f64, from: DVec3, to: DVec3) -> Lamp {
        let mesh = match self {
            Self::Panel | Self::Screen => EmitterMesh::quad(size, size),
            Self::Disc => EmitterMesh::disc(0.5 * size),
            Self::Box => EmitterMesh::cuboid(DVec3::splat(0.7 * size)),
            Self::Blocks => EmitterMesh::blocks(3, 1, 1.5 * size, 0.5 * size, 0.9),
            Self::Ball => EmitterMesh::default(),
        };
        let emitter = Emitter {
            name: self.name().to_owned(),
            shape: match self {
                Self::Ball => Shape::Sphere {
                    radius: 0.35 * size,
                },
                _ => Shape::Mesh(mesh),
            },
            pattern: match self {
                Self::Blocks => Pattern::PerFace(vec![
                    [1.0, 0.05, 0.05],
                    [0.05, 1.0, 0.05],
                    [0.05, 0.05, 1.0],
                ]),
                _ => Pattern::Uniform([1.0; 3]),
            },
            two_sided: false,
            exponent: 0,
            world_from_emitter: DAffine3 {
                matrix3: facing(to - from),
                translation: from,
            },
        };
        Lamp {
            emitter,
            colour: [1.0; 3],
            strength: if self == Self::Screen { 0.0 } else { 10.0 },
        }
    }
}

impl Lamp {
    /// One from a file: a uniform radiance is colour times strength, of another pattern both begin at 1.
    pub fn of(emitter: Emitter) -> Self {
        let (mut colour, mut strength) = ([1.0; 3], 1.0);
        let mut emitter = emitter;
        if let Pattern::Uniform(radiance) = emitter.pattern {
            strength = radiance.into_iter().fold(0.0, f32::max);
            if strength > 0.0 {
                colour = radiance.map(|x| x / strength);
            }
            emitter.pattern = Pattern::Uniform([1.0; 3]);
        }
        Self {
            emitter,
            colour,
            strength,
        }
    }

    /// As it shines.
    pub fn shining(&self) -> Emitter {
        let scale = self.colour.map(|c| c * self.strength);
        let times = |rgb: &[f32; 3]| std::array::from_fn(|c| rgb[c] * scale[c]);
        let all = |rows: &[[f32; 3]]| rows.iter().map(times).collect();
        let pattern = match &self.emitter.pattern {
            Pattern::Uniform(rgb) => Pattern::Uniform(times(rgb)),
            Pattern::PerFace(rows) => Pattern::PerFace(all(rows)),
            Pattern::PerVertex(rows) => Pattern::PerVertex(all(rows)),
            Pattern::Texture { image, factor } => Pattern::Texture {
                image: Arc::clone(image),
                factor: times(factor),
            },
        };
        Emitter {
            pattern,
            ..self.emitter.clone()
        }
    }

    /// Whether it is a sphere, which has no sides and no exponent.
    pub fn is_sphere(&self) -> bool {
        matches!(self.emitter.shape, Shape::Sphere { .. })
    }

    /// Turns it toward a point.
    pub fn face(&mut self, target: DVec3) {
        let pose = &mut self.emitter.world_from_emitter;
        let scale = pose.matrix3.determinant().cbrt();
        pose.matrix3 = facing(target - pose.translation) * scale;
    }
}

/// The rotation that brings +z to a direction, and +y as near to +y as that allows.
fn facing(direction: DVec3) -> DMat3 {
    let z = direction.normalize_or(DVec3::Z);
    let level = DVec3::Y.cross(z).try_normalize();
    let x = level.unwrap_or_else(|| DVec3::X.cross(z).normalize());
    DMat3::from_cols(x, z.cross(x), z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use relume::light::emitter::Emitters;

    #[test]
    fn everything_that_can_be_made_is_an_emitter_that_faces_the_scene() {
        for (made, name) in Made::ALL {
            let from = DVec3::new(1.0, 2.0, -3.0);
            let mut lamp = made.lamp(0.5, from, DVec3::ZERO);
            assert_eq!(lamp.emitter.name, name);
            let toward = lamp.emitter.world_from_emitter.matrix3.z_axis;
            assert!((toward + from.normalize()).length() < 1e-12);
            lamp.emitter.world_from_emitter.matrix3 *= 2.0;
            lamp.face(DVec3::new(1.0, 9.0, -3.0));
            let pose = lamp.emitter.world_from_emitter.matrix3;
            assert!((pose.z_axis - DVec3::Y * 2.0).length() < 1e-12);
            Emitters::new(vec![lamp.shining()]).unwrap();
        }
    }

    #[test]
    fn colour_and_strength_multiply_what_there_is() {
        let mut panel = Made::Panel.lamp(1.0, DVec3::Y, DVec3::ZERO).shining();
        panel.pattern = Pattern::Uniform([4.0, 2.0, 1.0]);
        let mut lamp = Lamp::of(panel);
        assert_eq!((lamp.strength, lamp.colour), (4.0, [1.0, 0.5, 0.25]));
        assert_eq!(lamp.shining().pattern, Pattern::Uniform([4.0, 2.0, 1.0]));
        lamp.strength = 0.0;
        assert_eq!(lamp.shining().pattern, Pattern::Uniform([0.0; 3]));
        let mut blocks = Made::Blocks.lamp(1.0, DVec3::Y, DVec3::ZERO);
        blocks.colour = [0.5, 1.0, 0.0];
        blocks.strength = 2.0;
        let Pattern::PerFace(rows) = blocks.shining().pattern else {
            panic!("three faces");
        };
        assert_eq!(rows[0], [1.0, 0.1, 0.0]);
    }
}
