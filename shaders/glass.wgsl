// Everything transparent: the solid parts behind it shine through, the sky is mirrored.

// The picture without glass.
@group(1) @binding(0) var behind: texture_2d<f32>;

struct GlassOut {
    @builtin(position) clip: vec4<f32>,
    // As the display takes it, and how much of what is behind it covers.
    @location(0) color: vec4<f32>,
}

@vertex
fn glass_vertex(in: VertexIn) -> GlassOut {
    return lit(place(in), in.packed >> 16u, in.look);
}

@vertex
fn glass_fixed_vertex(in: FixedIn) -> GlassOut {
    return lit(place_fixed(in), in.packed >> 16u, 0u);
}

fn lit(placed: Placed, material: u32, look: u32) -> GlassOut {
    let view = placed.to_eye;
    let normal = placed.normal;
    let own = looked(materials[material].color, look);
    let n_eye = clamp(dot(normal, view), 0.0, 1.0);
    let graze = 1.0 - n_eye;
    let graze2 = graze * graze;
    // What stands for a body of glass is the surface in front: it has the opacity of the material,
    // and mirrors as front and back do together.
    let body = clamp(own.a, 0.0, 1.0);
    let face = 0.04 + 0.60 * graze2 * graze2 * graze;
    let mirror = face * (2.0 - face);

    let half_way = normalize(frame.sun + view);
    let n_half = max(dot(normal, half_way), 0.0);
    let n2 = n_half * n_half;
    let n8 = n2 * n2 * n2 * n2;
    let glint = n8 * n8 * n8 * n8 * 0.5 * max(dot(normal, frame.sun), 0.0);

    let light = mix(AMBIENT_BELOW, AMBIENT_ABOVE, normal.y * 0.5 + 0.5)
        + SUN * max(dot(normal, frame.sun), 0.0) * 0.4;
    let tint = own.rgb * light;
    let opacity = mirror + body * (1.0 - mirror);
    let color = (sky(reflect(-view, normal)) * mirror + tint * body * (1.0 - mirror)
        + SUN * glint) / opacity;
    return GlassOut(placed.clip, vec4<f32>(display(color, length(placed.from_eye)), opacity));
}

fn over(color: vec4<f32>, pixel: vec2<f32>) -> vec4<f32> {
    let through = textureLoad(behind, vec2<i32>(pixel), 0).rgb;
    return vec4<f32>(mix(through, color.rgb, color.a), 1.0);
}

@fragment
fn glass_fragment(v: GlassOut) -> @location(0) vec4<f32> {
    return over(v.color, v.clip.xy);
}

struct CutOut {
    @builtin(position) clip: vec4<f32>,
    @location(0) color: vec4<f32>,
    @location(1) from_eye: vec3<f32>,
}

@vertex
fn glass_cut_vertex(in: VertexIn) -> CutOut {
    let placed = place(in);
    let out = lit(placed, in.packed >> 16u, in.look);
    return CutOut(out.clip, out.color, placed.from_eye);
}

@fragment
fn glass_cut_fragment(v: CutOut) -> @location(0) vec4<f32> {
    if !is_shown_by_planes(v.from_eye) {
        discard;
    }
    return over(v.color, v.clip.xy);
}

struct FadingOut {
    @builtin(position) clip: vec4<f32>,
    @location(0) color: vec4<f32>,
    @location(1) @interpolate(flat) share: u32,
}

@vertex
fn glass_fading_vertex(in: VertexIn, @location(5) share: u32) -> FadingOut {
    let out = lit(place(in), in.packed >> 16u, in.look);
    return FadingOut(out.clip, out.color, share);
}

@fragment
fn glass_fading_fragment(v: FadingOut) -> @location(0) vec4<f32> {
    if !is_shown(v.share, v.clip.xy) {
        discard;
    }
    return vec4<f32>(over(v.color, v.clip.xy).rgb, FADING);
}
