//! Products of expansions: the sparse Gaunt tensor.

use std::f64::consts::PI;

use glam::DVec3;

use super::{Order, gauss_legendre, index, sh::Evaluator};

/// The tensor `C_ijk = ∫ Y_i Y_j Y_k dω` for factors of order a and b and results of order `out`, without the entries that vanish
/// by the selection rules.
///
/// The product of `f = Σ a_i Y_i` and `g = Σ b_j Y_j` has the coefficients `Σ_ij C_ijk a_i b_j` [sloan2005, triple products]; it is
/// complete when out is a + b − 1 and cut off otherwise. C_ijk is 0 unless the degrees obey the triangle inequality and have an even
/// sum, one |m| is the sum of the other two, and an even number of the m is negative.
///
/// 16 bytes an entry: 1.2 MB for 10 × 10 → 19, 234 MB for 32 × 32 → 32.
#[derive(Clone, Debug)]
pub struct Product {
    order_a: Order,
    order_b: Order,
    order_out: Order,
    /// Entries of result k are `entries[starts[k]..starts[k + 1]]`.
    starts: Vec<usize>,
    entries: Vec<Entry>,
}

/// One entry of the tensor: `C_ijk` of a known k.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Coefficient of the first factor.
    pub i: u16,
    /// Coefficient of the second factor.
    pub j: u16,
    /// `∫ Y_i Y_j Y_k dω`.
    pub value: f64,
}

impl Product {
    /// The tensor for factors of `order_a` and `order_b`, and results of `order_out`.
    pub fn new(order_a: Order, order_b: Order, order_out: Order) -> Self {
        let polar = Polar::new(order_a.max(order_b).max(order_out));
        let (mut starts, mut entries) = (vec![0], Vec::new());
        for (l3, m3) in terms(order_out) {
            for (l1, m1) in terms(order_a) {
                for m2 in partners(m1, m3) {
                    let l2s = l1.abs_diff(l3).max(m2.unsigned_abs())..=l1 + l3;
                    let l2s = l2s.take_while(|&l2| l2 < order_b.get());
                    for l2 in l2s.filter(|l2| (l1 + l2 + l3) % 2 == 0) {
                        let value = polar.integral([(l1, m1), (l2, m2), (l3, m3)]);
                        entries.push(Entry {
                            i: index(l1, m1) as u16,
                            j: index(l2, m2) as u16,
                            value,
                        });
                    }
                }
            }
            starts.push(entries.len());
        }
        Self {
            order_a,
            order_b,
            order_out,
            starts,
            entries,
        }
    }

    /// Orders of the two factors and of the result.
    pub fn orders(&self) -> [Order; 3] {
        [self.order_a, self.order_b, self.order_out]
    }

    /// The entries `C_ijk` of result `k`.
    pub fn entries(&self, k: usize) -> &[Entry] {
        &self.entries[self.starts[k]..self.starts[k + 1]]
    }

    /// Writes the coefficients of the product of `a` and `b` to `out`; each has as many places as its order has coefficients.
    pub fn multiply(&self, a: &[f64], b: &[f64], out: &mut [f64]) {
        self.check(a, self.order_a);
        self.check(b, self.order_b);
        self.check(out, self.order_out);
        for (k, out) in out.iter_mut().enumerate() {
            *out = self.sum(k, a, b);
        }
    }

    /// The matrix that multiplies by `a`: row-major, `order_out²` rows, `order_b²` columns.
    pub fn matrix(&self, a: &[f64]) -> Vec<f64> {
        self.check(a, self.order_a);
        let columns = self.order_b.count();
        let mut matrix = vec![0.0; self.order_out.count() * columns];
        for (k, row) in matrix.chunks_mut(columns).enumerate() {
            for entry in self.entries(k) {
                row[usize::from(entry.j)] += entry.value * a[usize::from(entry.i)];
            }
        }
        matrix
    }

    /// `∫ f g h dω = Σ C_ijk a_i b_j c_k`, where `c` is of the result's order. Exact: nothing is cut off.
    pub fn triple(&self, a: &[f64], b: &[f64], c: &[f64]) -> f64 {
        self.check(a, self.order_a);
        self.check(b, self.order_b);
        self.check(c, self.order_out);
        let terms = c.iter().enumerate().map(|(k, c)| c * self.sum(k, a, b));
        terms.sum()
    }

    fn sum(&self, k: usize, a: &[f64], b: &[f64]) -> f64 {
        let terms = self.entries(k).iter();
        terms
            .map(|entry| entry.value * a[usize::from(entry.i)] * b[usize::from(entry.j)])
            .sum()
    }

    fn check(&self, values: &[f64], order: Order) {
        assert_eq!(
            values.len(),
            order.count(),
            "one coefficient per basis function of order {order}"
        );
    }
}

/// Degree and m of every coefficient, in order.
fn terms(order: Order) -> impl Iterator<Item = (usize, isize)> {
    order
        .degrees()
        .flat_map(|l| (-(l as isize)..=l as isize).map(move |m| (l, m)))
}

