// What every pass knows of the frame. The twin of FrameUniform in render/src/frame.rs.
struct Frame {
    clip_from_world: mat4x4<f32>,
    // Where the camera stands, metres in the scene's local space.
    eye: vec3<f32>,
    // 1 for parallel rays, 0 for perspective.
    parallel: f32,
    // Unit vector of the line of sight.
    forward: vec3<f32>,
    // Height of the ground plane, metres.
    ground: f32,
    // Half the picture's width as a vector: at depth 1 (perspective) or in metres (parallel).
    right: vec3<f32>,
    // Metres at which haze has taken 63 % of the contrast.
    haze_m: f32,
    // Half the picture's height, like `right`.
    up: vec3<f32>,
    // Distance between the ground's fine grid lines, metres.
    grid_m: f32,
    // Unit vector towards the sun, or what shines by night.
    sun: vec3<f32>,
    // Height of the scene above the ground, metres, at least 1.
    height_m: f32,
    // Middle of the scene on the ground, and half its extent there (x and z, metres).
    middle: vec2<f32>,
    half_extent: vec2<f32>,
    // Physical pixels.
    size: vec2<f32>,
    // Bend of the depth per pixel into a tangent, see edges.wgsl.
    bend: f32,
    // Strength of the edge lines, 0 for none.
    edges: f32,
    // Distance of the near plane, metres.
    near: f32,
    // Width of a pixel in parallel projection, metres.
    pixel_m: f32,
    // The project's x and z of the scene's zero, less whole coarse grid lines, metres.
    grid_from: vec2<f32>,
    // Colour of the line around what is selected, as the display takes it.
    accent: vec3<f32>,
    // By how many pixels' width a selected element may be behind what is drawn and still count as seen.
    slack_px: f32,
    // 1 by day, 0 by night.
    day: f32,
    // How many section planes there are.
    planes: u32,
    padding_x: f32,
    padding_y: f32,
    // Shown is where the product of a plane with (x, y, z, 1) is not negative.
    section: array<vec4<f32>, 12>,
}

@group(0) @binding(0) var<uniform> frame: Frame;
