// The relight pass: one fragment per side of a surface, radiance without albedo. Run when the light changes.
// CPU twin: relume::shade::transferred_radiance.
//
// The target holds the bits of floats in unsigned integers: every back end draws to those, and not every one to floats.
//
// A side is the front of a vertex, or the back of one on a double-sided surface. Side i lies at texel (i % width, i / width) of the
// radiance texture. Its transfer vectors, cut into quads of four coefficients, lie below one another in a page: `channels` × `quads`
// texels, from row (row of the side − first row of the page) × channels × quads.

struct Page {
    first_row: u32,
    channels: u32,
    quads: u32,
    unused: u32,
}

// Coefficients of light, quad by quad: all of red, then green, then blue. 256 quads are order 32.
struct DistantLight {
    quads: array<vec4f, 768>,
}

@group(0) @binding(0) var<uniform> page: Page;
@group(0) @binding(1) var transfer: texture_2d<f32>;
// One of: light for all; light in rows, one per object, and the row of each side; a page of light.
@group(1) @binding(0) var<uniform> distant: DistantLight;
@group(1) @binding(1) var light: texture_2d<f32>;
@group(1) @binding(2) var objects: texture_2d<u32>;

// A triangle that covers the viewport.
@vertex
fn cover(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4f {
    let x = select(-1.0, 3.0, corner == 1u);
    let y = select(-1.0, 3.0, corner == 2u);
    return vec4f(x, y, 0.0, 1.0);
}

// What four coefficients of a side's transfer make of four of light.
fn response(place: vec2u, quad: u32, red: vec4f, green: vec4f, blue: vec4f) -> vec3f {
    let row = (place.y - page.first_row) * page.channels * page.quads + quad;
    let first = textureLoad(transfer, vec2u(place.x, row), 0);
    if page.channels == 1u {
        return vec3f(dot(first, red), dot(first, green), dot(first, blue));
    }
    let second = textureLoad(transfer, vec2u(place.x, row + page.quads), 0);
    let third = textureLoad(transfer, vec2u(place.x, row + 2u * page.quads), 0);
    return vec3f(dot(first, red), dot(second, green), dot(third, blue));
}

@fragment
fn relight_distant(@builtin(position) at: vec4f) -> @location(0) vec4u {
    let place = vec2u(at.xy);
    var sum = vec3f();
    for (var quad = 0u; quad < page.quads; quad++) {
        let red = distant.quads[quad];
        let green = distant.quads[page.quads + quad];
        let blue = distant.quads[2u * page.quads + quad];
        sum += response(place, quad, red, green, blue);
    }
    return bitcast<vec4u>(vec4f(sum, 1.0));
}

@fragment
fn relight_objects(@builtin(position) at: vec4f) -> @location(0) vec4u {
    let place = vec2u(at.xy);
    let object = textureLoad(objects, place, 0).x;
    var sum = vec3f();
    for (var quad = 0u; quad < page.quads; quad++) {
        let red = textureLoad(light, vec2u(quad, object), 0);
        let green = textureLoad(light, vec2u(page.quads + quad, object), 0);
        let blue = textureLoad(light, vec2u(2u * page.quads + quad, object), 0);
        sum += response(place, quad, red, green, blue);
    }
    return bitcast<vec4u>(vec4f(sum, 1.0));
}

@fragment
fn relight_vertices(@builtin(position) at: vec4f) -> @location(0) vec4u {
    let place = vec2u(at.xy);
    let first = (place.y - page.first_row) * 3u * page.quads;
    var sum = vec3f();
    for (var quad = 0u; quad < page.quads; quad++) {
        let red = textureLoad(light, vec2u(place.x, first + quad), 0);
        let green = textureLoad(light, vec2u(place.x, first + page.quads + quad), 0);
        let blue = textureLoad(light, vec2u(place.x, first + 2u * page.quads + quad), 0);
        sum += response(place, quad, red, green, blue);
    }
    return bitcast<vec4u>(vec4f(sum, 1.0));
}
