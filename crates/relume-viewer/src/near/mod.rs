//! Lights that stand near: which, how they are sampled, and what of it is shown.

mod arrive;
#[cfg(not(target_arch = "wasm32"))]
mod bouncing;
mod glossy;
mod lamp;
mod shade;

use glam::DVec3;
use relume::light::adaptive::RefineOptions;
use relume::light::emitter::{EmitterError, Emitters, Placed};

pub use arrive::{Arriving, Domain, NearLight};
#[cfg(not(target_arch = "wasm32"))]
pub use bouncing::Bouncing;
pub use glossy::arrives;
pub use lamp::{Lamp, Made};
pub use shade::{error, shade};

/// How light of emitters is found at the vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// At every vertex, on the processor.
    #[cfg_attr(not(target_arch = "wasm32"), default)]
    Exact,
    /// At every vertex, on the graphics device, where the scene's transfer takes all light alike; else as [`Self::Exact`].
    #[cfg_attr(target_arch = "wasm32", default)]
    Device,
    /// From samples with gradients where they matter.
    FirstOrder,
    /// From samples in valid domains [sun2005].
    Domains,
}

impl Method {
    /// Every choice, with its name and what it is.
    pub const ALL: [(Self, &str, &str); 4] = [
        (
            Self::Exact,
            "exact",
            "in closed form at every vertex, on the processor",
        ),
        (
            Self::Device,
            "device",
            "in closed form at every vertex, on the graphics device, where light does not bounce on",
        ),
        (
            Self::FirstOrder,
            "gradients",
            "samples with gradients, where vertices need them",
        ),
        (
            Self::Domains,
            "domains",
            "samples in valid domains, after Sun's thesis of 2005",
        ),
    ];
}

impl Method {
    /// Whether there is nothing to differ from exact light.
    pub fn is_exact(self) -> bool {
        matches!(self, Self::Exact | Self::Device)
    }
}

/// What dragging a lamp does to it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// Moves.
    #[default]
    Move,
    /// Turns.
    Turn,
    /// Scales.
    Scale,
}

impl Tool {
    /// Every choice, with its name.
    pub const ALL: [(Self, &str); 3] = [
        (Self::Move, "move"),
        (Self::Turn, "turn"),
        (Self::Scale, "scale"),
    ];
}

/// Lamps, and what is done with them.
pub struct Near {
    lamps: Vec<Lamp>,
    /// The same, checked.
    emitters: Emitters,
    /// Where they stand now.
    placed: Placed,
    /// The one that is edited.
    pub selected: Option<usize>,
    pub tool: Tool,
    pub method: Method,
    /// For [`Method::FirstOrder`] and [`Method::Domains`]; their ε are different measures.
    pub refine: [RefineOptions; 2],
    /// Whether the lamps themselves are seen.
    pub shows_lamps: bool,
    /// Whether places of samples are shown.
    pub shows_samples: bool,
    /// Whether they are shown with how far they are valid.
    pub shows_domains: bool,
    /// The difference to [`Method::Exact`] in the place of the picture, so many times.
    pub error: Option<f32>,
    /// Interreflections, where the scene says how light bounces on.
    pub bounces: u32,
}

impl Default for Near {
    fn default() -> Self {
        let (first_order, domains) = (
            RefineOptions {
                epsilon: 1e-3,
                budget: 256,
            },
            RefineOptions {
                epsilon: 0.5,
                budget: 1024,
            },
        );
        Self {
            lamps: Vec::new(),
            emitters: none(),
            placed: none().placed(),
            selected: None,
            tool: Tool::default(),
            method: Method::default(),
            refine: [first_order, domains],
            shows_lamps: true,
            shows_samples: false,
            shows_domains: false,
            error: None,
            bounces: 0,
        }
    }
}

/// No emitters.
fn none() -> Emitters {
    Emitters::new(Vec::new()).expect("there is nothing to refuse")
}

impl Near {
    /// All lamps.
    pub fn lamps(&self) -> &[Lamp] {
        &self.lamps
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.lamps.is_empty()
    }

    /// As an emitters.json.
    ///
    /// # Errors
    /// A texture, in words.
    pub fn to_json(&self) -> Result<String, String> {
        relume::light::emitter::to_json(&self.emitters).map_err(|error| error.to_string())
    }

    /// Where they stand.
    pub fn placed(&self) -> &Placed {
        &self.placed
    }