/// Every m that the integral over longitude allows beside `a` and `b`: ±(|a|+|b|) and ±||a|−|b||, with the sign that makes the number
/// of sines even.
fn partners(a: isize, b: isize) -> impl Iterator<Item = isize> {
    let sine = (a < 0) != (b < 0);
    let (far, near) = (a.abs() + b.abs(), (a.abs() - b.abs()).abs());
    let both = [Some(far), Some(near).filter(|&near| near != far)];
    // There is no sine of m = 0.
    let both = both.into_iter().flatten().filter(move |&m| m > 0 || !sine);
    both.map(move |m| if sine { -m } else { m })
}

/// The polar factors of all basis functions at the nodes of a rule that integrates products of three exactly.
struct Polar {
    weights: Vec<f64>,
    /// Factor of (l, |m|) at every node, at `index(l, |m|)`: P̄_lm, with √2 for m > 0.
    values: Vec<Vec<f64>>,
}

impl Polar {
    fn new(order: Order) -> Self {
        // The degrees add up to 3(n−1) at most, and m to an even number: half powers of 1−z² do not occur.
        let rule = gauss_legendre(3 * (order.get() - 1) / 2 + 1);
        let evaluator = Evaluator::new(order);
        let mut y = vec![0.0; order.count()];
        let mut values = vec![Vec::with_capacity(rule.len()); order.count()];
        for &(z, _) in &rule {
            // At longitude 0, cosines are 1.
            evaluator.eval(DVec3::new(((1.0 - z) * (1.0 + z)).sqrt(), 0.0, z), &mut y);
            for (values, &y) in values.iter_mut().zip(&y) {
                values.push(y);
            }
        }
        Self {
            weights: rule.into_iter().map(|(_, weight)| weight).collect(),
            values,
        }
    }

    /// `∫ Y_1 Y_2 Y_3 dω` of three functions that the selection rules allow: the same bits in any order of the three.
    fn integral(&self, mut y: [(usize, isize); 3]) -> f64 {
        y.sort_unstable();
        let [a, b, c] = y.map(|(l, m)| &self.values[index(l, m.abs())]);
        let nodes = self.weights.iter().zip(a).zip(b).zip(c);
        let polar: f64 = nodes.map(|(((w, a), b), c)| w * a * b * c).sum();
        polar * longitude(y.map(|(_, m)| m))
    }
}

