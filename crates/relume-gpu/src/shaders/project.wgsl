// Coefficients of what cube.wgsl has drawn, in two steps: of each row of pixels of the six faces, and of all rows of a point.
// CPU twin: relume::light::emitter::CubeMap.
//
// Of each point there are 3 · QUADS + 1 texels: four coefficients of red, of green, of blue, then the next four; last (solid angle, ∫ 1/distance, 0, 0). All targets
// hold the bits of floats.

override QUADS: u32;
// Pixels along the side of a face.
override SIZE: u32;

@group(0) @binding(0) var atlas: texture_2d<u32>;
// Y_i times the solid angle of each pixel of the six faces, four i at a time: quad after quad downward.
@group(0) @binding(1) var basis: texture_2d<f32>;
// What the first step has made.
@group(0) @binding(2) var rows: texture_2d<u32>;

// A triangle that covers the viewport.
@vertex
fn cover(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4f {
    let x = select(-1.0, 3.0, corner == 1u);
    let y = select(-1.0, 3.0, corner == 2u);
    return vec4f(x, y, 0.0, 1.0);
}

// Y_0.
const CONSTANT = 0.28209479;

// A row of pixels.
@fragment
fn project_row(@builtin(position) at: vec4f) -> @location(0) vec4u {
    let place = vec2u(at.xy);
    let quad = place.x / 3u;
    let channel = place.x - 3u * quad;
    let row = place.y % SIZE;
    var sum = vec4f();
    for (var x = 0u; x < 6u * SIZE; x++) {
        let seen = bitcast<vec4f>(textureLoad(atlas, vec2u(x, place.y), 0));
        if seen.w == 0.0 {
            continue;
        }
        if quad < QUADS {
            let radiance = select(select(seen.x, seen.y, channel == 1u), seen.z, channel == 2u);
            sum += radiance * textureLoad(basis, vec2u(x, quad * SIZE + row), 0);
        } else {
            let solid_angle = textureLoad(basis, vec2u(x, row), 0).x / CONSTANT;
            sum += solid_angle * vec4f(1.0, 1.0 / seen.w, 0.0, 0.0);
        }
    }
    return bitcast<vec4u>(sum);
}

// A point.
@fragment
fn add_rows(@builtin(position) at: vec4f) -> @location(0) vec4u {
    let place = vec2u(at.xy);
    var sum = vec4f();
    for (var row = 0u; row < SIZE; row++) {
        sum += bitcast<vec4f>(textureLoad(rows, vec2u(place.x, place.y * SIZE + row), 0));
    }
    return bitcast<vec4u>(sum);
}
