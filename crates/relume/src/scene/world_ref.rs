//! A world by reference, whoever keeps it.

use std::ops::Deref;
use std::sync::Arc;

use super::World;

/// A world that is borrowed, or shared with its owner: what is made for one may then be kept beside it.
#[derive(Clone, Debug)]
pub enum WorldRef<'w> {
    /// For as long as it is borrowed.
    Borrowed(&'w World),
    /// For as long as it is wanted.
    Shared(Arc<World>),
}

impl Deref for WorldRef<'_> {
    type Target = World;

    fn deref(&self) -> &World {
        match self {
            Self::Borrowed(world) => world,
            Self::Shared(world) => world,
        }
    }
}

impl<'w> From<&'w World> for WorldRef<'w> {
    fn from(world: &'w World) -> Self {
        Self::Borrowed(world)
    }
}

impl From<Arc<World>> for WorldRef<'_> {
    fn from(world: Arc<World>) -> Self {
        Self::Shared(world)
    }
}
