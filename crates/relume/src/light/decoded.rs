//! What every image reader gives.

use super::hdr_image::HdrImage;
use super::layout::Layout;

/// An image, and what its file says of it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Decoded {
    pub(super) image: HdrImage,
    /// How it is wrapped, where the file itself says so: a cube map.
    pub(super) layout: Option<Layout>,
    /// What a person should know, one line each.
    pub(super) warnings: Vec<String>,
}

impl Decoded {
    pub(super) fn new(image: HdrImage, warnings: Vec<String>) -> Self {
        Self {
            image,
            layout: None,
            warnings,
        }
    }
}
