struct Frame {
    clip_from_world: mat4x4f,
    toward_light: vec3f,
    albedo: f32,
}

@group(0) @binding(0) var<uniform> frame: Frame;

struct Seen {
    @builtin(position) position: vec4f,
    @location(0) normal: vec3f,
}

@vertex
fn vertex(@location(0) position: vec3f, @location(1) normal: vec3f) -> Seen {
    return Seen(frame.clip_from_world * vec4f(position, 1.0), normal);
}

@fragment
fn lit(seen: Seen) -> @location(0) vec4f {
    let cosine = max(dot(normalize(seen.normal), frame.toward_light), 0.0);
    return vec4f(vec3f(frame.albedo * cosine), 1.0);
}
