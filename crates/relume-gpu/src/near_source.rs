//! What near.wgsl does with harmonics, written out for one order: loops over arrays of harmonics would keep them in memory, and lines for each stay in registers.

use std::fmt::Write;

use relume::basis::{Order, PolygonHarmonics, gauss_legendre, index};
use relume::light::emitter::ExactParts;

use crate::pipelines::RELIGHT;

/// Faces and their geometry, of any order.
const NEAR: &str = include_str!("shaders/near.wgsl");

/// The relight pass with near faces, for transfer of an order and so many channels.
pub fn source(order: Order, channels: usize) -> String {
    let n = order.get();
    let response = if channels == 1 { "f32" } else { "vec3f" };
    // The loops of by_edge reach two degrees less.
    let solids = place(n.saturating_sub(2), 0).max(1);
    let gauss = gauss_legendre(ExactParts::points(order));
    let of = |number: fn(&(f64, f64)) -> f64| {
        let numbers = gauss
            .iter()
            .map(|node| format!("{:?}f", number(node) as f32));
        numbers.collect::<Vec<_>>().join(", ")
    };
    format!(
        "{RELIGHT}\n{NEAR}\n\
        // Written by near_source: harmonics of order {n}. R_l^m and the steps are those of relume::basis::PolygonHarmonics.\n\
        const SMALL = {small:?};\n\
        // Of Gauss points on 0…1.\n\
        const POINTS = {points}u;\n\
        const NODES = array<f32, POINTS>({nodes});\n\
        const WEIGHTS = array<f32, POINTS>({weights});\n\
        // To a light of one channel.\n\
        alias Response = {response};\n\
        // R_l^m at l(l+1)/2 + m.\n\
        alias Solid = array<vec2f, {solids}>;\n\
        // The side's transfer, times the factors from R_l^m to the basis.\n\
        var<private> vector: array<Response, {count}>;\n\
        {MULTIPLY}{load}{solid}{toward}{edge}",
        points = gauss.len(),
        nodes = of(|&(x, _)| 0.5 + 0.5 * x),
        weights = of(|&(_, w)| 0.5 * w),
        small = ExactParts::SMALL,
        count = order.count(),
        load = load_vector(order, channels),
        solid = solid_harmonics(n.saturating_sub(2).max(1), solids),
        toward = toward(n),
        edge = by_edge(n),
    )
}

/// Half of (x ± iy) v, as derivatives and harmonics of one more m and one less take it.
const MULTIPLY: &str = "\
fn lower(d: vec3f, v: vec2f) -> vec2f { return 0.5 * vec2f(d.x * v.x - d.y * v.y, d.x * v.y + d.y * v.x); }\n\
fn upper(d: vec3f, v: vec2f) -> vec2f { return -0.5 * vec2f(d.x * v.x + d.y * v.y, d.x * v.y - d.y * v.x); }\n";

const fn place(l: usize, m: usize) -> usize {
    l * (l + 1) / 2 + m
}

/// A line of the shader. Writing to a string does not fail.
macro_rules! line {
    ($code:expr, $($text:tt)*) => { let _ = writeln!($code, $($text)*); };
}

fn load_vector(order: Order, channels: usize) -> String {
    let mut code = "fn load_vector(place: vec2u) {\n".to_owned();
    for quad in 0..order.count().div_ceil(4) {
        for channel in 0..channels {
            line!(
                code,
                "let t_{channel}_{quad} = textureLoad(transfer, texel(place, TEXELS, {channel}u * QUADS + {quad}u), 0);"
            );
        }
    }
    let harmonics = PolygonHarmonics::new(order);
    for l in 0..order.get() {
        for m in -(l as isize)..=l as isize {
            let scale = harmonics.scales()[place(l, m.unsigned_abs())] as f32;
            let i = index(l, m);
            let of =
                |channel: usize| format!("t_{channel}_{}.{}", i / 4, ["x", "y", "z", "w"][i % 4]);
            let value = match channels {
                1 => of(0),
                _ => format!("vec3f({}, {}, {})", of(0), of(1), of(2)),
            };
            line!(code, "vector[{i}] = {scale:?} * {value};");
        }
    }
    code + "}\n"
}

