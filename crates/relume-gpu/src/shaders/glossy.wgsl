// The view pass of transfer matrices: transferred radiance of the three corners, interpolated, reflected by the material at the pixel. Stands
// behind view.wgsl in one module, and `const ORDER`, the order of transferred radiance, before both.
// CPU twins: relume::display::GlossyRadiance, relume::scene::World::shading_point, relume::brdf::Reflector.

// What a pipeline is made for, beside the constants of view.wgsl.
override REFLECTION: u32;
override FINISH_MAP: bool;
override NORMAL_MAP: bool;

// What gray reflections there are, and what colours them: one, in the base colour; those of a glTF material; red, green and blue.
const DIFFUSE = 0u;
const METALLIC_ROUGHNESS = 1u;
const FIXED = 2u;
// As fixed ones where there are no tangents, else tile.wgsl.
const TILE = 3u;

const LOBE_QUADS = (ORDER + 3u) / 4u;
const STEPS = ORDER * (ORDER + 1u) / 2u;

struct Expansion {
    // Sides in a row of `transferred`.
    across: u32,
    // Of the angles between the normal and the directions in the plane of view, four at a time.
    cosines: array<vec4f, LOBE_QUADS>,
    sines: array<vec4f, LOBE_QUADS>,
    // Of the recurrence in l, for one μ after another: √2 P̄_μμ, then (a, a·b) of each l > μ. See relume::basis::sh.
    steps: array<vec4f, STEPS>,
}

// Rows of sides: see matrices.wgsl.
@group(1) @binding(3) var transferred: texture_2d<u32>;
@group(1) @binding(4) var<uniform> expansion: Expansion;
@group(2) @binding(3) var finish_map: texture_2d<f32>;
@group(2) @binding(4) var finish_sampler: sampler;
@group(2) @binding(5) var normal_map: texture_2d<f32>;
@group(2) @binding(6) var normal_sampler: sampler;
// The c_lk: along x the angle of view, along y roughness; layer (l · LOBE_QUADS + k / 4) · 3 + gray reflection.
@group(3) @binding(0) var lobes: texture_2d_array<f32>;
@group(3) @binding(1) var lobes_sampler: sampler;

struct GlossySeen {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
    @location(1) color: vec4f,
    // From the eye.
    @location(2) offset: vec3f,
    @location(3) normal: vec3f,
    @location(4) tangent: vec4f,
    // Of the corners.
    @location(5) weights: vec3f,
    // The first texel of each corner, x and y in 16 bits each.
    @location(6) @interpolate(flat) fronts: vec3u,
    @location(7) @interpolate(flat) backs: vec3u,
}

fn first_texels(sides: vec3u) -> vec3u {
    let rows = sides / expansion.across;
    let texels = (sides - rows * expansion.across) * (3u * ((ORDER * ORDER + 3u) / 4u));
    return select((rows << vec3u(16u)) | texels, vec3u(NO_SIDE), sides == vec3u(NO_SIDE));
}

// Vertices come three by three, one triangle after another.
@vertex
fn glossy_vertex(
    @builtin(vertex_index) index: u32,
    @location(0) position: vec3f,
    @location(1) uv: vec2f,
    @location(2) color: vec4f,
    @location(3) normal: vec3f,
    @location(4) tangent: vec4f,
    @location(5) fronts: vec3u,
    @location(6) backs: vec3u,
) -> GlossySeen {
    var seen: GlossySeen;
    seen.offset = position - view.eye;
    seen.position = view.clip_from_offset * vec4f(seen.offset, 1.0);
    seen.uv = uv;
    seen.color = color;
    seen.normal = normal;
    seen.tangent = tangent;
    seen.weights = vec3f(vec3u(index % 3u) == vec3u(0u, 1u, 2u));
    seen.fronts = first_texels(fronts);
    seen.backs = vec3u(NO_SIDE);
    if TWO_SIDED {
        seen.backs = first_texels(backs);
    }
    return seen;
}

