//! The gather operator: how surface radiance bounces on, apart from any light.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::builder::{Builder, object};
use super::container::Part;
use super::views::Views;
use super::{AssetError, Precision, header};
use crate::files::le_words;

/// G in `B_{k+1} = G · B_k`, with B the transferred radiance of every side (without its own albedo): what is seen of all other sides, each
/// times its albedo.
///
/// A side is a vertex's front, or one of [`super::BackTransfer::vertices`]: fronts come first. Row i, column j: the share of what side i
/// gathers (`1/π ∫ … cosθ dω`) that comes from points near side j, by barycentric weights, times the albedo there. Light that varies over the
/// object bounces right this way: direct light by its own transfer at each side, then G as often as wanted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gather {
    /// 1 where no albedo has a colour, else 3.
    pub channels: usize,
    /// Where each row's entries begin, and where the last one's end.
    pub starts: Vec<u64>,
    /// Ascending in each row.
    pub columns: Vec<u32>,
    /// `channels` for each column.
    pub weights: Vec<f32>,
}

/// What stands in the document's own `RELUME_transfer`.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Named {
    rows: usize,
    channels: usize,
    entries: usize,
    /// Buffer view of the number of entries of each row, u32.
    counts: usize,
    /// Buffer view of u32.
    columns: usize,
    /// Buffer view of f32.
    weights: usize,
}

impl Gather {
    /// How many sides.
    pub fn rows(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Columns and weights of a row.
    pub fn row(&self, i: usize) -> (&[u32], &[f32]) {
        let range = self.starts[i] as usize..self.starts[i + 1] as usize;
        let weights = range.start * self.channels..range.end * self.channels;
        (&self.columns[range], &self.weights[weights])
    }

    /// One more reflection of transferred radiance, one value per side; summed in f64, in the order of the columns.
    ///
    /// Panics when there are not as many values as sides.
    pub fn apply(&self, radiance: &[[f32; 3]]) -> Vec<[f32; 3]> {
        assert_eq!(radiance.len(), self.rows(), "one value per side");
        let reflected = |row: usize| {
            let (columns, weights) = self.row(row);
            let mut sums = [0.0_f64; 3];
            for (&column, weights) in columns.iter().zip(weights.chunks(self.channels)) {
                for (c, sum) in sums.iter_mut().enumerate() {
                    let weight = weights[c % self.channels];
                    *sum += f64::from(weight) * f64::from(radiance[column as usize][c]);
                }
            }
            sums.map(|sum| sum as f32)
        };
        (0..self.rows()).map(reflected).collect()
    }

    /// Whether its lengths fit together, for so many sides, and its numbers are some.
    ///
    /// # Errors
    /// In words, what it is.
    pub fn check(&self, sides: usize) -> Result<(), String> {
        let whole = self.starts.first() == Some(&0)
            && self.starts.is_sorted()
            && self.starts.last() == Some(&(self.columns.len() as u64))
            && matches!(self.channels, 1 | 3)
            && self.weights.len() == self.channels * self.columns.len();
        if !whole || self.rows() != sides {
            return Err(format!(
                "a gather operator that is not one of {sides} sides"
            ));
        }
        if self.columns.iter().any(|&column| column as usize >= sides) {
            return Err("a gather operator with a column that is no side".to_owned());
        }
        let rows = (0..sides).map(|i| self.row(i).0);
        if !rows.into_iter().all(|row| row.is_sorted_by(|a, b| a < b)) {
            return Err("a gather operator whose columns do not ascend".to_owned());
        }
        match self.weights.iter().all(|w| (0.0..=1e8).contains(w)) {
            true => Ok(()),
            false => Err("a gather operator with a weight outside 0…1e8".to_owned()),
        }
    }

    /// Adds the arrays, and the document's own extension that names them.
    pub(super) fn put<'a>(&'a self, builder: &mut Builder<'a>) -> Result<(), AssetError> {
        let counts = self
            .starts
            .windows(2)
            .map(|pair| (pair[1] - pair[0]) as u32);
        let counts: Vec<u8> = counts.flat_map(u32::to_le_bytes).collect();
        let named = Named {
            rows: self.rows(),
            channels: self.channels,
            entries: self.columns.len(),
            counts: builder.transfer_view(Part::Bytes(counts.into()))?,
            columns: builder.transfer_view(Part::Bytes(le_words(&self.columns)))?,
            weights: builder.transfer_view(Part::Floats(&self.weights))?,
        };
        let document = object(&mut builder.json, "the document")?;
        let extensions = document.entry("extensions").or_insert_with(|| json!({}));
        let own = json!({ "version": header::VERSION, "gather": named });
        object(extensions, "extensions")?.insert(header::NAME.to_owned(), own);
        Ok(())
    }

    /// What the document's own extension names, for `sides` sides; `None` without any.
    pub(super) fn take(
        json: &Value,
        views: &mut Views,
        sides: usize,
    ) -> Result<Option<Self>, String> {
        let Some(named) = json["extensions"][header::NAME].get("gather") else {
            return Ok(None);
        };
        let named = Named::deserialize(named)
            .map_err(|_| "names its gather operator in words that are not known".to_owned())?;
        if named.rows != sides {
            return Err(format!(
                "has a gather operator of {} rows for {sides} sides",
                named.rows
            ));
        }
        if !matches!(named.channels, 1 | 3) {
            return Err(format!(
                "has a gather operator of {} channels, not 1 or 3",
                named.channels
            ));
        }
        let mut starts = vec![0];
        let mut end = 0;
        for count in views.words(named.counts, sides)? {
            end += u64::from(count);
            starts.push(end);
        }
        let mut weights = Vec::new();
        let columns = views.words(named.columns, named.entries)?;
        let shape = (named.entries, named.channels);
        views.floats(named.weights, shape, Precision::F32, &mut weights)?;
        let gather = Self {
            channels: named.channels,
            starts,
            columns,
            weights,
        };
        gather.check(sides).map_err(|what| format!("has {what}"))?;
        Ok(Some(gather))
    }
}
