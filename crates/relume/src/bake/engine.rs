//! What casts the rays of a bake.

use std::fmt::{self, Display, Formatter};
#[cfg(all(feature = "embree", any(unix, windows)))]
use std::path::PathBuf;
use std::str::FromStr;

use super::BakeError;
use super::trace::Tracer;
use crate::scene::World;
use crate::simd::Level;

/// What casts the rays.
#[derive(Clone, Debug, PartialEq)]
pub enum Engine {
    /// Ours, for an instruction set: the same bytes whichever.
    Packets(Level),
    /// Embree 4 from this file, or the system's own: not promised to be the same bytes anywhere.
    #[cfg(all(feature = "embree", any(unix, windows)))]
    Embree(Option<PathBuf>),
}

impl Default for Engine {
    fn default() -> Self {
        Self::Packets(Level::best())
    }
}

impl Engine {
    /// The instruction set for everything that is ours.
    pub fn level(&self) -> Level {
        match self {
            Self::Packets(level) => *level,
            #[cfg(all(feature = "embree", any(unix, windows)))]
            Self::Embree(_) => Level::best(),
        }
    }

    /// Whether what it finds is the same on every machine.
    pub fn is_reproducible(&self) -> bool {
        matches!(self, Self::Packets(_))
    }
}

impl<'w> Tracer<'w> {
    /// The tracer that `engine` names, over all triangles of `world`.
    pub fn with_engine(world: &'w World, engine: &Engine) -> Result<Self, BakeError> {
        match engine {
            Engine::Packets(level) => Ok(Self::with_level(world, *level)),
            #[cfg(all(feature = "embree", any(unix, windows)))]
            Engine::Embree(path) => Ok(Self::with_embree(world, path.as_deref())?),
        }
    }
}

/// `auto`, an instruction set, `embree` or `embree:/absolute/path`.
impl FromStr for Engine {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        #[cfg(all(feature = "embree", any(unix, windows)))]
        if let Some(path) = text.strip_prefix("embree") {
            return match path.strip_prefix(':') {
                None if path.is_empty() => Ok(Self::Embree(None)),
                Some(path) if std::path::Path::new(path).is_absolute() => {
                    Ok(Self::Embree(Some(path.into())))
                }
                _ => {
                    Err("write embree, or embree: and the absolute path of its library".to_owned())
                }
            };
        }
        match text {
            "auto" => Ok(Self::default()),
            level => level
                .parse()
                .map(Self::Packets)
                .map_err(|here| format!("write auto or embree; of ours, {here}")),
        }
    }
}

impl Display for Engine {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        match self {
            Self::Packets(level) => write!(f, "{level}"),
            #[cfg(all(feature = "embree", any(unix, windows)))]
            Self::Embree(_) => f.write_str("embree"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn engines_are_named_and_nothing_is_loaded_from_where_the_program_runs() {
        assert_eq!("auto".parse(), Ok(Engine::default()));
        assert_eq!("portable".parse(), Ok(Engine::Packets(Level::PORTABLE)));
        assert!("fast".parse::<Engine>().is_err());
        #[cfg(all(feature = "embree", any(unix, windows)))]
        {
            assert_eq!("embree".parse(), Ok(Engine::Embree(None)));
            for wrong in [
                "embree4",
                "embree:",
                "embree:libembree4.so",
                "embree:./libembree4.so",
            ] {
                assert!(wrong.parse::<Engine>().is_err(), "{wrong}");
            }
        }
    }
}
