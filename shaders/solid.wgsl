// Everything opaque.

struct SolidOut {
    @builtin(position) clip: vec4<f32>,
    // As the display takes it.
    @location(0) color: vec3<f32>,
}

@vertex
fn solid_vertex(in: VertexIn) -> SolidOut {
    let placed = place(in);
    let m = materials[in.packed >> 16u];
    let surface = Surface(m.color.rgb, m.roughness, m.metallic);
    let color = shade(surface, placed.normal, placed.to_eye, placed.height);
    return SolidOut(placed.clip, display(color, length(placed.from_eye)));
}

@fragment
fn solid_fragment(v: SolidOut) -> @location(0) vec4<f32> {
    return vec4<f32>(v.color, 1.0);
}
