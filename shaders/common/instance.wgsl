// Vertices of the pool at their place, and the material table.

struct Material {
    // Linear RGBA.
    color: vec4<f32>,
    roughness: f32,
    metallic: f32,
    padding: vec2<f32>,
}

@group(0) @binding(1) var<storage, read> materials: array<Material>;

struct VertexIn {
    @location(0) position: vec3<f32>,
    // Two signed bytes of octahedral normal, then the material in the upper half.
    @location(1) packed: u32,
    // Rows of world_from_mesh.
    @location(2) row_x: vec4<f32>,
    @location(3) row_y: vec4<f32>,
    @location(4) row_z: vec4<f32>,
    // See `looked`; 5 is the share of what fades.
    @location(6) look: u32,
}

// Of geometry that already is where it belongs.
struct FixedIn {
    @location(0) position: vec3<f32>,
    @location(1) packed: u32,
}

// A vertex where it stands.
struct Placed {
    clip: vec4<f32>,
    // Metres from the eye, in the directions of the world.
    from_eye: vec3<f32>,
    // Unit, on the side that the eye sees.
    normal: vec3<f32>,
    // Unit, towards the eye.
    to_eye: vec3<f32>,
    // Metres above the ground.
    height: f32,
}

// A material's colour with a look: in the lowest three bytes the roots of linear red, green and blue, then seven
// bits of opacity, then whether the colour counts. 0 changes nothing.
fn looked(color: vec4<f32>, look: u32) -> vec4<f32> {
    let root = unpack4x8unorm(look).rgb;
    let rgb = select(color.rgb, root * root, look >= 0x80000000u);
    let opacity = f32((look >> 24u) & 0x7fu) / 127.0;
    return vec4<f32>(rgb, color.a * select(opacity, 1.0, look == 0u));
}

fn decode_normal(packed: u32) -> vec3<f32> {
    let p = unpack4x8snorm(packed).xy;
    var n = vec3<f32>(p, 1.0 - abs(p.x) - abs(p.y));
    let fold = max(-n.z, 0.0);
    n.x -= select(-fold, fold, n.x >= 0.0);
    n.y -= select(-fold, fold, n.y >= 0.0);
    return n;
}

fn place(in: VertexIn) -> Placed {
    let p = vec4<f32>(in.position, 1.0);
    let world = vec3<f32>(dot(in.row_x, p), dot(in.row_y, p), dot(in.row_z, p));
    // Normals go by the cofactors: right for any stretching; a mirror's sign does not matter, since
    // the normal is turned to the eye anyway.
    let n = decode_normal(in.packed);
    let x = in.row_x.xyz;
    let y = in.row_y.xyz;
    let z = in.row_z.xyz;
    return stand(world, vec3<f32>(dot(cross(y, z), n), dot(cross(z, x), n), dot(cross(x, y), n)));
}

fn place_fixed(in: FixedIn) -> Placed {
    return stand(in.position, decode_normal(in.packed));
}

// `crossed`: the normal, of any length.
fn stand(world: vec3<f32>, crossed: vec3<f32>) -> Placed {
    let normal = crossed * inverseSqrt(max(dot(crossed, crossed), 1e-30));
    var out: Placed;
    out.clip = frame.clip_from_world * vec4<f32>(world, 1.0);
    out.from_eye = world - frame.eye;
    let parallel = frame.parallel > 0.5;
    let distance2 = max(dot(out.from_eye, out.from_eye), 1e-12);
    out.to_eye = select(-out.from_eye * inverseSqrt(distance2), -frame.forward, parallel);
    out.normal = select(normal, -normal, dot(normal, out.to_eye) < 0.0);
    out.height = world.y - frame.ground;
    return out;
}
