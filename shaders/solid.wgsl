// Everything opaque.

@fragment
fn solid(v: VertexOut) -> @location(0) vec4<f32> {
    let view = to_eye(v.from_eye);
    let normal = facing_normal(v, view);
    let m = materials[v.material];
    let surface = Surface(m.color.rgb, m.roughness, m.metallic);
    let height = v.from_eye.y + frame.eye.y - frame.ground;
    let color = shade(surface, normal, view, height);
    return vec4<f32>(display(color, length(v.from_eye)), 1.0);
}
