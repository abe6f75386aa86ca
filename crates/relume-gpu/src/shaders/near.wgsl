// Exact light of near faces, added to what relight.wgsl gives: stands behind it in one module, and before what `near_source` writes for an order.
// CPU twin: relume::light::emitter::light_at_vertices, fused with the response of the side: integrals of a face are multiplied by the side's transfer where they
// are found, so no light is stored.

// Whether a page of light holds what is left to the CPU.
override REST: bool;

// Where each side stands, at the texel of its radiance; relative to the scene's middle, as all here.
@group(2) @binding(0) var positions: texture_2d<f32>;
@group(2) @binding(1) var rest: texture_2d<f32>;
// One row after another: (number of faces, log2 of the row's texels, 0, 0); of each face (normal, radius), (centre, 1 where both sides shine), (radiance, number of
// corners), then its corners.
@group(2) @binding(2) var faces: texture_2d<f32>;

var<private> faces_log2: u32;

fn face_texel(i: u32) -> vec4f {
    let row = i >> faces_log2;
    return textureLoad(faces, vec2u(i - (row << faces_log2), row), 0);
}

// The angle of (x, y) for y ≥ 0: 0…π, within 2e-7. 0 for (0, 0). WGSL's own may be 4096 roundings off.
fn angle_of(y: f32, x: f32) -> f32 {
    let long = abs(x);
    let tangent = min(long, y) / max(max(long, y), 1.1754944e-38);
    // Above tan π/8: π/4 + atan (t − 1)/(t + 1).
    let large = tangent > 0.41421357;
    let t = select(tangent, (tangent - 1.0) / (tangent + 1.0), large);
    let z = t * t;
    let series = (((-0.06083453 * z + 0.10596001) * z - 0.14243849) * z + 0.1999849) * z - 0.33333316;
    let first = select(0.0, 0.7853982, large) + (t + t * z * series);
    let angle = select(first, 1.5707964 - first, y > long);
    return select(angle, 3.1415927 - angle, x < 0.0);
}

// Solid angle of the triangle between unit vectors, negative where they go clockwise.
fn triangle_angle(a: vec3f, b: vec3f, c: vec3f) -> f32 {
    let volume = dot(a, cross(c, b));
    let half = angle_of(abs(volume), 1.0 + dot(a, b) + dot(b, c) + dot(c, a));
    return select(2.0, -2.0, volume < 0.0) * half;
}

fn unit(a: vec3f) -> vec3f {
    return a / max(sqrt(dot(a, a)), 1e-30);
}

// By the face's edges: for a face of which edges do not cancel.
fn by_edges(first: u32, corners: u32, at: vec3f) -> Response {
    let start = unit(face_texel(first).xyz - at);
    var a = start;
    var a_solid = solid_harmonics(a);
    var solid_angle = 0.0;
    var sum = Response();
    for (var k = 1u; k <= corners; k++) {
        let closes = k == corners;
        let b = unit(face_texel(first + select(k, 0u, closes)).xyz - at);
        let b_solid = solid_harmonics(b);
        if k > 1u && !closes {
            solid_angle += triangle_angle(start, a, b);
        }
        let across = cross(b, a);
        let sine = sqrt(dot(across, across));
        let inward = across / max(sine, 1e-30);
        let angle = angle_of(sine, dot(a, b));
        sum += by_edge(angle, inward, cross(a, inward), cross(b, inward), a_solid, b_solid);
        a = b;
        a_solid = b_solid;
    }
    return sum + vector[0] * solid_angle;
}

// Sums over the face's points of height/r³: the nodes of relume::light::emitter::PlainFace, on a quadrangle at once, or on the triangles of a fan.
fn by_points(first: u32, corners: u32, at: vec3f, height: f32) -> Response {
    let a = face_texel(first).xyz - at;
    let is_quad = corners == 4u;
    var sum = Response();
    for (var k = 0u; k < select(corners - 2u, 1u, is_quad); k++) {
        let b = face_texel(first + k + 1u).xyz - at;
        let c = face_texel(first + k + 2u).xyz - at;
        // A triangle is a quadrangle that ends where it began.
        var d = a;
        if is_quad {
            d = face_texel(first + 3u).xyz - at;
        }
        for (var i = 0u; i < POINTS; i++) {
            let low = a + (b - a) * NODES[i];
            let up = d + (c - d) * NODES[i] - low;
            for (var j = 0u; j < POINTS; j++) {
                let apart = low + up * NODES[j];
                let along = (b - a) + ((c - d) - (b - a)) * NODES[j];
                let across = cross(along, up);
                let area = WEIGHTS[i] * WEIGHTS[j] * sqrt(dot(across, across));
                let inverse = 1.0 / sqrt(max(dot(apart, apart), 1e-30));
                sum += (area * height * inverse * inverse * inverse) * toward(apart * inverse);
            }
        }
    }
    return sum;
}

// What the side makes of a face of radiance 1.
fn by_face(first: u32, at: vec3f, corners: u32) -> Response {
    let normal = face_texel(first);
    let centre = face_texel(first + 1u);
    let apart = centre.xyz - at;
    let square = dot(apart, apart);
    // How far before the face the vertex stands.
    let height = -dot(normal.xyz, apart);
    let tiny = 1e-7 * (sqrt(square) + normal.w);
    let seen = height > tiny || (centre.w > 0.5 && height < -tiny);
    if !seen {
        return Response();
    }
    if normal.w * normal.w <= SMALL * SMALL * square {
        return by_points(first + 3u, corners, at, abs(height));
    }
    // Seen from behind, edges run clockwise.
    return sign(height) * by_edges(first + 3u, corners, at);
}

fn near(place: vec2u) -> vec3f {
    load_vector(place);
    let at = textureLoad(positions, place, 0).xyz;
    let header = vec2u(textureLoad(faces, vec2u(), 0).xy);
    faces_log2 = header.y;
    var first = 1u;
    var sum = vec3f();
    for (var i = 0u; i < header.x; i++) {
        let radiance = face_texel(first + 2u);
        let corners = u32(radiance.w);
        sum += radiance.xyz * by_face(first, at, corners);
        first += 3u + corners;
    }
    if REST {
        sum += vertices_sum(place, rest);
    }
    return sum;
}

@fragment
fn near_distant(@builtin(position) at: vec4f) -> @location(0) vec4u {
    let place = vec2u(at.xy);
    return bits(distant_sum(place) + near(place));
}

@fragment
fn near_objects(@builtin(position) at: vec4f) -> @location(0) vec4u {
    let place = vec2u(at.xy);
    return bits(objects_sum(place) + near(place));
}

@fragment
fn near_vertices(@builtin(position) at: vec4f) -> @location(0) vec4u {
    let place = vec2u(at.xy);
    return bits(vertices_sum(place, light) + near(place));
}
