// Where selected elements are: 1 where the eye sees them, less where something solid is before them.

struct MaskIn {
    @location(0) position: vec3<f32>,
    // Rows of world_from_mesh.
    @location(2) row_x: vec4<f32>,
    @location(3) row_y: vec4<f32>,
    @location(4) row_z: vec4<f32>,
}

struct MaskOut {
    @builtin(position) position: vec4<f32>,
    @location(0) from_eye: vec3<f32>,
}

@vertex
fn mask_vertex(in: MaskIn) -> MaskOut {
    let p = vec4<f32>(in.position, 1.0);
    let world = vec3<f32>(dot(in.row_x, p), dot(in.row_y, p), dot(in.row_z, p));
    return MaskOut(frame.clip_from_world * vec4<f32>(world, 1.0), world - frame.eye);
}

@fragment
fn mask_fragment(in: MaskOut) -> @location(0) vec4<f32> {
    if !is_shown_by_planes(in.from_eye) {
        discard;
    }
    let position = in.position;
    let drawn = textureLoad(depth, vec2<i32>(position.xy), 0);
    // What is drawn may be a cluster, off by the tolerance. Over the width of a pixel at its distance, depth
    // changes by `1 / bend` of itself, in parallel projection of everything.
    let slack = frame.slack_px / frame.bend;
    let nearest = position.z + slack * select(position.z, 1.0, frame.parallel > 0.5);
    return vec4<f32>(select(0.5, 1.0, nearest >= drawn));
}
