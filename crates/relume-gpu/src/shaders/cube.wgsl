// Emitters as points see them: six faces of a cube map for each point, side by side in a row of an atlas.
// CPU twin: relume::light::emitter::CubeMap (and Placed::first_hit).
//
// The target holds the bits of floats: radiance toward the point, and the distance; 0 where nothing is seen, or a black back. Depth is that of the emitter along
// the pixel's own ray, not the rasteriser's, whose precision depends on where a near plane stands.

// Pixels along the side of a face.
override SIZE: f32;

// A texel for each point, one below the other; relative to the emitters' middle, as all here.
@group(0) @binding(0) var points: texture_2d<f32>;

struct Seen {
    @builtin(position) position: vec4f,
    // Exact at corners and linear between, in space.
    @location(0) radiance: vec3f,
    // To a corner, or a sphere's middle.
    @location(1) @interpolate(flat) offset: vec3f,
    // Of a face, unit; (radius, 0, 0) of a sphere.
    @location(2) @interpolate(flat) normal: vec3f,
    // 1 where both sides shine, and the power of the cosine.
    @location(3) @interpolate(flat) traits: vec2f,
    @location(4) @interpolate(flat) face: u32,
}

struct Drawn {
    @location(0) bits: vec4u,
    @builtin(frag_depth) depth: f32,
}

// Nearest depth of reversed depth: 1 at 2⁻⁶⁰ m.
const NEAREST = 8.673617e-19;

// Along x, y and z of the face's picture: +x is (y, z; x), −x is (y, z; −x), and so on around.
fn on_face(face: u32, v: vec3f) -> vec3f {
    let axis = face >> 1u;
    let turned = select(select(v.xyz, v.yzx, axis == 1u), v.zxy, axis == 2u);
    return vec3f(turned.yz, select(turned.x, -turned.x, (face & 1u) == 1u));
}

fn from_face(face: u32, v: vec3f) -> vec3f {
    let turned = vec3f(select(v.z, -v.z, (face & 1u) == 1u), v.xy);
    let axis = face >> 1u;
    return select(select(turned.xyz, turned.zxy, axis == 1u), turned.yzx, axis == 2u);
}

// The unit vector through the middle of a pixel.
fn toward(face: u32, position: vec4f) -> vec3f {
    let within = position.xy - floor(position.xy / SIZE) * SIZE;
    let middle = 2.0 * within / SIZE - 1.0;
    return normalize(from_face(face, vec3f(middle.x, -middle.y, 1.0)));
}

struct Corner {
    @location(0) place: vec3f,
    @location(1) normal: vec3f,
    @location(2) radiance: vec3f,
    @location(3) traits: vec2f,
}

fn offset_of(instance: u32, place: vec3f) -> vec3f {
    return place - textureLoad(points, vec2u(0u, instance / 6u), 0).xyz;
}

@vertex
fn face(corner: Corner, @builtin(instance_index) instance: u32) -> Seen {
    let offset = offset_of(instance, corner.place);
    let face = instance % 6u;
    let v = on_face(face, offset);
    // In the middle of the depth range: only what is behind the point is clipped.
    let position = vec4f(v.xy, 0.5 * v.z, v.z);
    return Seen(position, corner.radiance, offset, corner.normal, corner.traits, face);
}

// All of the picture; the sphere is found at every pixel.
@vertex
fn sphere(
    corner: Corner,
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
) -> Seen {
    let number = vertex % 3u;
    let x = select(-1.0, 3.0, number == 1u);
    let y = select(-1.0, 3.0, number == 2u);
    let offset = offset_of(instance, corner.place);
    let position = vec4f(x, y, 0.5, 1.0);
    return Seen(position, corner.radiance, offset, corner.normal, corner.traits, instance % 6u);
}

fn drawn(radiance: vec3f, distance: f32, is_back: bool) -> Drawn {
    let depth = min(NEAREST / distance, 1.0);
    let seen = select(vec4f(radiance, distance), vec4f(), is_back);
    return Drawn(bitcast<vec4u>(seen), depth);
}

@fragment
fn seen_face(seen: Seen) -> Drawn {
    let direction = toward(seen.face, seen.position);
    let cosine = dot(seen.normal, direction);
    let distance = dot(seen.normal, seen.offset) / cosine;
    // Nothing is in a point's own plane.
    if !(distance > 0.0) || cosine == 0.0 {
        discard;
    }
    var radiance = seen.radiance;
    for (var i = 0.0; i < seen.traits.y; i += 1.0) {
        radiance *= abs(cosine);
    }
    return drawn(radiance, distance, cosine > 0.0 && seen.traits.x < 0.5);
}

@fragment
fn seen_sphere(seen: Seen) -> Drawn {
    let direction = toward(seen.face, seen.position);
    let middle = dot(seen.offset, direction);
    let across = seen.offset - direction * middle;
    let radius = seen.normal.x;
    let square = radius * radius - dot(across, across);
    if square < 0.0 {
        discard;
    }
    let half = sqrt(square);
    let is_outside = middle - half > 0.0;
    let distance = middle + select(half, -half, is_outside);
    if distance <= 0.0 {
        discard;
    }
    return drawn(seen.radiance, distance, !is_outside && seen.traits.x < 0.5);
}
