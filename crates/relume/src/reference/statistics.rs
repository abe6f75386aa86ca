//! Means, their errors, and quantiles.

/// Mean and standard error of the mean of a sample of at least two.
pub fn mean_and_standard_error(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    let squares: f64 = values.map(|x| (x - mean) * (x - mean)).sum();
    (mean, (squares / (count * (count - 1.0))).sqrt())
}

/// The two-sided 95 % quantile of Student's t with `freedom` degrees of freedom (Cornish–Fisher, [abramowitz1964] 26.7.5).
///
/// Off by less than 0.002 for 6 degrees or more, and 0.01 for 4.
pub fn student_95(freedom: f64) -> f64 {
    let z = 1.959_963_984_540_054_f64;
    let (z3, z5, z7) = (z.powi(3), z.powi(5), z.powi(7));
    let g1 = (z3 + z) / 4.0;
    let g2 = (5.0 * z5 + 16.0 * z3 + 3.0 * z) / 96.0;
    let g3 = (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / 384.0;
    z + g1 / freedom + g2 / freedom.powi(2) + g3 / freedom.powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_standard_error_is_the_scatter_over_the_root_of_the_count() {
        let (mean, error) = mean_and_standard_error([1.0, 2.0, 3.0, 4.0].into_iter());
        assert_eq!(mean, 2.5);
        // Sample variance 5/3.
        assert!((error - (5.0_f64 / 3.0 / 4.0).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn student_quantiles_agree_with_the_table() {
        for (freedom, table) in [
            (7.0, 2.3646),
            (10.0, 2.2281),
            (30.0, 2.0423),
            (399.0, 1.9659),
        ] {
            let t = student_95(freedom);
            assert!((t - table).abs() < 1e-3, "{freedom}: {t} for {table}");
        }
    }
}
