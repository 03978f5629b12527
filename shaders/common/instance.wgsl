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
}

struct VertexOut {
    @builtin(position) clip: vec4<f32>,
    // Metres from the eye, in the directions of the world.
    @location(0) from_eye: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) @interpolate(flat, either) material: u32,
}

fn decode_normal(packed: u32) -> vec3<f32> {
    let p = unpack4x8snorm(packed).xy;
    var n = vec3<f32>(p, 1.0 - abs(p.x) - abs(p.y));
    let fold = max(-n.z, 0.0);
    n.x -= select(-fold, fold, n.x >= 0.0);
    n.y -= select(-fold, fold, n.y >= 0.0);
    return n;
}

@vertex
fn vertex(in: VertexIn) -> VertexOut {
    let p = vec4<f32>(in.position, 1.0);
    let world = vec3<f32>(dot(in.row_x, p), dot(in.row_y, p), dot(in.row_z, p));
    // Normals go by the cofactors: right for any stretching; a mirror's sign is settled later.
    let n = decode_normal(in.packed);
    let x = in.row_x.xyz;
    let y = in.row_y.xyz;
    let z = in.row_z.xyz;
    var out: VertexOut;
    out.clip = frame.clip_from_world * vec4<f32>(world, 1.0);
    out.from_eye = world - frame.eye;
    out.normal = vec3<f32>(dot(cross(y, z), n), dot(cross(z, x), n), dot(cross(x, y), n));
    out.material = in.packed >> 16u;
    return out;
}

fn to_eye(from_eye: vec3<f32>) -> vec3<f32> {
    return select(-normalize(from_eye), -frame.forward, frame.parallel > 0.5);
}

// The interpolated normal, on that side of the actual triangle which the eye sees.
fn facing_normal(v: VertexOut, view: vec3<f32>) -> vec3<f32> {
    let face = cross(dpdx(v.from_eye), dpdy(v.from_eye));
    let same_side = dot(face, view) * dot(face, v.normal);
    return normalize(select(v.normal, -v.normal, same_side < 0.0));
}
