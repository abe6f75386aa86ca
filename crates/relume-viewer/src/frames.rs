//! How long frames took, for the graph.

use std::collections::VecDeque;

use crate::stage::PassTimes;

/// Frames that are kept.
const KEPT: usize = 240;

/// A frame's times in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frame {
    /// From its start to its submission.
    pub cpu: f32,
    /// On the device, as far as known; of a frame shortly before.
    pub gpu: PassTimes,
}

/// The last frames.
#[derive(Clone, Debug, Default)]
pub struct Frames {
    frames: VecDeque<Frame>,
    /// Frames drawn since the start.
    pub drawn: u64,
    /// Relight passes since the start.
    pub relights: u64,
}

impl Frames {
    /// Adds a frame.
    pub fn push(&mut self, frame: Frame) {
        if self.frames.len() == KEPT {
            self.frames.pop_front();
        }
        self.frames.push_back(frame);
        self.drawn += 1;
    }

    /// From the oldest to the newest.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Frame> {
        self.frames.iter()
    }

    /// The mean and the 99th percentile of what `of` picks, where it picks anything.
    pub fn summary(&self, of: impl Fn(&Frame) -> Option<f32>) -> Option<(f32, f32)> {
        let mut times: Vec<f32> = self.frames.iter().filter_map(of).collect();
        times.sort_by(f32::total_cmp);
        let last = times.len().checked_sub(1)?;
        let mean = times.iter().sum::<f32>() / times.len() as f32;
        Some((mean, times[last * 99 / 100]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_frames_go_and_the_summary_is_of_what_is_left() {
        let mut frames = Frames::default();
        assert_eq!(frames.summary(|f| Some(f.cpu)), None);
        for i in 0..KEPT + 100 {
            frames.push(Frame {
                cpu: i as f32,
                ..Frame::default()
            });
        }
        assert_eq!((frames.drawn, frames.iter().len()), (340, KEPT));
        let (mean, high) = frames.summary(|f| Some(f.cpu)).unwrap();
        assert_eq!(mean, 219.5);
        assert_eq!(high, 336.0);
        assert_eq!(frames.summary(|f| f.gpu.view), None);
    }
}
