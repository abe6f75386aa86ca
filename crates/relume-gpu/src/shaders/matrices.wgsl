// The relight pass of transfer matrices: one fragment for four coefficients of transferred radiance. Run when the light changes.
// CPU twin: relume::shade::TransferredRadiance.
//
// The target holds the bits of floats, as in relight.wgsl. A row of it holds `across` sides, each of which takes 3 · QUADS texels: four
// coefficients of red, of green, of blue, then the next four. The matrices behind them lie in a page, one after another: a texel is four rows of
// one column. Four blocks take turns, so that what is read together lies together.

// What a pipeline is made for.
override CHANNELS: u32;
override COLUMNS: u32;
override QUADS: u32;
override LIGHT_QUADS: u32 = (COLUMNS + 3u) / 4u;

struct MatrixPage {
    first_row: u32,
    across: u32,
    width_log2: u32,
    // Of the texture with the object of each side.
    objects_log2: u32,
}

// As in relight.wgsl.
struct DistantLight {
    quads: array<vec4f, 768>,
}

@group(0) @binding(0) var<uniform> page: MatrixPage;
@group(0) @binding(1) var matrices: texture_2d<f32>;
// One of: light for all; light in rows, one per object, and the row of each side; a page of light.
@group(1) @binding(0) var<uniform> distant: DistantLight;
@group(1) @binding(1) var light: texture_2d<f32>;
@group(1) @binding(2) var objects: texture_2d<u32>;
// Light of near emitters: a page like that of light by vertex.
@group(2) @binding(1) var near_light: texture_2d<f32>;

// A triangle that covers the viewport.
@vertex
fn cover(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4f {
    let x = select(-1.0, 3.0, corner == 1u);
    let y = select(-1.0, 3.0, corner == 2u);
    return vec4f(x, y, 0.0, 1.0);
}

struct Block {
    // Within the page.
    side: u32,
    channel: u32,
    // The texel of its first column.
    first: u32,
}

fn block_at(at: vec4f) -> Block {
    let place = vec2u(at.xy);
    let number = place.x / (3u * QUADS);
    let texel = place.x - number * 3u * QUADS;
    let side = (place.y - page.first_row) * page.across + number;
    let quad = texel / 3u;
    let channel = texel - quad * 3u;
    let block = (side * QUADS + quad) * CHANNELS + select(0u, channel, CHANNELS == 3u);
    return Block(side, channel, (block >> 2u) * COLUMNS * 4u + (block & 3u));
}

fn texel(along: u32) -> vec2u {
    let row = along >> page.width_log2;
    return vec2u(along - (row << page.width_log2), row);
}

// Four columns times four coefficients of light. The last column of an odd order stands alone.
fn response(block: Block, quad: u32, light: vec4f) -> vec4f {
    let first = block.first + 16u * quad;
    let sum = light.x * textureLoad(matrices, texel(first), 0);
    if 4u * quad + 1u == COLUMNS {
        return sum;
    }
    return sum
        + light.y * textureLoad(matrices, texel(first + 4u), 0)
        + light.z * textureLoad(matrices, texel(first + 8u), 0)
        + light.w * textureLoad(matrices, texel(first + 12u), 0);
}

fn distant_sum(block: Block) -> vec4f {
    var sum = vec4f();
    for (var quad = 0u; quad < LIGHT_QUADS; quad++) {
        sum += response(block, quad, distant.quads[block.channel * LIGHT_QUADS + quad]);
    }
    return sum;
}

fn objects_sum(block: Block) -> vec4f {
    let side = block.side + page.first_row * page.across;
    let row = side >> page.objects_log2;
    let object = textureLoad(objects, vec2u(side - (row << page.objects_log2), row), 0).x;
    var sum = vec4f();
    for (var quad = 0u; quad < LIGHT_QUADS; quad++) {
        let place = vec2u(block.channel * LIGHT_QUADS + quad, object);
        sum += response(block, quad, textureLoad(light, place, 0));
    }
    return sum;
}

// Of a page of light.
fn vertices_sum(block: Block, lights: texture_2d<f32>) -> vec4f {
    let first = (block.side * 3u + block.channel) * LIGHT_QUADS;
    var sum = vec4f();
    for (var quad = 0u; quad < LIGHT_QUADS; quad++) {
        sum += response(block, quad, textureLoad(lights, texel(first + quad), 0));
    }
    return sum;
}

@fragment
fn relight_distant(@builtin(position) at: vec4f) -> @location(0) vec4u {
    return bitcast<vec4u>(distant_sum(block_at(at)));
}

@fragment
fn relight_objects(@builtin(position) at: vec4f) -> @location(0) vec4u {
    return bitcast<vec4u>(objects_sum(block_at(at)));
}

@fragment
fn relight_vertices(@builtin(position) at: vec4f) -> @location(0) vec4u {
    return bitcast<vec4u>(vertices_sum(block_at(at), light));
}

// And of near emitters, at every vertex.

@fragment
fn near_distant(@builtin(position) at: vec4f) -> @location(0) vec4u {
    let block = block_at(at);
    return bitcast<vec4u>(distant_sum(block) + vertices_sum(block, near_light));
}

@fragment
fn near_objects(@builtin(position) at: vec4f) -> @location(0) vec4u {
    let block = block_at(at);
    return bitcast<vec4u>(objects_sum(block) + vertices_sum(block, near_light));
}

@fragment
fn near_vertices(@builtin(position) at: vec4f) -> @location(0) vec4u {
    let block = block_at(at);
    return bitcast<vec4u>(vertices_sum(block, light) + vertices_sum(block, near_light));
}
