//! Points spread evenly among vertices: the quantiser of Linde, Buzo and Gray, which others place samples by [sun2005, §2.3; sloan2002].

use glam::{DVec3, Vec3};

use crate::parallel;

/// Rounds stop when the distortion falls by less than this share.
const ENOUGH: f64 = 1e-3;
/// Halves of a point are this share of the object apart.
const APART: f64 = 1e-3;

/// Points, and how far vertices are from them.
#[derive(Clone, Debug, PartialEq)]
pub struct Codebook {
    /// As many as were asked for, unless there are fewer vertices at different places.
    pub points: Vec<DVec3>,
    /// Mean square distance of a vertex to its nearest point, after each round: it falls while the number of points stays.
    pub distortions: Vec<(usize, f64)>,
}

/// At least one point, twice as many again and again until there are `count` (rounded down to a power of two), each time moved to the middle of
/// the vertices that are nearest to it until that hardly helps.
pub fn lbg(positions: &[Vec3], count: usize) -> Codebook {
    let mut book = Codebook {
        points: Vec::new(),
        distortions: Vec::new(),
    };
    if positions.is_empty() {
        return book;
    }
    let low = positions.iter().fold(Vec3::INFINITY, |a, p| a.min(*p));
    let high = positions.iter().fold(Vec3::NEG_INFINITY, |a, p| a.max(*p));
    let step = (high - low).as_dvec3() * APART;
    let sum: DVec3 = positions.iter().map(|p| p.as_dvec3()).sum();
    book.points.push(sum / positions.len() as f64);
    while 2 * book.points.len() <= count {
        let halves = book.points.iter().flat_map(|&p| [p - step, p + step]);
        book.points = halves.collect();
        let mut before = f64::INFINITY;
        loop {
            let distortion = round(positions, &mut book.points);
            book.distortions.push((book.points.len(), distortion));
            if distortion >= before * (1.0 - ENOUGH) {
                break;
            }
            before = distortion;
        }
    }
    book
}

/// Moves each point to the middle of its vertices (one without any to the vertex farthest from its point), and gives the mean square distance before.
fn round(positions: &[Vec3], points: &mut [DVec3]) -> f64 {
    let nearest = parallel::map(positions.len(), |i| {
        let at = positions[i].as_dvec3();
        let squares = points.iter().map(|p| p.distance_squared(at)).enumerate();
        squares
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or_default()
    });
    let mut sums = vec![(DVec3::ZERO, 0_u32); points.len()];
    for (position, &(point, _)) in positions.iter().zip(&nearest) {
        sums[point].0 += position.as_dvec3();
        sums[point].1 += 1;
    }
    let mut far: Vec<usize> = (0..positions.len()).collect();
    if sums.iter().any(|(_, count)| *count == 0) {
        far.sort_by(|&a, &b| nearest[b].1.total_cmp(&nearest[a].1));
    }
    let mut far = far.into_iter();
    for (point, (sum, count)) in points.iter_mut().zip(sums) {
        *point = match count {
            0 => far.next().map_or(*point, |v| positions[v].as_dvec3()),
            _ => sum / f64::from(count),
        };
    }
    nearest.iter().map(|(_, square)| square).sum::<f64>() / positions.len() as f64
}
