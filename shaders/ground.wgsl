// The ground with its grid, wherever nothing solid is. It ends in the colour of the horizon.

struct GroundOut {
    @builtin(position) clip: vec4<f32>,
    // Metres from the middle of the scene.
    @location(0) place: vec2<f32>,
}

// The ground reaches this many times as far as the scene.
const REACH: f32 = 6.25;

@vertex
fn ground_vertex(@builtin(vertex_index) index: u32) -> GroundOut {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    let place = corner * REACH * max(length(frame.half_extent), 1.0);
    let at = frame.middle + place;
    let clip = frame.clip_from_world * vec4<f32>(at.x, frame.ground, at.y, 1.0);
    // Reversed depth: behind everything that was drawn, before the sky.
    return GroundOut(vec4<f32>(clip.xy, 1e-30 * clip.w, clip.w), place);
}

// How much of a pixel a grid line covers.
fn grid_line(place: vec2<f32>, spacing: f32, width_m: vec2<f32>) -> f32 {
    let p = place / spacing;
    let width = width_m / spacing;
    let from_line = abs(fract(p - 0.5) - 0.5);
    let cover = clamp(1.0 - from_line / width, vec2<f32>(0.0), vec2<f32>(1.0));
    // Lines closer than some pixels become an even tone and vanish.
    let line = cover * clamp(1.0 - width * 4.0, vec2<f32>(0.0), vec2<f32>(1.0));
    return max(line.x, line.y);
}

@fragment
fn ground_fragment(in: GroundOut) -> @location(0) vec4<f32> {
    let width_m = max(abs(dpdx(in.place)) + abs(dpdy(in.place)), vec2<f32>(1e-5));
    // Lines lie on round coordinates of the project.
    let at = in.place + frame.middle + frame.grid_from;
    let line = max(
        grid_line(at, frame.grid_m, width_m) * 0.5,
        grid_line(at, frame.grid_m * 10.0, width_m),
    );
    // A soft shade where the model stands.
    let beside = max(abs(in.place) - frame.half_extent, vec2<f32>(0.0));
    let shade_m = max(frame.height_m * 0.35, 2.0);
    let shade = 1.0 / (1.0 + dot(beside, beside) / (shade_m * shade_m));
    let ground = PAPER - (0.13 * shade * shade + line * 0.05);
    let from_middle = length(in.place) / max(length(frame.half_extent), 1.0);
    let far = clamp(from_middle / REACH, 0.0, 1.0);
    return background(mix(ground, SKY_LOW, far * far * (3.0 - 2.0 * far)));
}