    /// Balls that hold all of them together: middles and radii.
    pub fn balls(&self) -> impl Iterator<Item = (DVec3, f64)> + '_ {
        let faces = self.placed.polygons().iter().map(|p| (p.centre, p.radius));
        faces.chain(self.placed.spheres().iter().map(|s| (s.centre, s.radius)))
    }

    /// One more, which is selected.
    pub fn add(&mut self, lamp: Lamp) {
        let mut lamps = self.lamps.clone();
        lamps.push(lamp);
        if self.take(lamps).is_ok() {
            self.selected = Some(self.lamps.len() - 1);
        }
    }

    /// Those of a file, in the place of all others.
    pub fn replace(&mut self, emitters: &Emitters) {
        let lamps = emitters.emitters().iter().cloned().map(Lamp::of);
        self.selected = None;
        // They were checked when they were read.
        let _ = self.take(lamps.collect());
    }

    /// Takes the selected one away.
    pub fn remove(&mut self) {
        if let Some(i) = self.selected.take() {
            let mut lamps = self.lamps.clone();
            lamps.remove(i);
            let _ = self.take(lamps);
        }
    }

    /// Changes one; a change that makes no emitter of it is not made.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn edit(&mut self, index: usize, lamp: Lamp) -> Result<(), EmitterError> {
        let pose = lamp.emitter.world_from_emitter;
        let moved_alone = self.lamps.get(index).is_some_and(|last| {
            (&last.emitter.pattern, last.colour, last.strength)
                == (&lamp.emitter.pattern, lamp.colour, lamp.strength)
                && (last.emitter.two_sided, last.emitter.exponent)
                    == (lamp.emitter.two_sided, lamp.emitter.exponent)
        });
        if moved_alone {
            self.emitters.set_pose(index, pose)?;
            self.placed = self.emitters.placed();
            self.lamps[index] = lamp;
            return Ok(());
        }
        let mut lamps = self.lamps.clone();
        if let Some(place) = lamps.get_mut(index) {
            *place = lamp;
        }
        self.take(lamps)
    }

    fn take(&mut self, lamps: Vec<Lamp>) -> Result<(), EmitterError> {
        self.emitters = Emitters::new(lamps.iter().map(Lamp::shining).collect())?;
        self.placed = self.emitters.placed();
        self.lamps = lamps;
        Ok(())
    }

    /// The nearest lamp on a ray.
    pub fn at(&self, origin: DVec3, direction: DVec3) -> Option<usize> {
        let distance = |lamp: &Lamp| {
            let alone = Emitters::new(vec![lamp.emitter.clone()]).ok()?.placed();
            alone.first_hit(origin, direction).map(|hit| hit.distance)
        };
        let hits = self.lamps.iter().enumerate();
        let hits = hits.filter_map(|(i, lamp)| Some((i, distance(lamp)?)));
        hits.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DAffine3;

    #[test]
    fn lamps_are_added_moved_picked_and_taken_away() {
        let mut near = Near::default();
        let from = DVec3::new(0.0, 0.0, 2.0);
        near.add(Made::Panel.lamp(0.5, from, DVec3::ZERO));
        near.add(Made::Ball.lamp(0.5, from + DVec3::X, DVec3::ZERO));
        assert_eq!((near.lamps().len(), near.selected), (2, Some(1)));
        let balls: Vec<_> = near.balls().collect();
        assert_eq!(balls.len(), 2);
        assert!((balls[0].0 - from).length() < 1e-9 && balls[1].1 > 0.1);
        assert_eq!(near.at(DVec3::ZERO, DVec3::Z), Some(0));
        assert_eq!(near.at(DVec3::X, DVec3::Z), Some(1));
        assert_eq!(near.at(DVec3::ZERO, -DVec3::Z), None);
        let mut moved = near.lamps()[0].clone();
        moved.emitter.world_from_emitter.translation = DVec3::new(0.0, 0.0, -2.0);
        near.edit(0, moved.clone()).unwrap();
        assert_eq!(near.at(DVec3::ZERO, -DVec3::Z), Some(0));
        assert_eq!(near.placed().polygons()[0].centre.z, -2.0);
        moved.emitter.world_from_emitter = DAffine3::from_scale(DVec3::new(1.0, 2.0, 1.0));
        assert!(near.edit(0, moved.clone()).is_err());
        assert_eq!(near.placed().polygons()[0].centre.z, -2.0);
        moved = near.lamps()[0].clone();
        moved.strength = f32::NAN;
        assert!(near.edit(0, moved).is_err());
        near.remove();
        assert_eq!((near.lamps().len(), near.selected), (1, None));
        near.remove();
        assert_eq!(near.lamps().len(), 1);
    }
}