@fragment
fn glossy(seen: GlossySeen, @builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    var color = material.base_color;
    if COLORED {
        color *= seen.color;
    }
    if TEXTURED {
        let texel = textureSample(base_color, base_color_sampler, seen.uv);
        color *= select(texel, vec4f(1.0, 1.0, 1.0, texel.a), BARE);
    }
    var roughness = material.roughness;
    var metallic = material.metallic;
    if FINISH_MAP {
        let texel = textureSample(finish_map, finish_sampler, seen.uv);
        roughness *= texel.g;
        metallic *= texel.b;
    }
    var normal = mapped_normal(seen);
    if MASKED && color.a < material.cutoff {
        discard;
    }
    var corners = seen.fronts;
    if !is_front {
        corners = seen.backs;
        normal = -normal;
    }
    if any(corners == vec3u(NO_SIDE)) {
        return written(vec3f());
    }
    let toward = seen_from_above(normal, -normalize(seen.offset));
    if REFLECTION == TILE && any(seen.tangent.xyz != vec3f()) {
        let mirrored = select(-seen.tangent.w, seen.tangent.w, is_front);
        return written(tiled(corners, seen.weights, normal, seen.tangent.xyz, mirrored, toward, seen.uv));
    }
    let terms = reflected(corners, seen.weights, normal, toward, roughness);
    if REFLECTION == DIFFUSE {
        return written(color.rgb * terms[0]);
    }
    if REFLECTION == FIXED || REFLECTION == TILE {
        return written(vec3f(terms[0].r, terms[1].g, terms[2].b));
    }
    let head_on = mix(vec3f(0.04), color.rgb, metallic);
    return written(terms[0] + head_on * terms[1] + (1.0 - metallic) * color.rgb * terms[2]);
}

// Unit, of the front.
fn mapped_normal(seen: GlossySeen) -> vec3f {
    var normal = seen.normal;
    if NORMAL_MAP {
        let texel = textureSample(normal_map, normal_sampler, seen.uv).xyz * 2.0 - 1.0;
        let bitangent = cross(seen.normal, seen.tangent.xyz) * seen.tangent.w;
        let across = material.normal_scale * (texel.x * seen.tangent.xyz + texel.y * bitangent);
        normal = across + texel.z * seen.normal;
    }
    return normalize(normal);
}

// Where a normal turns away from the view, that from just above its tangent plane.
fn seen_from_above(normal: vec3f, toward: vec3f) -> vec3f {
    let lift = max(1e-3 - dot(normal, toward), 0.0);
    return normalize(toward + normal * lift);
}

// Four coefficients of transferred radiance, interpolated: of red, of green and of blue.
fn four(corners: vec3u, weights: vec3f, quad: u32) -> mat3x4f {
    var sum = mat3x4f();
    for (var corner = 0u; corner < 3u; corner++) {
        let first = vec2u((corners[corner] & 0xffffu) + 3u * quad, corners[corner] >> 16u);
        let red = bitcast<vec4f>(textureLoad(transferred, first, 0));
        let green = bitcast<vec4f>(textureLoad(transferred, first + vec2u(1u, 0u), 0));
        let blue = bitcast<vec4f>(textureLoad(transferred, first + vec2u(2u, 0u), 0));
        sum += weights[corner] * mat3x4f(red, green, blue);
    }
    return sum;
}

