//! An order of triangles in which few vertices are worked out twice.

/// Vertices that a device is taken to remember. Those that remember more do well with an order made for few, and not the other way round.
const REMEMBERED: usize = 16;

/// The indices of triangles in an order that keeps neighbours together: fan after fan around vertices that are still remembered
/// [sander2007]. Vertices keep their places.
pub fn by_neighbours(triangles: &[[u32; 3]], vertices: usize) -> Vec<usize> {
    let around = Around::new(triangles, vertices);
    let mut walk = Walk {
        left: (0..vertices).map(|v| around.of(v).len()).collect(),
        seen: vec![0; vertices],
        now: REMEMBERED + 1,
        passed: Vec::new(),
        fresh: 0,
    };
    let mut done = vec![false; triangles.len()];
    let mut order = Vec::with_capacity(triangles.len());
    let mut center = walk.next(&[]);
    while let Some(vertex) = center {
        let first = walk.passed.len();
        for &triangle in around.of(vertex) {
            if !std::mem::replace(&mut done[triangle as usize], true) {
                order.push(triangle as usize);
                walk.pass(triangles[triangle as usize]);
            }
        }
        let fan = walk.passed[first..].to_vec();
        center = walk.next(&fan);
    }
    order
}

/// The triangles around each vertex.
struct Around {
    first: Vec<usize>,
    triangles: Vec<u32>,
}

impl Around {
    fn new(triangles: &[[u32; 3]], vertices: usize) -> Self {
        // Count, add up, and fill from the back, which leaves each count where its list begins.
        let mut first = vec![0; vertices + 1];
        for &vertex in triangles.as_flattened() {
            first[vertex as usize] += 1;
        }
        let mut end = 0;
        for count in &mut first {
            end += *count;
            *count = end;
        }
        let mut lists = vec![0; end];
        for (triangle, corners) in (0..triangles.len() as u32).zip(triangles).rev() {
            for &vertex in corners {
                first[vertex as usize] -= 1;
                lists[first[vertex as usize]] = triangle;
            }
        }
        Self {
            first,
            triangles: lists,
        }
    }

    fn of(&self, vertex: usize) -> &[u32] {
        &self.triangles[self.first[vertex]..self.first[vertex + 1]]
    }
}

/// Where the walk has been.
struct Walk {
    /// Triangles of each vertex still to come.
    left: Vec<usize>,
    /// When each vertex was last worked out. The clock counts vertices worked out.
    seen: Vec<usize>,
    now: usize,
    /// All vertices passed, the last one last.
    passed: Vec<u32>,
    /// No vertex before this one has triangles left.
    fresh: usize,
}

impl Walk {
    fn pass(&mut self, triangle: [u32; 3]) {
        for vertex in triangle {
            self.passed.push(vertex);
            self.left[vertex as usize] -= 1;
            if self.now - self.seen[vertex as usize] > REMEMBERED {
                self.seen[vertex as usize] = self.now;
                self.now += 1;
            }
        }
    }

    /// The vertex to go round next: of `fan` the one remembered longest that will be until its triangles are done; or else the last one
    /// passed, or the next of all, that has triangles left.
    fn next(&mut self, fan: &[u32]) -> Option<usize> {
        let unfinished = |&&vertex: &&u32| self.left[vertex as usize] > 0;
        let age = |&vertex: &u32| {
            let age = self.now - self.seen[vertex as usize];
            // Each triangle left may bring two new vertices.
            let stays = age + 2 * self.left[vertex as usize] <= REMEMBERED;
            if stays { age } else { 0 }
        };
        if let Some(&vertex) = fan
            .iter()
            .filter(unfinished)
            .max_by_key(|vertex| age(vertex))
        {
            return Some(vertex as usize);
        }
        while let Some(vertex) = self.passed.pop() {
            if self.left[vertex as usize] > 0 {
                return Some(vertex as usize);
            }
        }
        let rest = &self.left[self.fresh..];
        self.fresh += rest.iter().position(|&left| left > 0)?;
        Some(self.fresh)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of `n` × `n` squares, row by row.
    fn grid(n: u32) -> (Vec<[u32; 3]>, usize) {
        let at = |x: u32, y: u32| y * (n + 1) + x;
        let squares = (0..n * n).map(|i| (i % n, i / n));
        let halves = squares.flat_map(|(x, y)| {
            let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
            [[a, b, c], [a, c, d]]
        });
        (halves.collect(), ((n + 1) * (n + 1)) as usize)
    }

    /// How many vertices a device works out that remembers the last few.
    fn worked_out(triangles: impl IntoIterator<Item = [u32; 3]>) -> usize {
        let mut remembered = std::collections::VecDeque::new();
        let mut count = 0;
        for vertex in triangles.into_iter().flatten() {
            if !remembered.contains(&vertex) {
                count += 1;
                remembered.push_back(vertex);
                if remembered.len() > REMEMBERED {
                    remembered.pop_front();
                }
            }
        }
        count
    }

    #[test]
    fn every_triangle_comes_once() {
        let (mut triangles, vertices) = grid(9);
        // Some that no order can please: corners that coincide, one that stands alone, and the same one twice.
        triangles.extend([[3, 3, 4], [5, 5, 5], [97, 98, 99], [0, 1, 11]]);
        let mut order = by_neighbours(&triangles, vertices);
        order.sort_unstable();
        assert!(order.into_iter().eq(0..triangles.len()));
        assert!(by_neighbours(&[], 7).is_empty());
    }

    #[test]
    fn neighbours_come_together() {
        let (triangles, vertices) = grid(60);
        let order = by_neighbours(&triangles, vertices);
        // By rows of more vertices than are remembered each is worked out twice. The walk comes near to half of that.
        assert!(worked_out(triangles.clone()) > 190 * vertices / 100);
        let ours = worked_out(order.into_iter().map(|t| triangles[t]));
        assert!(ours < 135 * vertices / 100, "{ours} of {vertices}");
    }
}
