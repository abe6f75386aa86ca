//! What shines on a world.

use glam::DVec3;

use crate::light::emitter::Placed;

/// Distant radiance (linear Rec. 709) by unit direction, pointing away from the scene. May be negative where it is band-limited.
pub type Light<'a> = dyn Fn(DVec3) -> [f64; 3] + Sync + 'a;

/// All light that paths find.
#[derive(Clone, Copy)]
pub struct Sources<'a> {
    /// Arrives where neither a surface nor an emitter is in the way.
    pub distant: &'a Light<'a>,
    /// Emitters that stand in the world. They are black bodies: they hide what is behind them, surfaces, distant light and one another, and
    /// reflect nothing.
    pub emitters: Option<&'a Placed>,
}

impl<'a> Sources<'a> {
    /// Distant light and nothing else.
    pub fn distant(light: &'a Light<'a>) -> Self {
        Self {
            distant: light,
            emitters: None,
        }
    }
}
