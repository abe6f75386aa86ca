//! What shines on an asset: distant light, light by vertex, and emitters.

use std::path::{Path, PathBuf};

use relume::asset::{self, Asset, Transfer, TransferKind};
use relume::basis::Order;
use relume::files::printable;
use relume::light::emitter::{self, Placed};
use relume::light::{EnvSpec, Environment, IncidentLight, ShLight, VertexLight};
use relume::scene::World;
use relume::shade::{
    self, BounceError, EnclosedLight, Enclosure, SideRadiance, Split, TransferredRadiance,
};

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
    /// Direct light of those that reach into the object's hull.
    pub enclosed: Option<EnclosedLight>,
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
            enclosed: None,
            bounces: args.bounces,
        };
        if let Some(path) = args.env.as_ref().and_then(by_vertex) {
            lights.near = Some(asset::import_light(world, path)?);
        } else if let Some(env) = &args.env {
            lights.open_distant(env, &args.change, order)?;
        }
        if let Some(path) = &args.emitters {
            lights.open_emitters(path, asset, world)?;
        }
        Ok(lights)
    }

    fn open_emitters(&mut self, path: &Path, asset: &Asset, world: &World) -> Result<(), Failure> {
        let placed = open_emitters(path)?;
        let split = enclosed(world, &placed, asset);
        let outside = split.as_ref().map_or(&placed, |split| &split.outside);
        let exact = at_vertices(world, outside, asset.transfer.order);
        self.near = Some(match self.near.take() {
            Some(near) => near.plus_vertices(&exact),
            None => exact,
        });
        if let Some(split) = split {
            let spinner = progress::spinner("light of enclosed lamps");
            let light = Enclosure::new(world).light(&split.inside, &asset.transfer);
            spinner.finish_and_clear();
            self.enclosed = Some(light);
        }
        self.placed = Some(placed);
        Ok(())
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
    pub fn with(&self, distant: &ShLight) -> Lit {
        let light = match &self.near {
            Some(near) => IncidentLight::PerVertex(near.plus(distant)),
            None => IncidentLight::Distant(distant.clone()),
        };
        Lit {
            light,
            enclosed: self.enclosed.clone(),
            bounces: self.bounces,
        }
    }

    /// All of it.
    pub fn lit(&self) -> Lit {
        self.with(&self.distant)
    }
}

/// Light on an asset, and how often it bounces when it is shaded.
pub struct Lit {
    pub light: IncidentLight,
    pub enclosed: Option<EnclosedLight>,
    pub bounces: u32,
}

impl Lit {
    /// Distant light, as the asset was baked for it.
    pub fn distant(light: &ShLight) -> Self {
        Self {
            light: IncidentLight::Distant(light.clone()),
            enclosed: None,
            bounces: 0,
        }
    }

    /// What `transfer` makes of it, bounces and all.
    pub fn shaded(&self, transfer: &Transfer) -> Result<SideRadiance, BounceError> {
        let enclosed = self.enclosed.as_ref().map(|light| &light.direct);
        shade::bounced_with(transfer, &self.light, enclosed, self.bounces)
    }

    /// What arrives at glossy surfaces; `None` of a diffuse asset.
    pub fn transferred(&self, transfer: &Transfer) -> Option<TransferredRadiance> {
        let mut transferred = TransferredRadiance::new(transfer, &self.light)?;
        let enclosed = self.enclosed.as_ref();
        if let Some(enclosed) = enclosed.and_then(|light| light.transferred.as_ref()) {
            transferred.add(enclosed);
        }
        Some(transferred)
    }
}

/// The emitters by where they stand, if some reach into the hull of an asset that casts shadows.
pub fn enclosed(world: &World, placed: &Placed, asset: &Asset) -> Option<Split> {
    let shadows = asset.transfer.kind != TransferKind::Unshadowed;
    shadows.then(|| Split::new(world, placed)).flatten()
}

/// That an emitter stands where it may not: within the hull of an object `what` it is.
pub fn within(path: &Path, split: &Split, what: &str) -> Failure {
    let emitter = &split.inside.emitters()[split.enclosed[0]];
    let name = printable(&emitter.name);
    Failure::new(format!(
        "{}: emitter {name:?} reaches into the convex hull of an object {what}",
        shown(path)
    ))
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
