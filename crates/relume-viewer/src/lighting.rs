//! The light that shines now: an environment, turned, cut and windowed.

use glam::{DMat3, DVec3};
use relume::basis::{Order, Window};
use relume::light::{Environment, LightFile, ShLight, WindowChoice};

/// An environment and what is done to it.
pub struct Lighting {
    /// What people call it.
    pub name: String,
    /// As it was loaded.
    pub environment: Environment,
    /// Its coefficients, of the order of the scene.
    coefficients: ShLight,
    /// How it is turned: what shone from d shines from `turn · d`.
    turn: DMat3,
    /// The bands that are shown: degrees below this.
    pub order: usize,
    /// What is done against ringing.
    pub window: Against,
    /// A single coefficient of the transfer instead of the light: its index.
    pub coefficient: Option<usize>,
}

/// What is done against ringing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Against {
    /// Nothing.
    #[default]
    Nothing,
    /// A Hann window.
    Hann,
    /// The least blur that leaves nothing negative.
    Auto,
}

impl Against {
    /// Every choice, with its name.
    pub const ALL: [(Self, &str); 3] = [
        (Self::Nothing, "none"),
        (Self::Hann, "Hann"),
        (Self::Auto, "auto"),
    ];

    fn choice(self) -> WindowChoice {
        match self {
            Self::Nothing => WindowChoice::Window(Window::None),
            Self::Hann => WindowChoice::Hann,
            Self::Auto => WindowChoice::Window(Window::Auto),
        }
    }
}

impl Lighting {
    /// All bands of an environment, for a scene of `order`.
    pub fn new(name: String, environment: Environment, order: Order) -> Self {
        Self {
            name,
            coefficients: environment.project(order),
            environment,
            turn: DMat3::IDENTITY,
            order: order.get(),
            window: Against::default(),
            coefficient: None,
        }
    }

    /// Takes another environment's place, keeping how things are turned and cut.
    pub fn replace(&mut self, name: String, environment: Environment) {
        self.coefficients = environment.project(self.coefficients.order());
        (self.name, self.environment) = (name, environment);
        self.coefficient = None;
    }

    /// Fits a scene of another order, showing all bands.
    pub fn fit(&mut self, order: Order) {
        self.coefficients = self.environment.project(order);
        self.order = order.get();
        self.coefficient = None;
    }

    /// How it is turned.
    pub fn turn(&self) -> DMat3 {
        self.turn
    }

    /// Turns it further: right-handed, about a world axis.
    pub fn rotate(&mut self, axis: DVec3, radians: f64) {
        let turned = DMat3::from_axis_angle(axis.normalize(), radians) * self.turn;
        // Products of many turns drift from being one.
        let x = turned.x_axis.normalize();
        let y = (turned.y_axis - x * x.dot(turned.y_axis)).normalize();
        self.turn = DMat3::from_cols(x, y, x.cross(y));
    }

    /// As it was loaded.
    pub fn unturn(&mut self) {
        self.turn = DMat3::IDENTITY;
    }

    /// The coefficients that shine now.
    ///
    /// # Errors
    /// A window that does not fit the light, in words; the light without it shines on.
    pub fn incident(&self) -> (ShLight, Option<String>) {
        let whole = self.coefficients.order();
        if let Some(shown) = self.coefficient {
            let one = |i: usize| if i == shown { [1.0; 3] } else { [0.0; 3] };
            return (
                ShLight::new(whole, (0..whole.count()).map(one).collect()),
                None,
            );
        }
        let order = Order::new(self.order.clamp(1, whole.get())).unwrap_or(whole);
        let cut = self.coefficients.resized(order);
        let (windowed, problem) = match LightFile::windowed(&cut, self.window.choice()) {
            Ok(file) => (file.light, None),
            Err(error) => (cut, Some(error.to_string())),
        };
        // `turn` is a rotation, so this cannot fail.
        let turned = windowed.rotated(self.turn).unwrap_or(windowed);
        (turned, problem)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn sun() -> Lighting {
        let spec = "sun:1,0,0,20,9,8,7".parse().unwrap();
        let environment = relume::light::load(&spec, &Default::default()).unwrap().0;
        Lighting::new("sun".to_owned(), environment, Order::new(6).unwrap())
    }

    #[test]
    fn a_turned_light_shines_from_where_it_was_turned_to() {
        let mut light = sun();
        light.rotate(DVec3::Y, FRAC_PI_2);
        let (incident, problem) = light.incident();
        assert_eq!(problem, None);
        // Right-handed about y: +x goes to −z.
        let brightness = |d: DVec3| incident.radiance(d)[0];
        assert!(brightness(DVec3::NEG_Z) > 2.0 * brightness(DVec3::X).abs());
        for _ in 0..2000 {
            light.rotate(DVec3::new(1.0, 2.0, 3.0), 0.7);
        }
        assert!((light.turn().determinant() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn bands_and_single_coefficients_are_cut_out() {
        let mut light = sun();
        let whole = light.incident().0;
        light.order = 2;
        assert_eq!(
            light.incident().0.coefficients(),
            &whole.coefficients()[..4]
        );
        light.coefficient = Some(7);
        let one = light.incident().0;
        assert_eq!(one.coefficients()[7], [1.0; 3]);
        assert_eq!(one.coefficients().iter().filter(|c| c[0] != 0.0).count(), 1);
        light.window = Against::Auto;
        light.coefficient = None;
        light.order = 6;
        let deringed = light.incident().0;
        assert!(deringed.radiance(DVec3::NEG_X)[0] > -1e-3);
        assert!(whole.radiance(DVec3::NEG_X)[0].abs() > 0.0);
    }
}
