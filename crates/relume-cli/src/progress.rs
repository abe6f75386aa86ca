//! Progress bars: on stderr, silent when that is not a terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use relume::bake::Progress;

/// The bar of a bake: vertices of all passes, and time left.
pub fn bake_bar() -> ProgressBar {
    let bar = ProgressBar::new(0);
    let template =
        "{msg:12} {wide_bar} {percent:>3} %  {human_pos} of {human_len} vertices  {eta} left";
    bar.set_style(style(template));
    bar.enable_steady_tick(Duration::from_millis(250));
    bar
}

/// Moves the bar of a bake.
pub fn show(bar: &ProgressBar, progress: Progress) {
    // Tiles end out of order; the bar never goes back.
    bar.set_length(progress.total);
    if progress.done > bar.position() {
        bar.set_position(progress.done);
        bar.set_message(match progress.bounce {
            0 => "direct light".to_owned(),
            k => format!("bounce {k}"),
        });
    }
}

/// A bar over whole things, such as frames.
pub fn count_bar(what: &'static str, total: u64) -> ProgressBar {
    let bar = ProgressBar::new(total);
    bar.set_style(style("{msg:12} {wide_bar} {pos}/{len}  {eta} left"));
    bar.set_message(what);
    bar
}

/// A spinner for work of unknown length.
pub fn spinner(what: impl Into<std::borrow::Cow<'static, str>>) -> ProgressBar {
    let bar = ProgressBar::new_spinner();
    bar.set_message(what);
    bar.enable_steady_tick(Duration::from_millis(120));
    bar
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).expect("a fixed template that is tested by showing it")
}

/// `12,345,678` for people.
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

/// `4.3 MB` for people.
pub fn bytes(count: u64) -> String {
    const UNITS: [&str; 5] = ["bytes", "kB", "MB", "GB", "TB"];
    let mut size = count as f64;
    let mut unit = 0;
    while size >= 1000.0 && unit + 1 < UNITS.len() {
        size /= 1000.0;
        unit += 1;
    }
    if unit == 0 {
        format!("{count} bytes")
    } else {
        format!("{size:.1} {}", UNITS[unit])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(
            [0, 999, 1000, 1_234_567].map(grouped),
            ["0", "999", "1,000", "1,234,567"]
        );
        assert_eq!([17, 4_324_300].map(bytes), ["17 bytes", "4.3 MB"]);
    }

    #[test]
    fn the_templates_are_valid() {
        bake_bar().finish_and_clear();
        count_bar("frames", 1).finish_and_clear();
    }
}