/// `let`s of R_l^m toward the unit vector d, for l < n.
fn harmonics(n: usize) -> String {
    let mut code = "let r_0_0 = vec2f(1.0, 0.0);\n".to_owned();
    for m in 0..n {
        if m > 0 {
            let (below, share) = (m - 1, 1.0 / m as f32);
            line!(
                code,
                "let r_{m}_{m} = {share:?} * lower(d, r_{below}_{below});"
            );
        }
        for l in m + 1..n {
            let (step, share) = ((2 * l - 1) as f32, 1.0 / ((l + m) * (l - m)) as f32);
            let before = if l > m + 1 {
                format!(" - r_{}_{m}", l - 2)
            } else {
                String::new()
            };
            line!(
                code,
                "let r_{l}_{m} = {share:?} * ({step:?} * d.z * r_{}_{m}{before});",
                l - 1
            );
        }
    }
    code
}

fn solid_harmonics(n: usize, solids: usize) -> String {
    let places = (0..n).flat_map(|l| (0..=l).map(move |m| format!("r_{l}_{m}")));
    let places: Vec<String> = places.take(solids).collect();
    let harmonics = harmonics(n);
    let all = places.join(", ");
    format!("fn solid_harmonics(d: vec3f) -> Solid {{\n{harmonics}return Solid({all});\n}}\n")
}

/// A degree's terms of the product of the transfer and the complex numbers `{name}_{l}_{m}`.
fn product(name: &str, l: usize) -> String {
    let term = |m: usize| {
        let value = format!("{name}_{l}_{m}");
        let (cosine, sine) = (index(l, m as isize), index(l, -(m as isize)));
        match m {
            0 => format!("vector[{cosine}] * {value}.x"),
            _ => format!("vector[{cosine}] * {value}.x + vector[{sine}] * {value}.y"),
        }
    };
    (0..=l).map(term).collect::<Vec<_>>().join(" + ")
}

fn toward(n: usize) -> String {
    let mut code = "// The basis toward the unit vector d, times the transfer.\nfn toward(d: vec3f) -> Response {\n".to_owned();
    code += &harmonics(n);
    line!(code, "var sum = {};", product("r", 0));
    for l in 1..n {
        line!(code, "sum += {};", product("r", l));
    }
    code + "return sum;\n}\n"
}

/// `(d·∇) R_l^m`, from values of degree l−1.
fn derivative(d: &str, below: impl Fn(usize) -> String, l: usize, m: usize) -> String {
    if m == 0 {
        let up = if l > 1 {
            format!(" - dot({d}.xy, {})", below(1))
        } else {
            String::new()
        };
        return format!("vec2f({d}.z * {}.x{up}, 0.0)", below(0));
    }
    let mut terms = vec![format!("lower({d}, {})", below(m - 1))];
    if m < l {
        terms.push(format!("{d}.z * {}", below(m)));
    }
    if m + 1 < l {
        terms.push(format!("upper({d}, {})", below(m + 1)));
    }
    terms.join(" + ")
}

/// `Σ T_lm N_l G_l` of an edge, as `relume::basis::polygon` has them.
fn by_edge(n: usize) -> String {
    let mut code = "// What the transfer makes of an edge: its angle, its inward normal, the tangents at its ends, and R_l^m there.\n\
        fn by_edge(angle: f32, inward: vec3f, a: vec3f, b: vec3f, a_solid: Solid, b_solid: Solid) -> Response {\n\
        let arc_0_0 = vec2f(angle, 0.0);\n\
        var sum = Response();\n"
        .to_owned();
    for l in 1..n {
        for m in 0..=l {
            let g = derivative("inward", |m| format!("arc_{}_{m}", l - 1), l, m);
            line!(code, "let g_{l}_{m} = {g};");
        }
        let share = 1.0 / (l * (l + 1)) as f32;
        line!(code, "sum += {share:?} * ({});", product("g", l));
        for m in (0..=l).filter(|_| l + 1 < n) {
            let end = |name: &str| {
                let of = |m: usize| format!("{name}_solid[{}]", place(l - 1, m));
                derivative(name, of, l, m)
            };
            // G_0 is nothing.
            let down = match l {
                1 => String::new(),
                _ => format!(
                    " - ({})",
                    derivative("inward", |m| format!("g_{}_{m}", l - 1), l, m)
                ),
            };
            let share = 1.0 / (l * l) as f32;
            line!(
                code,
                "let arc_{l}_{m} = {share:?} * ({} - ({}){down});",
                end("a"),
                end("b")
            );
        }
    }
    code + "return sum;\n}\n"
}
