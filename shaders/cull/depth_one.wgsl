@group(0) @binding(1) var depth: texture_depth_2d;

fn farthest(pixel: vec2<i32>) -> f32 {
    return textureLoad(depth, pixel, 0);
}
