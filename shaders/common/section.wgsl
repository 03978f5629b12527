// Section planes: which points of the scene are shown.

// Whether all planes show a point, given by where it is as seen from the eye.
fn is_shown_by_planes(from_eye: vec3<f32>) -> bool {
    let at = vec4<f32>(frame.eye + from_eye, 1.0);
    for (var i = 0u; i < frame.planes; i++) {
        if dot(frame.section[i], at) < 0.0 {
            return false;
        }
    }
    return true;
}
