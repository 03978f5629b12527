// Everything opaque.

struct SolidOut {
    @builtin(position) clip: vec4<f32>,
    // As the display takes it.
    @location(0) color: vec3<f32>,
}

fn lit(placed: Placed, material: u32, look: u32) -> SolidOut {
    let m = materials[material];
    let surface = Surface(looked(m.color, look).rgb, m.roughness, m.metallic);
    let color = shade(surface, placed.normal, placed.to_eye, placed.height);
    return SolidOut(placed.clip, display(color, length(placed.from_eye)));
}

@vertex
fn solid_vertex(in: VertexIn) -> SolidOut {
    return lit(place(in), in.packed >> 16u, in.look);
}

@vertex
fn solid_fixed_vertex(in: FixedIn) -> SolidOut {
    return lit(place_fixed(in), in.packed >> 16u, 0u);
}

// Depth alone.
@vertex
fn occluder_vertex(in: VertexIn) -> @builtin(position) vec4<f32> {
    let p = vec4<f32>(in.position, 1.0);
    let world = vec3<f32>(dot(in.row_x, p), dot(in.row_y, p), dot(in.row_z, p));
    return frame.clip_from_world * vec4<f32>(world, 1.0);
}

@vertex
fn occluder_fixed_vertex(in: FixedIn) -> @builtin(position) vec4<f32> {
    return frame.clip_from_world * vec4<f32>(in.position, 1.0);
}

@fragment
fn solid_fragment(v: SolidOut) -> @location(0) vec4<f32> {
    return vec4<f32>(v.color, 1.0);
}

struct CutOut {
    @builtin(position) clip: vec4<f32>,
    @location(0) color: vec3<f32>,
    @location(1) from_eye: vec3<f32>,
}

@vertex
fn solid_cut_vertex(in: VertexIn) -> CutOut {
    let placed = place(in);
    let out = lit(placed, in.packed >> 16u, in.look);
    return CutOut(out.clip, out.color, placed.from_eye);
}

@fragment
fn solid_cut_fragment(v: CutOut) -> @location(0) vec4<f32> {
    if !is_shown_by_planes(v.from_eye) {
        discard;
    }
    return vec4<f32>(v.color, 1.0);
}

struct FadingOut {
    @builtin(position) clip: vec4<f32>,
    @location(0) color: vec3<f32>,
    @location(1) @interpolate(flat) share: u32,
}

@vertex
fn solid_fading_vertex(in: VertexIn, @location(5) share: u32) -> FadingOut {
    let out = lit(place(in), in.packed >> 16u, in.look);
    return FadingOut(out.clip, out.color, share);
}

@fragment
fn solid_fading_fragment(v: FadingOut) -> @location(0) vec4<f32> {
    if !is_shown(v.share, v.clip.xy) {
        discard;
    }
    return vec4<f32>(v.color, FADING);
}
