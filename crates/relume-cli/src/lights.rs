//! What shines on an asset: distant light, light by vertex, and emitters.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use relume::asset::{self, Asset, Transfer, TransferKind};
use relume::bake::Monitor;
use relume::basis::Order;
use relume::files::printable;
use relume::light::emitter::{self, Placed};
use relume::light::{EnvSpec, Environment, IncidentLight, ShLight, VertexLight};
use relume::scene::World;
use relume::shade::{
    self, BounceError, EnclosedLight, Enclosure, GlossyBounces, SideRadiance, Split,
    TransferredRadiance,
};

use crate::args::{LightArgs, LightChange};
use crate::failure::Failure;
use crate::inputs::{self, shown, warn};
use crate::progress;

/// All light of a picture.
pub struct Lights<'w> {
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
    /// How a glossy asset makes them, where some are wanted.
    glossy: Option<GlossyBounces<'w>>,
}

/// The files that lights are read from.
pub fn paths(args: &LightArgs) -> Vec<PathBuf> {
    let env = args.env.iter().flat_map(EnvSpec::paths);
    env.chain(args.emitters.clone()).collect()
}

impl<'w> Lights<'w> {
    /// What the arguments name, for the asset of the file `path`.
    pub fn open(
        args: &LightArgs,
        path: &Path,
        asset: &Asset,
        world: &'w World,
    ) -> Result<Self, Failure> {
        let order = asset.transfer.order;
        let mut lights = Self {
            environment: Environment::Constant([0.0; 3]),
            distant: ShLight::new(order, vec![[0.0; 3]; order.count()]),
            near: None,
            placed: None,
            enclosed: None,
            bounces: args.bounces,
            glossy: None,
        };
        if let Some(path) = args.env.as_ref().and_then(by_vertex) {
            lights.near = Some(asset::import_light(world, path)?);
        } else if let Some(env) = &args.env {
            lights.open_distant(env, &args.change, order)?;
        }
        if let Some(emitters) = &args.emitters {
            lights.open_emitters(emitters, asset, world)?;
        }
        if args.bounces > 0 && asset.transfer.matrices.is_some() {
            let bounces = GlossyBounces::new(world, &asset.transfer);
            let named = |error| Failure::new(format!("{}: {error}", shown(path)));
            lights.glossy = Some(bounces.map_err(named)?);
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
    pub fn with(&self, distant: &ShLight) -> Lit<'_> {
        let light = match &self.near {
            Some(near) => IncidentLight::PerVertex(near.plus(distant)),
            None => IncidentLight::Distant(distant.clone()),
        };
        Lit {
            light,
            enclosed: self.enclosed.as_ref(),
            bounces: self.bounces,
            glossy: self.glossy.as_ref(),
        }
    }

    /// All of it.
    pub fn lit(&self) -> Lit<'_> {
        self.with(&self.distant)
    }
}

/// Light on an asset, and how often it bounces when it is shaded.
pub struct Lit<'a> {
    light: IncidentLight,
    enclosed: Option<&'a EnclosedLight>,
    bounces: u32,
    glossy: Option<&'a GlossyBounces<'a>>,
}

/// What a transfer makes of light.
pub enum Shaded {
    Diffuse(SideRadiance),
    /// What arrives, for an eye to see by the BRDFs.
    Glossy(TransferredRadiance),
}

impl Lit<'_> {
    /// Distant light, as the asset was baked for it.
    pub fn distant(light: &ShLight) -> Self {
        Self {
            light: IncidentLight::Distant(light.clone()),
            enclosed: None,
            bounces: 0,
            glossy: None,
        }
    }

    /// What `transfer` makes of it, bounces and all.
    pub fn shaded(&self, transfer: &Transfer) -> Result<Shaded, BounceError> {
        let enclosed = self.enclosed.and_then(|light| light.transferred.as_ref());
        let arriving = shade::transferred_with(transfer, &self.light, enclosed)?;
        Ok(match (arriving, self.glossy) {
            (Some(direct), Some(glossy)) => Shaded::Glossy(self.bounced(&direct, glossy)?),
            (Some(direct), None) => Shaded::Glossy(direct),
            (None, _) => {
                let enclosed = self.enclosed.map(|light| &light.direct);
                let (light, bounces) = (&self.light, self.bounces);
                Shaded::Diffuse(shade::bounced_with(transfer, light, enclosed, bounces)?)
            }
        })
    }

    fn bounced(
        &self,
        direct: &TransferredRadiance,
        glossy: &GlossyBounces,
    ) -> Result<TransferredRadiance, BounceError> {
        let bar = progress::bake_bar();
        let monitor = Monitor {
            progress: &|progress| progress::show(&bar, progress),
            cancelled: &AtomicBool::new(false),
        };
        let bounced = glossy.bounced(direct, self.bounces, glossy.usual_samples(), &monitor);
        bar.finish_and_clear();
        bounced
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
