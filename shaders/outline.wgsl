// A line around what is selected, out of its mask: around what the eye sees of it, and a weaker one around all.

@group(0) @binding(1) var mask: texture_2d<f32>;

// Pixels.
const WIDTH: f32 = 2.0;
const REACH: i32 = 2;
// Strength of the line around what is hidden.
const HIDDEN: f32 = 0.4;

@fragment
fn outline_fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(position.xy);
    let own = textureLoad(mask, pixel, 0).r;
    if own > 0.75 {
        return vec4<f32>(0.0);
    }
    let last = vec2<i32>(frame.size) - 1;
    var line = 0.0;
    for (var y = -REACH; y <= REACH; y++) {
        for (var x = -REACH; x <= REACH; x++) {
            let at = clamp(pixel + vec2<i32>(x, y), vec2<i32>(0), last);
            let near = clamp(WIDTH + 0.5 - length(vec2<f32>(f32(x), f32(y))), 0.0, 1.0);
            let found = textureLoad(mask, at, 0).r;
            let strength = select(HIDDEN, 1.0, found > 0.75);
            line = max(line, select(0.0, near * strength, found > own));
        }
    }
    return vec4<f32>(frame.accent, line);
}
