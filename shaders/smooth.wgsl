// Soft stairs for pictures with one sample a pixel: a blend along the edge that the four diagonal
// neighbours show.

@group(0) @binding(1) var picture: texture_2d<f32>;
@group(0) @binding(2) var smooth_sampler: sampler;

fn luma(color: vec4<f32>) -> f32 {
    return dot(color.rgb, vec3<f32>(0.299, 0.587, 0.114));
}

fn texel(pixel: vec2<i32>) -> vec4<f32> {
    let last = vec2<i32>(frame.size) - 1;
    return textureLoad(picture, clamp(pixel, vec2<i32>(0), last), 0);
}

@fragment
fn smooth_fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(position.xy);
    let center = texel(pixel);
    let m = luma(center);
    let a = luma(texel(pixel + vec2<i32>(-1, -1)));
    let b = luma(texel(pixel + vec2<i32>(1, -1)));
    let c = luma(texel(pixel + vec2<i32>(-1, 1)));
    let d = luma(texel(pixel + vec2<i32>(1, 1)));
    let low = min(m, min(min(a, b), min(c, d)));
    let high = max(m, max(max(a, b), max(c, d)));
    // Even: most pixels.
    if high - low < max(0.04, high * 0.10) {
        return center;
    }
    var along = vec2<f32>((c + d) - (a + b), (a + c) - (b + d));
    let damp = max((a + b + c + d) * 0.03125, 1.0 / 128.0);
    along = clamp(along / (min(abs(along.x), abs(along.y)) + damp), vec2<f32>(-4.0), vec2<f32>(4.0));
    let at = position.xy / frame.size;
    let step = along * 0.5 / frame.size;
    let one = textureSampleLevel(picture, smooth_sampler, at - step, 0.0);
    let other = textureSampleLevel(picture, smooth_sampler, at + step, 0.0);
    let blend = (one + other) * 0.375 + center * 0.25;
    // Outside the range of the neighbours the blend has met another edge.
    let l = luma(blend);
    let keep = l < low || l > high;
    return vec4<f32>(select(blend.rgb, center.rgb, keep), center.a);
}
