// Where section planes cut solids, the cut is filled.
//
// A ray that comes in through a plane does so within a solid where it leaves that solid once more than it enters it
// behind the plane. So the surfaces of all cut solids are added up, what the ray leaves counted +1, what it enters
// -1: what is left of their colours is that of the solids at the cut.

struct SumOut {
    @builtin(position) clip: vec4<f32>,
    @location(0) from_eye: vec3<f32>,
    // Linear.
    @location(1) color: vec3<f32>,
}

@vertex
fn sum_vertex(in: VertexIn) -> SumOut {
    let placed = place(in);
    let color = looked(materials[in.packed >> 16u].color, in.look).rgb;
    return SumOut(placed.clip, placed.from_eye, color);
}

// Direction of the ray to what is seen at a place.
fn sight(from_eye: vec3<f32>) -> vec3<f32> {
    return select(from_eye, frame.forward, frame.parallel > 0.5);
}

fn sum(in: SumOut, leaves: bool) -> vec4<f32> {
    let ray = sight(in.from_eye);
    let at = vec4<f32>(frame.eye + in.from_eye, 1.0);
    for (var i = 0u; i < frame.planes; i++) {
        let plane = frame.section[i];
        // Only what is before the planes that the ray comes in through does not count.
        if dot(plane.xyz, ray) > 0.0 && dot(plane, at) < 0.0 {
            discard;
        }
    }
    return vec4<f32>(in.color, 1.0) * select(-1.0, 1.0, leaves);
}

@fragment
fn sum_outward_fragment(in: SumOut, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    return sum(in, !front);
}

@fragment
fn sum_inward_fragment(in: SumOut, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    return sum(in, front);
}

@group(1) @binding(0) var sums: texture_2d<f32>;

struct CapOut {
    @location(0) color: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

// Lines across the cut, so that it is told from a surface: 1 where there is one.
fn hatch(at: vec3<f32>, normal: vec3<f32>, pixel_m: f32) -> f32 {
    let level = normalize(select(cross(normal, vec3<f32>(0.0, 1.0, 0.0)), vec3<f32>(1.0, 0.0, 0.0), abs(normal.y) > 0.9));
    let steep = cross(normal, level);
    // Between 7 and 14 pixels apart, at even distances in metres.
    let apart = exp2(ceil(log2(pixel_m * 7.0)));
    let place = (dot(at, level) + dot(at, steep)) / apart;
    let off = abs(fract(place) - 0.5) * apart;
    return clamp(1.2 - off / pixel_m, 0.0, 1.0);
}

@fragment
fn cap_fragment(@builtin(position) position: vec4<f32>) -> CapOut {
    let total = textureLoad(sums, vec2<i32>(position.xy), 0);
    if total.a < 0.5 {
        discard;
    }
    let screen = (position.xy / frame.size * 2.0 - 1.0) * vec2<f32>(1.0, -1.0);
    let across = frame.right * screen.x + frame.up * screen.y;
    let parallel = frame.parallel > 0.5;
    let ray = select(frame.forward + across, frame.forward, parallel);
    let start = select(frame.eye, frame.eye + across, parallel);
    // Where the ray comes in, and where it goes out again.
    var from_depth = select(frame.near, -1e30, parallel);
    var to_depth = 1e30;
    var normal = vec3<f32>(0.0);
    for (var i = 0u; i < frame.planes; i++) {
        let plane = frame.section[i];
        let speed = dot(plane.xyz, ray);
        let height = dot(plane, vec4<f32>(start, 1.0));
        if speed > 0.0 {
            let depth = -height / speed;
            if depth > from_depth {
                from_depth = depth;
                normal = -plane.xyz;
            }
        } else if speed < 0.0 {
            to_depth = min(to_depth, -height / speed);
        } else if height < 0.0 {
            discard;
        }
    }
    if dot(normal, normal) == 0.0 || from_depth >= to_depth {
        discard;
    }
    let at = start + ray * from_depth;
    let clip = frame.clip_from_world * vec4<f32>(at, 1.0);
    let pixel_m = select(frame.pixel_m * from_depth, frame.pixel_m, parallel);
    let surface = Surface(total.rgb / total.a, 1.0, 0.0);
    let lit = shade(surface, normal, -normalize(ray), at.y - frame.ground);
    let color = lit * (0.92 - 0.42 * hatch(at, normal, pixel_m));
    return CapOut(vec4<f32>(display(color, length(at - frame.eye)), 1.0), clip.z / clip.w);
}
