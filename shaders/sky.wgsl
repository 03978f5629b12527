// Where no solid thing is: the sky, and the ground with its grid. Alpha 0: no element is here.

struct SkyOut {
    @builtin(position) clip: vec4<f32>,
    // The picture from -1 to 1.
    @location(0) at: vec2<f32>,
}

@vertex
fn sky_vertex(@builtin(vertex_index) index: u32) -> SkyOut {
    let at = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u)) * 2.0 - 1.0;
    // Reversed depth: 0 is infinitely far.
    return SkyOut(vec4<f32>(at, 0.0, 1.0), at);
}

// How much of a pixel a grid line covers.
fn grid_line(place: vec2<f32>, spacing: f32) -> f32 {
    let p = place / spacing;
    let width = max(abs(dpdx(p)) + abs(dpdy(p)), vec2<f32>(1e-5));
    let from_line = abs(fract(p - 0.5) - 0.5);
    let cover = clamp(1.0 - from_line / width, vec2<f32>(0.0), vec2<f32>(1.0));
    // Lines closer than some pixels become an even tone and vanish.
    let fade = clamp(1.0 - width * 4.0, vec2<f32>(0.0), vec2<f32>(1.0));
    let line = cover * fade;
    return max(line.x, line.y);
}

@fragment
fn sky_fragment(in: SkyOut) -> @location(0) vec4<f32> {
    let across = frame.right * in.at.x + frame.up * in.at.y;
    let direction = normalize(select(frame.forward + across, frame.forward, frame.parallel > 0.5));
    let origin = select(frame.eye, frame.eye + across, frame.parallel > 0.5);

    let drop = min(direction.y, -1e-4);
    let distance = (frame.ground - origin.y) / drop;
    let place = origin.xz + direction.xz * distance;
    let from_middle = length(place - frame.middle) / max(length(frame.half_extent), 1.0);
    let line = max(grid_line(place, frame.grid_m) * 0.5, grid_line(place, frame.grid_m * 10.0));
    let paper = vec3<f32>(0.70, 0.69, 0.66);
    // A soft shade where the model stands.
    let beside = max(abs(place - frame.middle) - frame.half_extent, vec2<f32>(0.0));
    let shade_m = max(frame.height_m * 0.35, 2.0);
    let shaded = 0.22 * exp(-dot(beside, beside) / (shade_m * shade_m));
    var ground = paper * (1.0 - shaded) - line * 0.07;
    // The ground ends in haze, long before the horizon would alias.
    let far = clamp(from_middle * 0.16, 0.0, 1.0);
    ground = mix(ground, HORIZON, far * far * (3.0 - 2.0 * far));
    let on_ground = direction.y < -1e-4 && distance > 0.0;
    let color = select(sky(vec3<f32>(direction.x, max(direction.y, 0.0), direction.z)), ground, on_ground);
    // Less than one step of the display, so that the gradient shows no bands.
    let noise = fract(52.9829189 * fract(dot(in.clip.xy, vec2<f32>(0.06711056, 0.00583715))));
    return vec4<f32>(encode(tonemap(color)) + (noise - 0.5) / 255.0, 0.0);
}
