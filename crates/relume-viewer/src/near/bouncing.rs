//! Bounces of light on glossy surfaces, found beside the drawing: their rays take longer than a frame.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use relume::asset::Transfer;
use relume::bake::Monitor;
use relume::scene::World;
use relume::shade::{BounceError, GlossyBounces, TransferredRadiance};

use super::glossy::Arrives;
use crate::jobs::{Event, Jobs};

/// Rays for each side of what is shown first.
const GLANCE: u32 = 32;

/// What is under way.
#[derive(Default)]
pub struct Bouncing {
    /// Of the scene, once its light has bounced.
    object: Option<Arc<GlossyBounces<'static>>>,
    /// Of the light that was asked for last.
    number: u64,
    job: Option<Arc<AtomicBool>>,
    arrives: Option<Arrives>,
}

impl Bouncing {
    /// Whether rays are being cast.
    pub fn is_busy(&self) -> bool {
        self.job.is_some()
    }

    /// Forgets the light that was asked for.
    pub fn stop(&mut self) {
        if let Some(cancelled) = self.job.take() {
            cancelled.store(true, Ordering::Relaxed);
        }
        self.number += 1;
        self.arrives = None;
    }

    /// Asks for the bounces of what arrives, by direct transfer `transfer`, in the place of those asked for before: soon at a glance, then with the rays of the
    /// bake.
    ///
    /// # Errors
    /// A scene whose light does not bounce.
    pub fn start(
        &mut self,
        jobs: &Jobs,
        (world, transfer): (&Arc<World>, &Transfer),
        arrives: Arrives,
        bounces: u32,
    ) -> Result<(), BounceError> {
        self.stop();
        let Some(direct) = arrives.direct.clone() else {
            return Ok(());
        };
        let object = match &self.object {
            Some(object) => Arc::clone(object),
            None => Arc::new(GlossyBounces::new(Arc::clone(world), transfer)?),
        };
        self.object = Some(Arc::clone(&object));
        self.arrives = Some(arrives);
        let (number, cancelled) = (self.number, Arc::new(AtomicBool::new(false)));
        self.job = Some(Arc::clone(&cancelled));
        jobs.run(move |teller| {
            let monitor = Monitor {
                progress: &|_| {},
                cancelled: &cancelled,
            };
            let usual = object.usual_samples();
            for samples in [GLANCE.min(usual), usual] {
                let Ok(found) = object.bounced(&direct, bounces, samples, &monitor) else {
                    return;
                };
                let is_last = samples == usual;
                teller.tell(Event::Bounced(number, Box::new(found), is_last));
                if is_last {
                    return;
                }
            }
        });
        Ok(())
    }

    /// What arrives in all, with the bounces that were found; `None` where the light has changed since.
    pub fn take(
        &mut self,
        number: u64,
        found: &TransferredRadiance,
        is_last: bool,
    ) -> Option<TransferredRadiance> {
        if number != self.number {
            return None;
        }
        if is_last {
            self.job = None;
        }
        self.arrives.as_ref()?.with(Some(found))
    }
}

impl Drop for Bouncing {
    fn drop(&mut self) {
        self.stop();
    }
}