/// `∫ t_a t_b t_c dφ`, where t_m is cos mφ (m ≥ 0) or sin |m|φ, for an m that [`partners`] found.
fn longitude(m: [isize; 3]) -> f64 {
    match m.iter().filter(|&&m| m == 0).count() {
        3 => 2.0 * PI,
        // cos² or sin².
        1 => PI,
        // Product formulae, with the largest |m| the sum of the others: −1 for two sines that are those others.
        _ => {
            let largest = m.into_iter().max_by_key(|m| m.abs()).unwrap_or(0);
            let sines = m.iter().filter(|&&m| m < 0).count();
            if sines == 2 && largest > 0 {
                -PI / 2.0
            } else {
                PI / 2.0
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::{Quadrature, evaluate, fixtures, sh};

    fn order(n: usize) -> Order {
        Order::new(n).unwrap()
    }

    /// The stored tensor, dense.
    fn dense(product: &Product) -> Vec<f64> {
        let [a, b, out] = product.orders().map(Order::count);
        let mut tensor = vec![0.0; a * b * out];
        for k in 0..out {
            for entry in product.entries(k) {
                let place = (usize::from(entry.i) * b + usize::from(entry.j)) * out + k;
                assert_eq!(tensor[place], 0.0, "stored twice");
                tensor[place] = entry.value;
            }
        }
        tensor
    }

    #[test]
    fn every_entry_is_the_integral_and_every_other_integral_is_zero() {
        let (a, b, out) = (order(5), order(4), order(8));
        let product = Product::new(a, b, out);
        let mut oracle = vec![0.0; a.count() * b.count() * out.count()];
        for &(d, weight) in Quadrature::new(4 + 3 + 7).nodes() {
            let y = sh::eval(out, d);
            for i in 0..a.count() {
                for j in 0..b.count() {
                    for k in 0..out.count() {
                        oracle[(i * b.count() + j) * out.count() + k] +=
                            weight * y[i] * y[j] * y[k];
                    }
                }
            }
        }
        let error = fixtures::largest_difference(&oracle, &dense(&product));
        assert!(error < 1e-14, "{error}");
        // Nothing is stored that the oracle says is zero, but for the few zeros that no rule explains.
        let stored = product.entries.len();
        let nonzero = oracle.iter().filter(|c| c.abs() > 1e-14).count();
        println!("5 × 4 → 8: {stored} entries, {nonzero} of them not zero");
        assert!(nonzero <= stored && stored * 100 <= nonzero * 103);
    }

    #[test]
    fn symmetric_in_all_three() {
        let n = 7;
        let product = Product::new(order(n), order(n), order(n));
        let (tensor, count) = (dense(&product), n * n);
        let at = |i, j, k| tensor[(i * count + j) * count + k];
        for i in 0..count {
            for j in 0..=i {
                for k in 0..=j {
                    let same = [
                        at(i, k, j),
                        at(j, i, k),
                        at(j, k, i),
                        at(k, i, j),
                        at(k, j, i),
                    ];
                    assert!(same.iter().all(|&c| c == at(i, j, k)), "{i} {j} {k}");
                }
            }
        }
    }

    #[test]
    fn products_are_the_products_of_the_values() {
        for (a, b) in [(1, 1), (1, 6), (6, 5), (10, 10), (16, 17)] {
            let (ca, cb) = (
                fixtures::coefficients(1, a * a),
                fixtures::coefficients(2, b * b),
            );
            let out = order(a + b - 1);
            let mut c = vec![f64::NAN; out.count()];
            Product::new(order(a), order(b), out).multiply(&ca, &cb, &mut c);
            let mut largest = 0f64;
            for d in fixtures::directions(40) {
                let error = (evaluate(&c, d) - evaluate(&ca, d) * evaluate(&cb, d)).abs();
                largest = largest.max(error);
            }
            println!(
                "product {a} × {b} → {}: largest error {largest:.2e}",
                a + b - 1
            );
            // Σ|c||Y| rounded by its number of terms.
            let bound = 1e-16 * (a * b * (a + b) * (a + b)) as f64;
            assert!(largest < bound, "{a} × {b}: {largest}");
        }
    }

    #[test]
    fn cut_off_results_are_the_beginning_of_complete_ones() {
        let (a, b) = (fixtures::coefficients(1, 36), fixtures::coefficients(2, 25));
        let (mut whole, mut part) = (vec![0.0; 100], vec![0.0; 9]);
        Product::new(order(6), order(5), order(10)).multiply(&a, &b, &mut whole);
        Product::new(order(6), order(5), order(3)).multiply(&a, &b, &mut part);
        // Other nodes, so another rounding of the entries.
        assert!(fixtures::largest_difference(&part, &whole[..9]) < 1e-14);
    }

    #[test]
    fn known_values() {
        let product = Product::new(order(3), order(3), order(3));
        let tensor = dense(&product);
        let at = |i: usize, j: usize, k: usize| tensor[(i * 9 + j) * 9 + k];
        let constant = 0.5 / PI.sqrt();
        for j in 0..9 {
            assert!((at(0, j, j) - constant).abs() < 1e-15);
        }
        let close = |value: f64, expected: f64| (value - expected).abs() < 1e-15;
        // ∫ Y10 Y10 Y20 = 1/√(5π), ∫ Y20³ = √(5/π)/7, ∫ Y1±1² Y20 = −½/√(5π), ∫ Y11² Y22 = √(3/20π), ∫ Y1-1² Y22 = −that.
        assert!(close(at(2, 2, 6), 1.0 / (5.0 * PI).sqrt()));
        assert!(close(at(6, 6, 6), (5.0 / PI).sqrt() / 7.0));
        assert!(close(at(1, 1, 6), -0.5 / (5.0 * PI).sqrt()));
        assert!(close(at(3, 3, 8), (3.0 / (20.0 * PI)).sqrt()));
        assert!(close(at(1, 1, 8), -(3.0 / (20.0 * PI)).sqrt()));
        assert!(close(at(1, 3, 4), (3.0 / (20.0 * PI)).sqrt()));
    }

    #[test]
    fn matrix_and_triple_say_the_same_as_multiply() {
        let (oa, ob, oc) = (order(6), order(4), order(5));
        let product = Product::new(oa, ob, oc);
        let a = fixtures::coefficients(1, oa.count());
        let b = fixtures::coefficients(2, ob.count());
        let c = fixtures::coefficients(3, oc.count());
        let mut out = vec![0.0; oc.count()];
        product.multiply(&a, &b, &mut out);
        let rows = product.matrix(&a);
        let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
        let by_matrix: Vec<_> = rows.chunks(ob.count()).map(|row| dot(row, &b)).collect();
        assert!(fixtures::largest_difference(&out, &by_matrix) < 1e-14);
        let quadrature = Quadrature::new(5 + 3 + 4);
        let integral =
            quadrature.integrate(|d| evaluate(&a, d) * evaluate(&b, d) * evaluate(&c, d));
        assert!((product.triple(&a, &b, &c) - integral).abs() < 1e-13);
    }

    #[test]
    fn as_large_as_the_documentation_says() {
        let product = Product::new(order(10), order(10), order(19));
        let bytes = product.entries.len() * size_of::<Entry>();
        assert!((1_150_000..1_250_000).contains(&bytes), "{bytes}");
    }
}
