//! A camera and a way of looking, as the view pass takes them.

use glam::{DMat3, DMat4, DVec3, DVec4};
use relume::display::Camera;

use crate::GpuError;
use crate::layouts::{self, surface};

/// What a picture shows of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Width / height of the picture.
    pub aspect: f32,
    /// In stops, as in [`relume::display::ToneMap`]. Float targets get scene radiance, without exposure and tone map.
    pub exposure: f32,
    /// What surfaces show.
    pub surface: Surface,
    /// Whether edges are drawn over the surfaces.
    pub wireframe: bool,
    /// Whether the background uploaded last stands behind; otherwise there is what the pass was cleared with.
    pub background: bool,
    /// Turns the background, as the light was turned: what stood at d stands at `world_from_light · d`.
    pub world_from_light: DMat3,
}

/// What surfaces show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Surface {
    /// Albedo × transferred radiance.
    #[default]
    Shaded,
    /// Transferred radiance alone, as if albedo were 1.
    White,
    /// Transferred radiance by its sign: warm positive, cold negative. For a single coefficient of the transfer.
    Signed,
    /// Albedo alone, without light.
    Albedo,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            aspect: 16.0 / 9.0,
            exposure: 0.0,
            surface: Surface::Shaded,
            wireframe: false,
            background: true,
            world_from_light: DMat3::IDENTITY,
        }
    }
}

impl Look {
    /// The uniform of a view; `width` is that of the radiance texture, `turned` how the background was uploaded.
    pub(crate) fn uniform(
        &self,
        camera: &Camera,
        width: u32,
        turned: DMat3,
    ) -> Result<layouts::View, GpuError> {
        // The middle, the right edge and the top edge of a picture two pixels high: pixels are square.
        let aspect = f64::from(self.aspect).clamp(1e-3, 1e3);
        let frame = camera.frame()?;
        let half_height = frame.half_height;
        let half_width = half_height * aspect;
        // Depth is near / distance: reversed, and without a far plane. Nothing nearer than a ten-thousandth of the distance to the
        // target is drawn.
        let near = 1e-4 * f64::from((camera.target - camera.eye).length());
        let clip_from_view = DMat4::from_cols(
            DVec4::new(1.0 / half_width, 0.0, 0.0, 0.0),
            DVec4::new(0.0, 1.0 / half_height, 0.0, 0.0),
            DVec4::new(0.0, 0.0, 0.0, 1.0),
            DVec4::new(0.0, 0.0, near, 0.0),
        );
        let view_from_offset =
            DMat4::from_mat3(DMat3::from_cols(frame.right, frame.up, frame.forward).transpose());
        let columns = |v: DVec3| v.as_vec3().to_array();
        let background_from_world = (self.world_from_light * turned).transpose();
        let column = |v: DVec3| v.as_vec3().extend(0.0).to_array();
        Ok(layouts::View {
            clip_from_offset: (clip_from_view * view_from_offset)
                .as_mat4()
                .to_cols_array_2d(),
            eye: camera.eye.to_array(),
            scale: (0.6 * libm::exp2(f64::from(self.exposure))) as f32,
            forward: columns(frame.forward),
            surface: match self.surface {
                Surface::Shaded => surface::SHADED,
                Surface::White => surface::WHITE,
                Surface::Signed => surface::SIGNED,
                Surface::Albedo => surface::ALBEDO,
            },
            right: columns(frame.right * half_width),
            unused: 0,
            up: columns(frame.up * half_height),
            width_log2: width.ilog2(),
            background_from_world: [
                column(background_from_world.x_axis),
                column(background_from_world.y_axis),
                column(background_from_world.z_axis),
            ],
        })
    }
}
