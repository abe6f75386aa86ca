// Surfaces covered with a tile. Stands behind glossy.wgsl in its module. CPU twins: relume::brdf::Tile, relume::scene::World::tile_place.

// A layer for each view; in it a cell for each four coefficients of each channel, with a gutter of a texel.
@group(3) @binding(2) var tile: texture_2d_array<f32>;

// Radiance toward the view; transferred radiance is in tangent frames here. `mirrored` is −1 where the image's up is against `cross(normal, tangent)`.
fn tiled(corners: vec3u, weights: vec3f, normal: vec3f, along: vec3f, mirrored: f32, toward: vec3f, uv: vec2f) -> vec3f {
    let tangent = normalize(along - normal * dot(normal, along));
    let across = cross(normal, tangent) * mirrored;
    let local = vec3f(dot(toward, tangent), dot(toward, across), max(dot(toward, normal), 0.0));

    // The octahedron's upper half on a square, its middle the normal.
    let flat = local.xy / (abs(local.x) + abs(local.y) + local.z);
    let views = material.tile.z;
    let unfolded = vec2f(flat.x + flat.y, flat.x - flat.y) * 0.5 + 0.5;
    let place = clamp(unfolded, vec2f(), vec2f(1.0)) * (views - 1.0);
    let low = min(floor(place), vec2f(views - 2.0));
    let share = place - low;
    let view = u32(low.y * views + low.x);

    let size = material.tile.xy;
    let texel = fract(uv * material.tile.w) * size + 1.0;
    let extent = vec2f(textureDimensions(tile));
    let cells = vec2u(round(extent / (size + 2.0)));
    // Past the last that the tile knows of all is dark.
    let quads = min((ORDER * ORDER + 3u) / 4u, cells.x * cells.y / 3u);

    var sums = vec3f();
    for (var quad = 0u; quad < quads; quad++) {
        let incident = four(corners, weights, quad);
        for (var channel = 0u; channel < 3u; channel++) {
            let cell = 3u * quad + channel;
            let corner = vec2f(vec2u(cell % cells.x, cell / cells.x)) * (size + 2.0);
            let at = (corner + texel) / extent;
            let near = mix(
                textureSampleLevel(tile, lobes_sampler, at, view, 0.0),
                textureSampleLevel(tile, lobes_sampler, at, view + 1u, 0.0),
                share.x,
            );
            let far = mix(
                textureSampleLevel(tile, lobes_sampler, at, view + u32(views), 0.0),
                textureSampleLevel(tile, lobes_sampler, at, view + u32(views) + 1u, 0.0),
                share.x,
            );
            sums[channel] += dot(mix(near, far, share.y), incident[channel]);
        }
    }
    return sums;
}