// Radiance toward the view of each gray reflection: Σ_lμ a_lμ Σ_k c_lk Y_lμ(d_k), d_k being directions in the plane of view.
//
// Only the recurrences of one μ are at hand at any time, for all directions; coefficients are read in that order, each once.
fn reflected(corners: vec3u, weights: vec3f, normal: vec3f, toward: vec3f, roughness: f32) -> mat3x3f {
    let height = dot(normal, toward);
    let aside = toward - height * normal;
    let far = length(aside);
    // Along the normal any plane will do.
    let axis = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(normal.x) > 0.7);
    let tangent = select(normalize(cross(normal, axis)), aside / max(far, 1e-20), far > 1e-6);
    let size = vec2f(textureDimensions(lobes));
    let at = vec2f(atan2(far, height) * 0.63661977, clamp(roughness, 0.0, 1.0));
    let place = (at * (size - 1.0) + 0.5) / size;

    var x: array<vec4f, LOBE_QUADS>;
    var y: array<vec4f, LOBE_QUADS>;
    var z: array<vec4f, LOBE_QUADS>;
    // (x + iy) to the power of μ, and P̄_lμ and the one before it.
    var re: array<vec4f, LOBE_QUADS>;
    var im: array<vec4f, LOBE_QUADS>;
    var legendre: array<vec4f, LOBE_QUADS>;
    var before: array<vec4f, LOBE_QUADS>;
    for (var q = 0u; q < LOBE_QUADS; q++) {
        x[q] = expansion.cosines[q] * normal.x + expansion.sines[q] * tangent.x;
        y[q] = expansion.cosines[q] * normal.y + expansion.sines[q] * tangent.y;
        z[q] = expansion.cosines[q] * normal.z + expansion.sines[q] * tangent.z;
        re[q] = vec4f(1.0);
    }
    var sums = mat3x3f();
    // What the next four coefficients are multiplied with, for each gray reflection; how many coefficients and steps are behind.
    var factors = mat3x4f();
    var read = 0u;
    var taken = 0u;
    for (var mu = 0u; mu < ORDER; mu++) {
        for (var l = mu; l < ORDER; l++) {
            let ab = expansion.steps[taken];
            taken++;
            var cosines = vec3f();
            var sines = vec3f();
            for (var q = 0u; q < LOBE_QUADS; q++) {
                let next = select(ab.x * z[q] * legendre[q] - ab.y * before[q], vec4f(ab.x), l == mu);
                before[q] = select(legendre[q], vec4f(), l == mu);
                legendre[q] = next;
                let layer = (l * LOBE_QUADS + q) * 3u;
                let first = next * textureSampleLevel(lobes, lobes_sampler, place, layer, 0.0);
                cosines.x += dot(first, re[q]);
                sines.x += dot(first, im[q]);
                if REFLECTION != DIFFUSE {
                    let second = next * textureSampleLevel(lobes, lobes_sampler, place, layer + 1u, 0.0);
                    let third = next * textureSampleLevel(lobes, lobes_sampler, place, layer + 2u, 0.0);
                    cosines.y += dot(second, re[q]);
                    sines.y += dot(second, im[q]);
                    cosines.z += dot(third, re[q]);
                    sines.z += dot(third, im[q]);
                }
            }
            if mu == 0u {
                let one = vec4f(vec4u(read & 3u) == vec4u(0u, 1u, 2u, 3u));
                factors += mat3x4f(cosines.x * one, cosines.y * one, cosines.z * one);
                // After the last, pairs begin.
                read += 1u + (ORDER & u32(l + 1u == ORDER));
            } else {
                let low = f32((read & 2u) == 0u);
                let pair = vec4f(low, low, 1.0 - low, 1.0 - low);
                factors += mat3x4f(
                    pair * vec2f(sines.x, cosines.x).xyxy,
                    pair * vec2f(sines.y, cosines.y).xyxy,
                    pair * vec2f(sines.z, cosines.z).xyxy,
                );
                read += 2u;
            }
            if (read & 3u) == 0u {
                sums += transpose(four(corners, weights, read / 4u - 1u)) * factors;
                factors = mat3x4f();
            }
        }
        for (var q = 0u; q < LOBE_QUADS; q++) {
            let turned = re[q] * x[q] - im[q] * y[q];
            im[q] = im[q] * x[q] + re[q] * y[q];
            re[q] = turned;
        }
    }
    if (read & 3u) != 0u {
        sums += transpose(four(corners, weights, read / 4u)) * factors;
    }
    return sums;
}
