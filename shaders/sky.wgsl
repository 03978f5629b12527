// The sky, wherever nothing solid is.

struct SkyOut {
    @builtin(position) clip: vec4<f32>,
    // Line of sight in the directions of the world, of any length.
    @location(0) sight: vec3<f32>,
}

@vertex
fn sky_vertex(@builtin(vertex_index) index: u32) -> SkyOut {
    let at = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u)) * 2.0 - 1.0;
    let across = frame.right * at.x + frame.up * at.y;
    let sight = select(frame.forward + across, frame.forward, frame.parallel > 0.5);
    // Reversed depth: 0 is infinitely far.
    return SkyOut(vec4<f32>(at, 0.0, 1.0), sight);
}

@fragment
fn sky_fragment(in: SkyOut) -> @location(0) vec4<f32> {
    let up = in.sight.y * inverseSqrt(dot(in.sight, in.sight));
    let low = 1.0 - clamp(up, 0.0, 1.0);
    // Less than one step of the display, so that the gradient shows no bands.
    let noise = fract(52.9829189 * fract(dot(in.clip.xy, vec2<f32>(0.06711056, 0.00583715))));
    let color = mix(SKY_TOP, SKY_LOW, low * low * low) + (noise - 0.5) / 255.0;
    return background(color);
}
