//! The little linear algebra that fits need: symmetric matrices, row by row.

/// The lower factor of Cholesky.
pub fn cholesky(matrix: &[f64], n: usize) -> Vec<f64> {
    let mut factor = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| factor[i * n + k] * factor[j * n + k]).sum();
            let rest = matrix[i * n + j] - known;
            factor[i * n + j] = if i == j {
                rest.sqrt()
            } else {
                rest / factor[j * n + j]
            };
        }
    }
    factor
}

/// Solves `factor x = b` in place.
pub fn forward(factor: &[f64], n: usize, b: &mut [f64]) {
    for i in 0..n {
        let known: f64 = (0..i).map(|k| factor[i * n + k] * b[k]).sum();
        b[i] = (b[i] - known) / factor[i * n + i];
    }
}

/// Solves `factorᵀ x = b` in place.
pub fn backward(factor: &[f64], n: usize, b: &mut [f64]) {
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| factor[k * n + i] * b[k]).sum();
        b[i] = (b[i] - known) / factor[i * n + i];
    }
}

/// Eigenvalues and eigenvectors (columns), by Jacobi's rotations.
pub fn eigen(matrix: &[f64], n: usize) -> (Vec<f64>, Vec<f64>) {
    let mut a = matrix.to_vec();
    let mut vectors = vec![0.0; n * n];
    (0..n).for_each(|i| vectors[i * n + i] = 1.0);
    // Convergence is quadratic: ten sweeps are more than enough for these sizes.
    for _ in 0..30 {
        for p in 0..n {
            for q in p + 1..n {
                rotate(&mut a, &mut vectors, n, p, q);
            }
        }
    }
    ((0..n).map(|i| a[i * n + i]).collect(), vectors)
}

/// Makes `a[p, q]` zero.
fn rotate(a: &mut [f64], vectors: &mut [f64], n: usize, p: usize, q: usize) {
    let off = a[p * n + q];
    if off == 0.0 {
        return;
    }
    let half = (a[q * n + q] - a[p * n + p]) / (2.0 * off);
    let tangent = half.signum() / (half.abs() + (half * half + 1.0).sqrt());
    let cos = 1.0 / (tangent * tangent + 1.0).sqrt();
    let sin = tangent * cos;
    for k in 0..n {
        let (x, y) = (a[k * n + p], a[k * n + q]);
        (a[k * n + p], a[k * n + q]) = (cos * x - sin * y, sin * x + cos * y);
    }
    for k in 0..n {
        let (x, y) = (a[p * n + k], a[q * n + k]);
        (a[p * n + k], a[q * n + k]) = (cos * x - sin * y, sin * x + cos * y);
    }
    for row in vectors.chunks_exact_mut(n) {
        (row[p], row[q]) = (cos * row[p] - sin * row[q], sin * row[p] + cos * row[q]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Symmetric, with eigenvalues that are positive.
    fn matrix(n: usize) -> Vec<f64> {
        let half = |i: usize, j: usize| f64::sin(1.3 * (i * n + j) as f64);
        let entry = |i: usize, j: usize| (0..n).map(|k| half(i, k) * half(j, k)).sum::<f64>();
        let at = |ij: usize| entry(ij / n, ij % n) + f64::from(u8::from(ij / n == ij % n));
        (0..n * n).map(at).collect()
    }

    #[test]
    fn factors_solve() {
        let n = 6;
        let a = matrix(n);
        let factor = cholesky(&a, n);
        let mut x = [1.0, -2.0, 0.5, 3.0, 0.0, 1.0];
        let b = x;
        forward(&factor, n, &mut x);
        backward(&factor, n, &mut x);
        for i in 0..n {
            let product: f64 = (0..n).map(|j| a[i * n + j] * x[j]).sum();
            assert!((product - b[i]).abs() < 1e-12);
        }
    }

    #[test]
    fn eigenvectors_are_only_scaled() {
        let n = 7;
        let a = matrix(n);
        let (values, vectors) = eigen(&a, n);
        for k in 0..n {
            for i in 0..n {
                let product: f64 = (0..n).map(|j| a[i * n + j] * vectors[j * n + k]).sum();
                assert!((product - values[k] * vectors[i * n + k]).abs() < 1e-11);
            }
        }
    }
}
