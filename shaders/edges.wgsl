// Thin lines on folds and outlines, out of the depth: a factor that darkens the picture.

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
    // Sky, or ground.
    if m <= 1e-20 {
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
fn edges_fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return vec4<f32>(vec3<f32>(1.0 - frame.edges * edge(vec2<i32>(position.xy))), 1.0);
}
