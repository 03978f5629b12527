@group(0) @binding(1) var depth: texture_depth_multisampled_2d;

fn farthest(pixel: vec2<i32>) -> f32 {
    var far = textureLoad(depth, pixel, 0);
    for (var sample = 1; sample < i32(cull.samples); sample++) {
        far = min(far, textureLoad(depth, pixel, sample));
    }
    return far;
}
