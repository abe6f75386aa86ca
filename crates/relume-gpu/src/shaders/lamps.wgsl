// The view pass of emitters: they shine where they stand. Stands behind view.wgsl in one module.
// CPU twin: relume::light::emitter::Placed::first_hit.

struct Lamp {
    @builtin(position) position: vec4f,
    // From the eye.
    @location(0) offset: vec3f,
    // Toward the normal.
    @location(1) radiance: vec3f,
    @location(2) @interpolate(flat) normal: vec3f,
    // The exponent of the cosine, and 1 where the back shines too.
    @location(3) @interpolate(flat) shine: vec2f,
}

@vertex
fn lamp_vertex(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) radiance: vec3f,
    @location(3) shine: vec2f,
) -> Lamp {
    var lamp: Lamp;
    lamp.offset = position - view.eye;
    lamp.position = view.clip_from_offset * vec4f(lamp.offset, 1.0);
    lamp.radiance = radiance;
    lamp.normal = normal;
    lamp.shine = shine;
    return lamp;
}

@fragment
fn lamp(lamp: Lamp) -> @location(0) vec4f {
    let cosine = -dot(normalize(lamp.offset), lamp.normal);
    if cosine <= 0.0 && lamp.shine.y == 0.0 {
        return written(vec3f());
    }
    var falloff = 1.0;
    for (var power = 0.0; power < lamp.shine.x; power += 1.0) {
        falloff *= abs(cosine);
    }
    return written(lamp.radiance * falloff);
}
