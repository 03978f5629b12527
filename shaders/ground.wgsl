// The ground with its grid, wherever nothing solid is. It ends in the colour of the horizon.

struct GroundOut {
    @builtin(position) clip: vec4<f32>,
    // Metres from the middle of the scene.
    @location(0) place: vec2<f32>,
    // Round coordinates of the project, in distances between fine grid lines.
    @location(1) at: vec2<f32>,
    // For the shade, one over the square of its reach; for the horizon, one over the ground's. Divided here, since
    // a division a pixel is dear in software.
    @location(2) @interpolate(flat) scale: vec2<f32>,
}

// The ground reaches this many times as far as the scene.
const REACH: f32 = 6.25;

@vertex
fn ground_vertex(@builtin(vertex_index) index: u32) -> GroundOut {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    let reach = REACH * max(length(frame.half_extent), 1.0);
    let place = corner * reach;
    let at = frame.middle + place;
    let clip = frame.clip_from_world * vec4<f32>(at.x, frame.ground, at.y, 1.0);
    let shade_m = max(frame.height_m * 0.35, 2.0);
    var out: GroundOut;
    // Reversed depth: behind everything that was drawn, before the sky.
    out.clip = vec4<f32>(clip.xy, 1e-30 * clip.w, clip.w);
    out.place = place;
    out.at = (at + frame.grid_from) / frame.grid_m;
    out.scale = 1.0 / vec2<f32>(shade_m * shade_m, reach);
    return out;
}

// How much of a pixel a grid line covers. Lines lie on whole numbers; `width` of a pixel, and one over it.
fn grid_line(at: vec2<f32>, width: vec2<f32>, narrow: vec2<f32>) -> f32 {
    let off = abs(fract(at - 0.5) - 0.5);
    let cover = clamp(1.0 - off * narrow, vec2<f32>(0.0), vec2<f32>(1.0));
    // Lines closer than some pixels become an even tone and vanish.
    let line = cover * clamp(1.0 - width * 4.0, vec2<f32>(0.0), vec2<f32>(1.0));
    return max(line.x, line.y);
}

@fragment
fn ground_fragment(in: GroundOut) -> @location(0) vec4<f32> {
    let width = max(abs(dpdx(in.at)) + abs(dpdy(in.at)), vec2<f32>(1e-7));
    let narrow = 1.0 / width;
    let fine = grid_line(in.at, width, narrow);
    let coarse = grid_line(in.at * 0.1, width * 0.1, narrow * 10.0);
    // A soft shade where the model stands.
    let beside = max(abs(in.place) - frame.half_extent, vec2<f32>(0.0));
    let shade = 1.0 / (1.0 + dot(beside, beside) * in.scale.x);
    let ground = PAPER - (0.13 * shade * shade + max(fine * 0.5, coarse) * 0.05);
    let far = min(length(in.place) * in.scale.y, 1.0);
    return background(mix(ground, SKY_LOW, far * far * (3.0 - 2.0 * far)));
}
