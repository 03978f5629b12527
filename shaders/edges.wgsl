// Thin lines on folds and outlines, out of the depth: a factor that darkens the picture.

// Without the lines; its alpha tells what fades.
@group(0) @binding(2) var picture: texture_2d<f32>;

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

// The bends along both axes between a pixel and those so many steps away. Over a plane the reversed depth
// is linear in the picture (1 / z in perspective, z in parallel), so whatever bends is an edge;
// `frame.bend` makes the bend a difference of tangents.
fn bends(pixel: vec2<i32>, m: f32, steps: i32) -> vec2<f32> {
    let a = depth_at(pixel + vec2<i32>(-steps, 0));
    let b = depth_at(pixel + vec2<i32>(steps, 0));
    let c = depth_at(pixel + vec2<i32>(0, -steps));
    let d = depth_at(pixel + vec2<i32>(0, steps));
    let tangent = frame.bend / (select(m, 1.0, frame.parallel > 0.5) * f32(steps));
    return vec2<f32>(bend(vec2<f32>(m - a, m - b) * tangent), bend(vec2<f32>(m - c, m - d) * tangent));
}

// 0 on even surfaces, towards 1 on folds and outlines. `fading`: neighbours may show two levels of the same
// thing; pixels two steps apart show the same one, so what is no edge between them is none.
fn edge(pixel: vec2<i32>, fading: bool) -> f32 {
    let m = depth_at(pixel);
    // Sky, or ground.
    if m <= 1e-20 {
        return 0.0;
    }
    var folds = bends(pixel, m, 1);
    if fading {
        folds = min(folds, bends(pixel, m, 2));
    }
    let fold = max(folds.x, folds.y);
    let parallel = frame.parallel > 0.5;
    // Where a pixel is large, lines would fill the picture: they fade.
    let pixel_m = select(frame.near / (m * frame.bend), frame.pixel_m, parallel);
    let fine = clamp(0.06 / pixel_m, 0.25, 1.0);
    return clamp((fold - 0.25) * 0.8, 0.0, 1.0) * fine;
}

@fragment
fn edges_fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return vec4<f32>(vec3<f32>(1.0 - frame.edges * edge(vec2<i32>(position.xy), false)), 1.0);
}

@fragment
fn edges_fading_fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(position.xy);
    let fading = textureLoad(picture, pixel, 0).a < 254.5 / 255.0;
    return vec4<f32>(vec3<f32>(1.0 - frame.edges * edge(pixel, fading)), 1.0);
}
