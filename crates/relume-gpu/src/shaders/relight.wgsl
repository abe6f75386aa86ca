// The relight pass: one fragment per side of a surface, radiance without albedo. Run when the light changes.
// CPU twin: relume::shade::transferred_radiance.
//
// The target holds the bits of floats in unsigned integers: every back end draws to those, and not every one to floats.
//
// A side is the front of a vertex, or the back of one on a double-sided surface. Side i lies at texel (i % width, i / width) of the radiance
// texture, and width is a power of two. Its transfer vectors, cut into quads of four coefficients, are `CHANNELS` × `QUADS` texels of a page. Four
// neighbours take turns: the first quad of each, the second of each, and so on, so that what is read together lies together, and
// what is read next lies next to it. Groups of four follow one another along the page's rows, which are as wide as those of the radiance
// texture: a row of sides takes `CHANNELS` × `QUADS` rows.

// What a pipeline is made for. Loops over a number known beforehand are unrolled, and light is read from fixed places.
override CHANNELS: u32;
override QUADS: u32;
override TEXELS: u32 = CHANNELS * QUADS;

struct Page {
    // Of sides.
    first_row: u32,
    width_log2: u32,
    unused: vec2u,
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

// Where a quad of a side lies in a page with so many texels to a side.
fn texel(place: vec2u, texels: u32, quad: u32) -> vec2u {
    let along = ((place.x >> 2u) * texels + quad) * 4u + (place.x & 3u);
    let row = along >> page.width_log2;
    let top = (place.y - page.first_row) * texels;
    return vec2u(along - (row << page.width_log2), top + row);
}

// What four coefficients of a side's transfer make of four of light.
fn response(place: vec2u, quad: u32, red: vec4f, green: vec4f, blue: vec4f) -> vec3f {
    let first = textureLoad(transfer, texel(place, TEXELS, quad), 0);
    if CHANNELS == 1u {
        return vec3f(dot(first, red), dot(first, green), dot(first, blue));
    }
    let second = textureLoad(transfer, texel(place, TEXELS, QUADS + quad), 0);
    let third = textureLoad(transfer, texel(place, TEXELS, 2u * QUADS + quad), 0);
    return vec3f(dot(first, red), dot(second, green), dot(third, blue));
}

fn distant_sum(place: vec2u) -> vec3f {
    var sum = vec3f();
    for (var quad = 0u; quad < QUADS; quad++) {
        let red = distant.quads[quad];
        let green = distant.quads[QUADS + quad];
        let blue = distant.quads[2u * QUADS + quad];
        sum += response(place, quad, red, green, blue);
    }
    return sum;
}

fn objects_sum(place: vec2u) -> vec3f {
    let object = textureLoad(objects, place, 0).x;
    var sum = vec3f();
    for (var quad = 0u; quad < QUADS; quad++) {
        let red = textureLoad(light, vec2u(quad, object), 0);
        let green = textureLoad(light, vec2u(QUADS + quad, object), 0);
        let blue = textureLoad(light, vec2u(2u * QUADS + quad, object), 0);
        sum += response(place, quad, red, green, blue);
    }
    return sum;
}

// Of a page of light.
fn vertices_sum(place: vec2u, lights: texture_2d<f32>) -> vec3f {
    var sum = vec3f();
    for (var quad = 0u; quad < QUADS; quad++) {
        let red = textureLoad(lights, texel(place, 3u * QUADS, quad), 0);
        let green = textureLoad(lights, texel(place, 3u * QUADS, QUADS + quad), 0);
        let blue = textureLoad(lights, texel(place, 3u * QUADS, 2u * QUADS + quad), 0);
        sum += response(place, quad, red, green, blue);
    }
    return sum;
}

fn bits(radiance: vec3f) -> vec4u {
    return bitcast<vec4u>(vec4f(radiance, 1.0));
}

@fragment
fn relight_distant(@builtin(position) at: vec4f) -> @location(0) vec4u {
    return bits(distant_sum(vec2u(at.xy)));
}

@fragment
fn relight_objects(@builtin(position) at: vec4f) -> @location(0) vec4u {
    return bits(objects_sum(vec2u(at.xy)));
}

@fragment
fn relight_vertices(@builtin(position) at: vec4f) -> @location(0) vec4u {
    return bits(vertices_sum(vec2u(at.xy), light));
}
