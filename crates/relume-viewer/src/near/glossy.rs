//! What arrives at the glossy surfaces of a scene.

use relume::light::{IncidentLight, ShLight};
use relume::shade::{BounceError, TransferredRadiance, transferred_with};

use super::NearLight;
use crate::content::{Content, Paths};

/// Transferred radiance of every side.
#[derive(Clone)]
pub struct Arrives {
    /// Of distant light, with the bounces that were folded in.
    pub folded: Option<TransferredRadiance>,
    /// Without any bounces yet.
    pub direct: Option<TransferredRadiance>,
}

impl Arrives {
    /// All of it, with something else in the place of what has not bounced yet; `None` where there is nothing.
    pub fn with(&self, direct: Option<&TransferredRadiance>) -> Option<TransferredRadiance> {
        match (self.folded.clone(), direct) {
            (Some(mut sum), Some(direct)) => {
                sum.add(direct);
                Some(sum)
            }
            (folded, direct) => folded.or(direct.cloned()),
        }
    }

    /// All of it.
    pub fn all(&self) -> Option<TransferredRadiance> {
        self.with(self.direct.as_ref())
    }
}

/// By what is shown, and near light by a transfer of direct light where bounces were folded in.
///
/// # Errors
/// Light that the transfer does not hold for; it is never asked for such.
pub fn arrives(
    content: &mut Content,
    paths: Paths,
    distant: &ShLight,
    near: Option<&NearLight>,
) -> Result<Arrives, BounceError> {
    let far = || IncidentLight::Distant(distant.clone());
    let enclosed = near.and_then(NearLight::enclosed_transferred);
    let mut found = Arrives {
        folded: None,
        direct: None,
    };
    let is_folded = paths == Paths::Baked && content.has_folded_bounces();
    let Some(shown) = content.transfer(paths) else {
        return Ok(found);
    };
    if !is_folded {
        let light = match near {
            Some(near) => IncidentLight::PerVertex(near.light.plus(distant)),
            None => far(),
        };
        found.direct = transferred_with(shown, &light, enclosed)?;
        return Ok(found);
    }
    found.folded = transferred_with(shown, &far(), None)?;
    if let Some((near, direct)) = near.zip(content.direct()) {
        let light = IncidentLight::PerVertex(near.light.clone());
        found.direct = transferred_with(direct, &light, enclosed)?;
    }
    Ok(found)
}
