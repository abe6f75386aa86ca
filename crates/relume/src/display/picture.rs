//! Pixels.

/// A picture in linear Rec. 709 radiance, scene-referred.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width · height` pixels, rows from the top, each from the left.
    pub pixels: Vec<[f32; 3]>,
}

impl Picture {
    /// A picture of one colour.
    pub fn filled(width: u32, height: u32, color: [f32; 3]) -> Self {
        Self {
            width,
            height,
            pixels: vec![color; width as usize * height as usize],
        }
    }

    /// The pixel in column `x` and row `y`. Panics outside.
    pub fn pixel(&self, x: u32, y: u32) -> [f32; 3] {
        assert!(x < self.width, "column {x} of {}", self.width);
        self.pixels[y as usize * self.width as usize + x as usize]
    }
}

/// Pictures side by side, `gap` pixels of `gap_color` between neighbours; lower ones are filled up at the bottom with it.
pub fn strip(pictures: &[Picture], gap: u32, gap_color: [f32; 3]) -> Picture {
    let gaps = gap * (pictures.len() as u32).saturating_sub(1);
    let width = pictures.iter().map(|p| p.width).sum::<u32>() + gaps;
    let height = pictures.iter().map(|p| p.height).max().unwrap_or(0);
    let mut whole = Picture::filled(width, height, gap_color);
    let mut left = 0;
    for picture in pictures {
        let rows = picture.pixels.chunks_exact(picture.width.max(1) as usize);
        for (y, row) in rows.enumerate() {
            let start = y * width as usize + left;
            whole.pixels[start..start + row.len()].copy_from_slice(row);
        }
        left += (picture.width + gap) as usize;
    }
    whole
}

/// Pictures of one width below one another, `gap` rows of `gap_color` between neighbours.
pub fn stack(pictures: &[Picture], gap: u32, gap_color: [f32; 3]) -> Picture {
    let width = pictures.first().map_or(0, |p| p.width);
    assert!(
        pictures.iter().all(|p| p.width == width),
        "pictures of one width"
    );
    let between = vec![gap_color; (gap * width) as usize];
    let rows: Vec<&[[f32; 3]]> = pictures.iter().map(|p| &p.pixels[..]).collect();
    let gaps = gap * (pictures.len() as u32).saturating_sub(1);
    let height = pictures.iter().map(|p| p.height).sum::<u32>() + gaps;
    Picture {
        width,
        height,
        pixels: rows.join(&between[..]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strip_holds_every_picture_and_the_gaps() {
        let red = Picture::filled(2, 1, [1.0, 0.0, 0.0]);
        let blue = Picture::filled(1, 2, [0.0, 0.0, 1.0]);
        let whole = strip(&[red, blue], 1, [0.5; 3]);
        assert_eq!((whole.width, whole.height), (4, 2));
        let (r, g, b) = ([1.0, 0.0, 0.0], [0.5; 3], [0.0, 0.0, 1.0]);
        assert_eq!(whole.pixels, [r, r, g, b, g, g, g, b]);
        assert_eq!(strip(&[], 3, [0.0; 3]).pixels.len(), 0);
    }

    #[test]
    fn a_stack_has_the_gap_between_rows() {
        let [red, blue] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        let whole = stack(
            &[Picture::filled(2, 1, red), Picture::filled(2, 2, blue)],
            1,
            [0.5; 3],
        );
        assert_eq!((whole.width, whole.height), (2, 4));
        assert_eq!(
            whole.pixels,
            [red, red, [0.5; 3], [0.5; 3], blue, blue, blue, blue]
        );
    }
}
