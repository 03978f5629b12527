// Colours of sky and ground as the display takes them, and their alpha: one step below 1. Elements
// have 1, so that the picture says where they are and still is opaque.

const SKY_TOP: vec3<f32> = vec3<f32>(0.545, 0.690, 0.860);
const SKY_LOW: vec3<f32> = vec3<f32>(0.885, 0.910, 0.935);
const PAPER: vec3<f32> = vec3<f32>(0.850, 0.845, 0.830);
const BACKGROUND: f32 = 254.0 / 255.0;

// What is left of them by night.
const DIM: vec3<f32> = vec3<f32>(0.36, 0.42, 0.55);

fn background(color: vec3<f32>) -> vec4<f32> {
    return vec4<f32>(color * mix(DIM, vec3<f32>(1.0), frame.day), BACKGROUND);
}
