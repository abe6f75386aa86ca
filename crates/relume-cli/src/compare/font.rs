//! The few letters of a scale, drawn into a picture.

use relume::display::Picture;

/// Rows of a letter.
pub const HEIGHT: u32 = 5;
/// Columns of a letter, and of it with the space after it.
const WIDTH: u32 = 3;
const STEP: u32 = WIDTH + 1;

/// Rows from the top, each three bits from the left.
fn rows(letter: char) -> [u8; 5] {
    match letter {
        '0' => [0b111, 0b101, 0b101, 0b101, 0b111],
        '1' => [0b010, 0b110, 0b010, 0b010, 0b111],
        '2' => [0b111, 0b001, 0b111, 0b100, 0b111],
        '3' => [0b111, 0b001, 0b111, 0b001, 0b111],
        '4' => [0b101, 0b101, 0b111, 0b001, 0b001],
        '5' => [0b111, 0b100, 0b111, 0b001, 0b111],
        '6' => [0b111, 0b100, 0b111, 0b101, 0b111],
        '7' => [0b111, 0b001, 0b010, 0b010, 0b010],
        '8' => [0b111, 0b101, 0b111, 0b101, 0b111],
        '9' => [0b111, 0b101, 0b111, 0b001, 0b111],
        '+' => [0b000, 0b010, 0b111, 0b010, 0b000],
        '-' => [0b000, 0b000, 0b111, 0b000, 0b000],
        '.' => [0b000, 0b000, 0b000, 0b000, 0b010],
        '%' => [0b101, 0b001, 0b010, 0b100, 0b101],
        _ => [0; 5],
    }
}

/// Columns that `text` takes.
pub fn width(text: &str) -> u32 {
    (STEP * text.chars().count() as u32).saturating_sub(1)
}

/// Draws `text` from its top left corner, `zoom` pixels to a dot; what does not fit is cut off.
pub fn draw(
    picture: &mut Picture,
    text: &str,
    (left, top): (u32, u32),
    zoom: u32,
    color: [f32; 3],
) {
    for (i, letter) in text.chars().enumerate() {
        let rows = rows(letter);
        for y in 0..HEIGHT * zoom {
            for x in 0..WIDTH * zoom {
                let is_set = rows[(y / zoom) as usize] >> (WIDTH - 1 - x / zoom) & 1 == 1;
                let (x, y) = (left + i as u32 * STEP * zoom + x, top + y);
                if is_set && x < picture.width && y < picture.height {
                    picture.pixels[(y * picture.width + x) as usize] = color;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_drawn_where_asked_and_cut_off_at_the_edge() {
        let mut picture = Picture::filled(6, 6, [0.0; 3]);
        draw(&mut picture, "-1", (0, 1), 1, [1.0; 3]);
        let row = |y| {
            (0..6)
                .map(|x| picture.pixel(x, y)[0] as u8)
                .collect::<Vec<_>>()
        };
        assert_eq!(row(0), [0; 6]);
        assert_eq!(row(3), [1, 1, 1, 0, 0, 1]);
        assert_eq!(row(5), [0, 0, 0, 0, 1, 1]);
        assert_eq!(width("-1"), 7);
    }
}
