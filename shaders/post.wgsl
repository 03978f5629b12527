// From the drawn picture to the shown one: edge lines out of the depth, and soft stairs.

@group(0) @binding(1) var picture: texture_2d<f32>;
@group(0) @binding(2) var smooth_sampler: sampler;

override smooth_stairs: bool = true;

@vertex
fn post_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let at = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u)) * 2.0 - 1.0;
    return vec4<f32>(at, 0.0, 1.0);
}

fn luma(color: vec3<f32>) -> f32 {
    return dot(color, vec3<f32>(0.299, 0.587, 0.114));
}

// Blends along the edge that the four diagonal neighbours show.
fn soften(at: vec2<f32>) -> vec3<f32> {
    let step = 1.0 / frame.size;
    let center = textureSampleLevel(picture, smooth_sampler, at, 0.0).rgb;
    let a = luma(textureSampleLevel(picture, smooth_sampler, at + vec2<f32>(-1.0, -1.0) * step, 0.0).rgb);
    let b = luma(textureSampleLevel(picture, smooth_sampler, at + vec2<f32>(1.0, -1.0) * step, 0.0).rgb);
    let c = luma(textureSampleLevel(picture, smooth_sampler, at + vec2<f32>(-1.0, 1.0) * step, 0.0).rgb);
    let d = luma(textureSampleLevel(picture, smooth_sampler, at + vec2<f32>(1.0, 1.0) * step, 0.0).rgb);
    let m = luma(center);
    let low = min(m, min(min(a, b), min(c, d)));
    let high = max(m, max(max(a, b), max(c, d)));
    if high - low < max(0.04, high * 0.10) {
        return center;
    }
    var along = vec2<f32>((c + d) - (a + b), (a + c) - (b + d));
    let damp = max((a + b + c + d) * 0.03125, 1.0 / 128.0);
    along /= min(abs(along.x), abs(along.y)) + damp;
    along = clamp(along, vec2<f32>(-6.0), vec2<f32>(6.0)) * step;
    let near = 0.5 * (textureSampleLevel(picture, smooth_sampler, at - along / 6.0, 0.0).rgb
        + textureSampleLevel(picture, smooth_sampler, at + along / 6.0, 0.0).rgb);
    let far = 0.5 * near + 0.25 * (textureSampleLevel(picture, smooth_sampler, at - along * 0.5, 0.0).rgb
        + textureSampleLevel(picture, smooth_sampler, at + along * 0.5, 0.0).rgb);
    let l = luma(far);
    // Outside the range of the neighbours the long blend has met another edge.
    return select(far, near, l < low || l > high);
}

fn depth_at(pixel: vec2<i32>) -> f32 {
    let last = vec2<i32>(frame.size) - 1;
    return textureLoad(depth, clamp(pixel, vec2<i32>(0), last), 0);
}

// Depth differences to the two neighbours on an axis, as tangents: how much nearer the middle is.
fn bend(near: vec2<f32>) -> f32 {
    let fold = near.x + near.y;
    // Thinner than a pixel: lines on both sides would only make it dark.
    let thin = min(near.x, near.y) > 8.0;
    // A fold outward or an outline shows on the nearer side; a fold inward a little less; what
    // stands far in front of this pixel draws its own line.
    let inward = select(-0.6 * fold, 0.0, fold < -6.0);
    return select(max(fold, inward), 0.0, thin);
}

// 0 on even surfaces, towards 1 on folds and outlines. Over a plane the reversed depth is linear
// in the picture (1 / z in perspective, z in parallel), so whatever bends is an edge; `frame.bend`
// makes the bend a difference of tangents.
fn edge(pixel: vec2<i32>) -> f32 {
    let m = depth_at(pixel);
    if m <= 0.0 {
        return 0.0;
    }
    let a = depth_at(pixel + vec2<i32>(-1, 0));
    let b = depth_at(pixel + vec2<i32>(1, 0));
    let c = depth_at(pixel + vec2<i32>(0, -1));
    let d = depth_at(pixel + vec2<i32>(0, 1));
    let parallel = frame.parallel > 0.5;
    let tangent = frame.bend / select(m, 1.0, parallel);
    let fold = max(bend(vec2<f32>(m - a, m - b) * tangent), bend(vec2<f32>(m - c, m - d) * tangent));
    // Where a pixel is large, lines would fill the picture: they fade.
    let pixel_m = select(frame.near / (m * frame.bend), frame.pixel_m, parallel);
    let fine = clamp(0.06 / pixel_m, 0.25, 1.0);
    return clamp((fold - 0.25) * 0.8, 0.0, 1.0) * fine;
}

@fragment
fn post_fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(position.xy);
    var color: vec3<f32>;
    if smooth_stairs {
        color = soften(position.xy / frame.size);
    } else {
        color = textureLoad(picture, pixel, 0).rgb;
    }
    if frame.edges > 0.0 {
        color *= 1.0 - frame.edges * edge(pixel);
    }
    return vec4<f32>(color, 1.0);
}
