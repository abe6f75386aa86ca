// The view pass: surfaces in their radiance, and what stands behind them.
// CPU twins: relume::display::render (seen), relume::scene::World::surface, relume::display::ToneMap.

// What a pipeline is made for. Being constants, what is not there costs nothing: neither a look at a texture, nor a number that travels
// from vertex to pixel, nor the early depth test, which drivers give up where a pixel may be discarded.
override ENCODING: u32;
override TEXTURED: bool;
override MASKED: bool;
override TWO_SIDED: bool;
override COLORED: bool;
// Textures are not shown, but for the holes of a mask.
override BARE: bool;

struct View {
    // From the offset of a point from the eye.
    clip_from_offset: mat4x4f,
    eye: vec3f,
    // Radiance is multiplied by this before the tone map: 0.6 · 2^exposure.
    scale: f32,
    // The middle of the picture, and half of its width and of its height, at distance 1.
    forward: vec3f,
    // What surfaces show: one of the constants below.
    surface: u32,
    right: vec3f,
    unused: u32,
    up: vec3f,
    // Texels in a row of the radiance texture: 2 to the power of this.
    width_log2: u32,
    background_from_world: mat3x3f,
}

const SHADED = 0u;
const WHITE = 1u;
const SIGNED = 2u;
const ALBEDO = 3u;

// How colours are written: scene radiance as it is; tone-mapped; tone-mapped and sRGB-encoded.
const RADIANCE = 0u;
const LINEAR = 1u;
const ENCODED = 2u;

struct Material {
    base_color: vec4f,
    // Where alpha is below it there is no surface, if the material is masked.
    cutoff: f32,
    // Only glossy surfaces read these; the last multiplies x and y of the normal map.
    metallic: f32,
    roughness: f32,
    normal_scale: f32,
    // Of a tile: texels along u and v, views along a side of the square, and periods for each step of uv.
    tile: vec4f,
}

@group(0) @binding(0) var<uniform> view: View;
@group(1) @binding(0) var radiance: texture_2d<u32>;
@group(2) @binding(0) var<uniform> material: Material;
@group(2) @binding(1) var base_color: texture_2d<f32>;
@group(2) @binding(2) var base_color_sampler: sampler;
@group(1) @binding(1) var background: texture_2d<f32>;
@group(1) @binding(2) var background_sampler: sampler;

// No back side: its radiance is 0.
const NO_SIDE = 0xffffffffu;

struct Seen {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
    @location(1) color: vec4f,
    @location(2) front: vec3f,
    @location(3) back: vec3f,
}

fn radiance_of(side: u32) -> vec3f {
    let row = side >> view.width_log2;
    let place = vec2u(side - (row << view.width_log2), row);
    let bits = textureLoad(radiance, place, 0);
    return bitcast<vec3f>(bits.rgb);
}

@vertex
fn vertex(
    @builtin(vertex_index) index: u32,
    @location(0) position: vec3f,
    @location(1) uv: vec2f,
    @location(2) color: vec4f,
    @location(3) back: u32,
) -> Seen {
    var seen: Seen;
    seen.position = view.clip_from_offset * vec4f(position - view.eye, 1.0);
    seen.uv = uv;
    seen.color = color;
    seen.front = radiance_of(index);
    seen.back = vec3f();
    if TWO_SIDED && back != NO_SIDE {
        seen.back = radiance_of(back);
    }
    return seen;
}

@fragment
fn surface(seen: Seen, @builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    var color = material.base_color;
    if COLORED {
        color *= seen.color;
    }
    if TEXTURED {
        let texel = textureSample(base_color, base_color_sampler, seen.uv);
        color *= select(texel, vec4f(1.0, 1.0, 1.0, texel.a), BARE);
    }
    if MASKED && color.a < material.cutoff {
        discard;
    }
    var transferred = select(vec3f(), seen.front, is_front);
    if TWO_SIDED {
        transferred = select(seen.back, seen.front, is_front);
    }
    if view.surface == SIGNED {
        transferred = signed_color(transferred);
    }
    let bare = view.surface == WHITE || view.surface == SIGNED;
    let albedo = select(color.rgb, vec3f(1.0), bare);
    let light = select(transferred, vec3f(1.0), view.surface == ALBEDO);
    return written(albedo * light);
}

// Lines in a colour of their own, over everything.
@fragment
fn wire() -> @location(0) vec4f {
    return written(vec3f(0.9, 0.35, 0.05) / max(view.scale, 1e-6));
}

// Luminance by its sign: warm where positive, cold where negative.
fn signed_color(value: vec3f) -> vec3f {
    let y = dot(value, vec3f(0.2126, 0.7152, 0.0722));
    return select(vec3f(0.1, 0.35, 1.0), vec3f(1.0, 0.45, 0.1), y > 0.0) * abs(y);
}

struct Behind {
    @builtin(position) position: vec4f,
    @location(0) direction: vec3f,
}

@vertex
fn behind(@builtin(vertex_index) corner: u32) -> Behind {
    let x = select(-1.0, 3.0, corner == 1u);
    let y = select(-1.0, 3.0, corner == 2u);
    var behind: Behind;
    // Depth is reversed: 0 is infinitely far.
    behind.position = vec4f(x, y, 0.0, 1.0);
    behind.direction = view.forward + x * view.right + y * view.up;
    return behind;
}

// Lat-long as OpenEXR defines it: longitude 0 is +Z at the centre, +X left of it.
@fragment
fn sky(behind: Behind) -> @location(0) vec4f {
    let d = normalize(view.background_from_world * behind.direction);
    let u = 0.5 - atan2(d.x, d.z) * 0.15915494;
    let v = 0.5 - asin(clamp(d.y, -1.0, 1.0)) * 0.31830987;
    // The first and the last row are what lies beyond the poles.
    let rows = f32(textureDimensions(background).y);
    let place = vec2f(u, (v * (rows - 2.0) + 1.0) / rows);
    return written(textureSampleLevel(background, background_sampler, place, 0.0).rgb);
}

fn written(color: vec3f) -> vec4f {
    if ENCODING == RADIANCE {
        return vec4f(color, 1.0);
    }
    let shown = tone_curve(color);
    return vec4f(select(shown, srgb_code(shown), ENCODING == ENCODED), 1.0);
}

// CPU twin: relume::display::ToneMap::curve [narkowicz2016]. Negative radiance becomes 0.
fn tone_curve(color: vec3f) -> vec3f {
    let x = clamp(color * view.scale, vec3f(), vec3f(1e6));
    return min(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), vec3f(1.0));
}

// CPU twin: relume::display::srgb_code [iec61966].
fn srgb_code(linear: vec3f) -> vec3f {
    let curve = 1.055 * pow(max(linear, vec3f(1e-9)), vec3f(1.0 / 2.4)) - 0.055;
    return select(curve, 12.92 * linear, linear <= vec3f(0.0031308));
}
