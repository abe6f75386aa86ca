//! How surfaces reflect: bidirectional reflectance distribution functions (BRDFs), their sampling and their albedo.
//!
//! All directions are in the tangent frame: z is the shading normal, x the tangent; unit length, pointing away from the surface.
//! Values are in 1/sr and linear Rec. 709; no cosine is folded in. Radiance toward `o` is `∫ f(i, o) L(i) cosθ_i di`.
//!
//! | model | reciprocal | directional albedo of the white one, at most |
//! |---|---|---|
//! | [`Lambert`] | yes | 1 |
//! | [`Phong`], [`BlinnPhong`], [`Ward`] | yes | diffuse + specular |
//! | [`Ggx`] | yes | 1 for a metal; a white dielectric gains light at grazing angles, see there |
//! | [`Merl`] | as measured: the half-angle form makes it so | as measured |
//! | [`Table`] | as what it was made of, if that is isotropic | to the resolution of the grid |
//!
//! ```
//! use glam::DVec3;
//! use relume::brdf::{Brdf, Phong};
//!
//! let plastic = Brdf::from(Phong { diffuse: DVec3::splat(0.5), specular: DVec3::splat(0.3), exponent: 40.0 });
//! // Seen from straight above, all of the lobe is over the horizon.
//! assert!((plastic.albedo(DVec3::Z) - DVec3::splat(0.8)).length() < 1e-9);
//! ```

mod blinn_phong;
mod directional;
mod fitted;
mod ggx;
mod hemisphere;
mod integrate;
mod lambert;
mod lobe;
mod merl;
mod phong;
mod plane;
mod radiance;
mod reflection;
mod reflector;
mod table;
#[cfg(test)]
mod tests;
pub mod tile;
mod ward;

use std::sync::Arc;

use glam::DVec3;

pub use blinn_phong::BlinnPhong;
pub use directional::{Anisotropic, DirectionalTable};
pub use ggx::Ggx;
#[cfg(feature = "bake")]
pub(crate) use hemisphere::cosine_sample;
pub use integrate::HemisphereRule;
pub use lambert::Lambert;
pub(crate) use merl::ENTRIES as MERL_ENTRIES;
#[cfg(all(test, feature = "images", feature = "bake"))]
pub(crate) use merl::tests::measured;
pub use merl::{Merl, MerlError};
pub use phong::Phong;
pub use plane::LobePlane;
pub use radiance::Workspace;
pub use reflection::Reflection;
#[cfg(feature = "bake")]
pub(crate) use reflector::seen_from_above;
pub use reflector::{Finish, Reflector, Scratch};
pub use table::{MAX_RESOLUTION, Table};
pub use tile::{Tile, TileShape};
pub use ward::Ward;

/// A BRDF in its tangent frame.
///
/// Parameters are not checked: colours are meant to lie in 0…1 and widths to be positive.
#[derive(Clone, Debug)]
pub enum Brdf {
    /// Diffuse.
    Lambert(Lambert),
    /// Diffuse and a cosine power about the mirror direction.
    Phong(Phong),
    /// Diffuse and a cosine power of the half vector.
    BlinnPhong(BlinnPhong),
    /// The metallic-roughness material of glTF.
    Ggx(Ggx),
    /// Diffuse and an anisotropic Gaussian of slopes.
    Ward(Ward),
    /// Measured, isotropic.
    Measured(Arc<Merl>),
    /// Tabulated from another.
    Tabulated(Arc<Table>),
}

/// The model inside, whichever it is.
macro_rules! each {
    ($brdf:expr, $model:ident => $result:expr) => {
        match $brdf {
            Brdf::Lambert($model) => $result,
            Brdf::Phong($model) => $result,
            Brdf::BlinnPhong($model) => $result,
            Brdf::Ggx($model) => $result,
            Brdf::Ward($model) => $result,
            Brdf::Measured($model) => $result,
            Brdf::Tabulated($model) => $result,
        }
    };
}

impl Brdf {
    /// The value, 1/sr; zero where either direction is at or below the horizon.
    pub fn eval(&self, incident: DVec3, outgoing: DVec3) -> DVec3 {
        if incident.z > 0.0 && outgoing.z > 0.0 {
            each!(self, model => model.eval(incident, outgoing))
        } else {
            DVec3::ZERO
        }
    }

    /// An incident direction for a point of the unit cube, its density about proportional to value × cosine.
    ///
    /// `None` where the lobe dips below the horizon (such a sample counts as black), or where `outgoing` is not above it. `u[0]` chooses
    /// between lobes, the other two the direction in it.
    pub fn sample(&self, outgoing: DVec3, u: [f64; 3]) -> Option<DVec3> {
        if outgoing.z > 0.0 {
            each!(self, model => model.sample(outgoing, u)).filter(|incident| incident.z > 0.0)
        } else {
            None
        }
    }

    /// The density of [`Brdf::sample`] with respect to solid angle; it integrates to 1 less the share of samples that are `None`.
    pub fn pdf(&self, incident: DVec3, outgoing: DVec3) -> f64 {
        if incident.z > 0.0 && outgoing.z > 0.0 {
            each!(self, model => model.pdf(incident, outgoing))
        } else {
            0.0
        }
    }

    /// Directional-hemispherical reflectance, `∫ f(i, o) cosθ_i di`: radiance toward `outgoing` under constant light of radiance 1.
    ///
    /// By the quadrature of [`HemisphereRule`], which shares nothing with [`Brdf::sample`]; some 60 000 evaluations.
    pub fn albedo(&self, outgoing: DVec3) -> DVec3 {
        if outgoing.z <= 0.0 {
            return DVec3::ZERO;
        }
        HemisphereRule::about_mirror(outgoing)
            .integrate(|incident| self.eval(incident, outgoing) * incident.z)
    }

    /// Whether turning both directions about the normal changes nothing, whatever the parameters' values.
    pub fn is_isotropic(&self) -> bool {
        match self {
            Self::Ward(ward) => ward.alpha_x == ward.alpha_y,
            Self::Tabulated(table) => table.is_isotropic(),
            _ => true,
        }
    }
}

impl From<Lambert> for Brdf {
    fn from(model: Lambert) -> Self {
        Self::Lambert(model)
    }
}

impl From<Phong> for Brdf {
    fn from(model: Phong) -> Self {
        Self::Phong(model)
    }
}

impl From<BlinnPhong> for Brdf {
    fn from(model: BlinnPhong) -> Self {
        Self::BlinnPhong(model)
    }
}

impl From<Ggx> for Brdf {
    fn from(model: Ggx) -> Self {
        Self::Ggx(model)
    }
}

impl From<Ward> for Brdf {
    fn from(model: Ward) -> Self {
        Self::Ward(model)
    }
}

impl From<Merl> for Brdf {
    fn from(model: Merl) -> Self {
        Self::Measured(Arc::new(model))
    }
}

impl From<Table> for Brdf {
    fn from(model: Table) -> Self {
        Self::Tabulated(Arc::new(model))
    }
}
