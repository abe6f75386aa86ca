//! Evaluation in f32, a vector of directions at a time.

use super::{Evaluator, LANES};
use crate::simd::{Kernel, Lanes, transpose};

impl Evaluator {
    /// All basis functions at many unit directions, in f32 on one thread.
    ///
    /// `values` is `[direction][order²]`, row-major: as other libraries return it. The same bits for every instruction set, and the same
    /// as [`Evaluator::eval_lanes`] gives. Against [`Evaluator::eval`] in the same (f32) direction, a value of degree l is off by at
    /// most 2(l+1)²·2⁻²⁴ of √((2l+1)/4π); found to order 32: 1.0e-5 absolute, the values reaching 2.2.
    ///
    /// For arrays that do not fit the cache, calls with a few hundred directions each are faster than one.
    pub fn eval_many(&self, directions: &[[f32; 3]], values: &mut [f32]) {
        assert_eq!(
            values.len(),
            directions.len() * self.order.count(),
            "one place per direction and basis function"
        );
        self.level.run(Rows {
            basis: self,
            directions,
            values,
        });
    }

    /// All basis functions at [`LANES`] unit directions at once, in f32.
    ///
    /// `d` holds the x, y and z of the directions; `values[i][lane]` receives `Y_i`. Each lane is computed alone, by the same steps
    /// as [`Evaluator::eval`].
    pub fn eval_lanes(&self, d: &[[f32; LANES]; 3], values: &mut [[f32; LANES]]) {
        assert_eq!(
            values.len(),
            self.order.count(),
            "one place per basis function"
        );
        self.level.run(Columns {
            basis: self,
            d,
            values: values.as_flattened_mut(),
        });
    }

    /// All basis functions at one vector of unit directions, for use inside a [`Kernel`]: `Y_i` of lane k goes to
    /// `values[i · stride + k]`.
    #[inline(always)]
    pub fn eval_vector<L: Lanes>(&self, [x, y, z]: [L; 3], values: &mut [f32], stride: usize) {
        let n = self.order.get();
        let (mut re, mut im) = (L::splat(1.0), L::splat(0.0));
        let mut steps = &self.steps_f32[..];
        for m in 0..n {
            let (column, rest) = steps.split_at(n - 1 - m);
            let (mut before, mut p) = (L::splat(0.0), L::splat(self.sectoral_f32[m]));
            let mut middle = m * (m + 1);
            (p * im).store(&mut values[(middle - m) * stride..]);
            (p * re).store(&mut values[(middle + m) * stride..]);
            for (i, &(a, ab)) in column.iter().enumerate() {
                (before, p) = (p, L::splat(a) * z * p - L::splat(ab) * before);
                middle += 2 * (m + i + 1);
                (p * im).store(&mut values[(middle - m) * stride..]);
                (p * re).store(&mut values[(middle + m) * stride..]);
            }
            steps = rest;
            (re, im) = (re * x - im * y, im * x + re * y);
        }
    }
}

/// [`Evaluator::eval_lanes`].
struct Columns<'a> {
    basis: &'a Evaluator,
    d: &'a [[f32; LANES]; 3],
    values: &'a mut [f32],
}

impl Kernel for Columns<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let [x, y, z] = self.d;
        let mut start = 0;
        while start < LANES {
            let d = [
                L::load(&x[start..]),
                L::load(&y[start..]),
                L::load(&z[start..]),
            ];
            self.basis.eval_vector(d, &mut self.values[start..], LANES);
            start += L::COUNT;
        }
    }
}

/// [`Evaluator::eval_many`].
struct Rows<'a> {
    basis: &'a Evaluator,
    directions: &'a [[f32; 3]],
    values: &'a mut [f32],
}

impl Kernel for Rows<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let count = self.basis.order.count();
        // Blocks of whole vectors; the last few basis functions of a block lie behind the end where there are fewer than lanes.
        let mut columns = vec![0.0; count.max(L::COUNT) * L::COUNT];
        let mut square = [0.0; 256];
        let groups = self.directions.chunks(L::COUNT);
        for (group, rows) in groups.zip(self.values.chunks_mut(count * L::COUNT)) {
            let d = lanes::<L>(group);
            self.basis.eval_vector(d, &mut columns, L::COUNT);
            if group.len() == L::COUNT && count >= L::COUNT {
                blocks::<L>(&columns, rows, count);
                continue;
            }
            let mut start = 0;
            while start < count {
                let end = count.min(start + L::COUNT);
                let from = end.saturating_sub(L::COUNT);
                transpose::<L>(&columns[from * L::COUNT..], L::COUNT, &mut square, L::COUNT);
                for (i, row) in rows.chunks_mut(count).enumerate() {
                    row[from..end].copy_from_slice(&square[i * L::COUNT..][..end - from]);
                }
                start = end;
            }
        }
    }
}

/// Columns `[count][L::COUNT]` to rows `[L::COUNT][count]`; the last block overlaps the one before it.
#[inline(always)]
fn blocks<L: Lanes>(columns: &[f32], rows: &mut [f32], count: usize) {
    let mut start = 0;
    loop {
        transpose::<L>(
            &columns[start * L::COUNT..],
            L::COUNT,
            &mut rows[start..],
            count,
        );
        if start + L::COUNT == count {
            return;
        }
        start = (start + L::COUNT).min(count - L::COUNT);
    }
}

/// The x, y and z of up to `L::COUNT` directions; lanes without one hold zeros.
#[inline(always)]
fn lanes<L: Lanes>(directions: &[[f32; 3]]) -> [L; 3] {
    let mut axes = [[0.0; 16]; 3];
    for (i, d) in directions.iter().enumerate() {
        axes[0][i] = d[0];
        axes[1][i] = d[1];
        axes[2][i] = d[2];
    }
    [L::load(&axes[0]), L::load(&axes[1]), L::load(&axes[2])]
}
