//! What shines on an asset: distant light, light by vertex, and emitters.

use std::path::{Path, PathBuf};

use relume::asset::{self, Asset};
use relume::basis::Order;
use relume::light::emitter::{self, Placed};
use relume::light::{EnvSpec, Environment, IncidentLight, ShLight, VertexLight};
use relume::scene::World;
use relume::shade::{self, SideRadiance};

use crate::args::{LightArgs, LightChange};
use crate::failure::Failure;
use crate::inputs::{self, shown, warn};
use crate::progress;

/// All light of a picture.
pub struct Lights {
    /// Distant light as it came, for looking at; black without.
    pub environment: Environment,
    /// Distant light as the asset gets it.
    pub distant: ShLight,
    /// Light that varies over the vertices.
    pub near: Option<VertexLight>,
    /// The emitters that near light comes from.
    pub placed: Option<Placed>,
    /// Interreflections that are added when it is shaded.
    pub bounces: u32,
}

/// The files that lights are read from.
pub fn paths(args: &LightArgs) -> Vec<PathBuf> {
    let env = args.env.iter().flat_map(EnvSpec::paths);
    env.chain(args.emitters.clone()).collect()
}

impl Lights {
    /// What the arguments name, for an asset.
    pub fn open(args: &LightArgs, asset: &Asset, world: &World) -> Result<Self, Failure> {
        let order = asset.transfer.order;
        let mut lights = Self {
            environment: Environment::Constant([0.0; 3]),
            distant: ShLight::new(order, vec![[0.0; 3]; order.count()]),
            near: None,
            placed: None,
            bounces: args.bounces,
        };
        if let Some(path) = args.env.as_ref().and_then(by_vertex) {
            lights.near = Some(asset::import_light(world, path)?);
        } else if let Some(env) = &args.env {
            lights.open_distant(env, &args.change, order)?;
        }
        if let Some(path) = &args.emitters {
            let placed = open_emitters(path)?;
            let exact = at_vertices(world, &placed, order);
            lights.near = Some(match lights.near {
                Some(near) => near.plus_vertices(&exact),
                None => exact,
            });
            lights.placed = Some(placed);
        }
        Ok(lights)
    }

    fn open_distant(
        &mut self,
        env: &EnvSpec,
        change: &LightChange,
        order: Order,
    ) -> Result<(), Failure> {
        self.environment = inputs::open_environment(env, change)?;
        self.distant = inputs::project(&self.environment, order, change)?.light;
        Ok(())
    }

    /// All of it, with `distant` for distant light.
    pub fn with(&self, distant: &ShLight) -> IncidentLight {
        match &self.near {
            Some(near) => IncidentLight::PerVertex(near.plus(distant)),
            None => IncidentLight::Distant(distant.clone()),
        }
    }

    /// All of it.
    pub fn incident(&self) -> IncidentLight {
        self.with(&self.distant)
    }

    /// What the asset makes of `light`, bounces and all.
    pub fn bounced(
        &self,
        path: &Path,
        asset: &Asset,
        light: &IncidentLight,
    ) -> Result<SideRadiance, Failure> {
        shade::bounced(&asset.transfer, light, self.bounces)
            .map_err(|error| Failure::new(format!("{}: {error}", shown(path))))
    }
}

/// A light.npz.
pub fn by_vertex(env: &EnvSpec) -> Option<&Path> {
    match env {
        EnvSpec::File(path) => path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("npz"))
            .then_some(path),
        _ => None,
    }
}

/// Emitters from a file, where they stand.
pub fn open_emitters(path: &Path) -> Result<Placed, Failure> {
    let (emitters, warnings) = emitter::load(path)?;
    warnings.iter().for_each(|warning| warn(warning));
    Ok(emitters.placed())
}

/// Near light at every vertex.
pub fn at_vertices(world: &World, placed: &Placed, order: Order) -> VertexLight {
    let spinner = progress::spinner("near light");
    let light = emitter::light_at_vertices(&world.positions, placed, order);
    spinner.finish_and_clear();
    light
}
