// Alpha of what fades; the lines look for it.
const FADING: f32 = 253.0 / 255.0;

// Whether a pixel shows something that fades. `share`: how many of each square of 2 x 2 pixels show what is
// coming, and 4 more for what is going: it has the others. The twin of Share in render/src/fade.rs.
fn is_shown(share: u32, pixel: vec2<f32>) -> bool {
    let at = vec2<u32>(pixel) & vec2<u32>(1u);
    // The order in which the four change: along one diagonal, then along the other.
    let order = select(2u + at.y, at.x, at.x == at.y);
    return (order < (share & 3u)) != (share >= 4u);
}
