//! The one table that benches print their figures in.

use std::fmt::{self, Display, Formatter};

/// One figure of ours beside another's, both measured in the same run.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// What was measured, against what.
    pub name: String,
    /// Ours, in `unit`.
    pub ours: f64,
    /// Theirs, in the same unit; more is better.
    pub theirs: f64,
    /// What both are counted in.
    pub unit: &'static str,
    /// The ratio ours over theirs that is aimed at; `None` where the row only informs.
    pub aim: Option<f64>,
}

impl Row {
    /// Ours over theirs.
    pub fn ratio(&self) -> f64 {
        self.ours / self.theirs
    }

    /// Whether the ratio reaches the aim, if there is one.
    pub fn is_reached(&self) -> bool {
        self.aim.is_none_or(|aim| self.ratio() >= aim)
    }
}

/// Rows under one heading.
pub struct Table(pub Vec<Row>);

impl Display for Table {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let names = self.0.iter().map(|row| row.name.chars().count());
        let width = names.max().unwrap_or(0);
        writeln!(
            f,
            "{:width$} {:>10} {:>10} {:22} {:>7} {:>6}",
            "", "ours", "theirs", "", "ratio", "aim"
        )?;
        for row in &self.0 {
            writeln!(
                f,
                "{:width$} {:>10} {:>10} {:22} {:>7} {:>6}{}",
                row.name,
                short(row.ours),
                short(row.theirs),
                row.unit,
                short(row.ratio()),
                row.aim.map_or("–".to_owned(), short),
                if row.is_reached() { "" } else { " missed" }
            )?;
        }
        Ok(())
    }
}

/// Three digits that count, and no more than two behind the point.
fn short(x: f64) -> String {
    match x.abs() {
        a if a >= 100.0 => format!("{x:.0}"),
        a if a >= 10.0 => format!("{x:.1}"),
        _ => format!("{x:.2}"),
    }
}

/// The median; not a number where there are none.
pub fn median(numbers: &[f64]) -> f64 {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => sorted[n / 2],
        n => (sorted[n / 2 - 1] + sorted[n / 2]) / 2.0,
    }
}

/// The row of a line `name⇥ours⇥theirs`, as the scripts and examples behind the benches print it; `None` for any other line.
pub fn parse(line: &str, unit: &'static str, aim: Option<f64>) -> Option<Row> {
    let mut fields = line.split('\t');
    let name = fields.next()?.to_owned();
    let ours = fields.next()?.trim().parse().ok()?;
    let theirs = fields.next()?.trim().parse().ok()?;
    Some(Row {
        name,
        ours,
        theirs,
        unit,
        aim,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_line_up_and_say_what_was_missed() {
        let row = |name: &str, ours| Row {
            name: name.to_owned(),
            ours,
            theirs: 8.0,
            unit: "GB/s",
            aim: Some(1.5),
        };
        let text = Table(vec![row("short", 12.0), row("somewhat longer", 11.0)]).to_string();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 3);
        assert!(
            lines[1].contains("12.0") && lines[1].contains("1.50") && !lines[1].contains("missed")
        );
        assert!(lines[2].contains("1.38") && lines[2].ends_with("missed"));
        assert_eq!(lines[1].find("GB/s"), lines[2].find("GB/s"));
    }

    #[test]
    fn lines_of_three_fields_are_rows() {
        let row = parse("a b\t3e2\t100", "x", Some(2.0)).unwrap();
        assert_eq!((row.name.as_str(), row.ratio()), ("a b", 3.0));
        assert!(parse("a b 3 100", "x", None).is_none());
        assert!(parse("a\tb\t1", "x", None).is_none());
    }

    #[test]
    fn the_median_lies_in_the_middle() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), 2.5);
        assert!(median(&[]).is_nan());
    }
}
