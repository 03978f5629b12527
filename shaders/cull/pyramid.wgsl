// The depth pyramid: what is farthest in blocks of 2, 4, 8, ... pixels.

@group(0) @binding(0) var<uniform> cull: Cull;
@group(0) @binding(2) var<storage, read_write> pyramid: array<f32>;

const NOTHING: f32 = 3.0e38;

fn load(level: u32, at: vec2<u32>) -> f32 {
    if any(at >= cull.levels[level].yz) {
        return NOTHING;
    }
    if level == 0u {
        return farthest(vec2<i32>(at));
    }
    return pyramid[cull.levels[level].x + at.y * cull.levels[level].y + at.x];
}

fn store(level: u32, at: vec2<u32>, depth: f32) {
    if all(at < cull.levels[level].yz) {
        pyramid[cull.levels[level].x + at.y * cull.levels[level].y + at.x] = depth;
    }
}

// A block of 8 x 8 texels of a level makes part of the next three.
fn reduce(level: u32, block: vec2<u32>) {
    if any((block << vec2<u32>(level + 3u)) >= cull.high) {
        return;
    }
    var eighth = NOTHING;
    for (var q = 0u; q < 4u; q++) {
        let quarter = block * 2u + vec2<u32>(q & 1u, q >> 1u);
        var fourth = NOTHING;
        for (var h = 0u; h < 4u; h++) {
            let half = quarter * 2u + vec2<u32>(h & 1u, h >> 1u);
            let at = half * 2u;
            let depth = min(
                min(load(level, at), load(level, at + vec2<u32>(1u, 0u))),
                min(load(level, at + vec2<u32>(0u, 1u)), load(level, at + vec2<u32>(1u, 1u))),
            );
            store(level + 1u, half, depth);
            fourth = min(fourth, depth);
        }
        store(level + 2u, quarter, fourth);
        eighth = min(eighth, fourth);
    }
    store(level + 3u, block, eighth);
}

@compute @workgroup_size(8, 8)
fn pyramid_fine(@builtin(global_invocation_id) id: vec3<u32>) {
    reduce(0u, (cull.low >> vec2<u32>(3u)) + id.xy);
}

@compute @workgroup_size(8, 8)
fn pyramid_coarse(@builtin(global_invocation_id) id: vec3<u32>) {
    reduce(3u, (cull.low >> vec2<u32>(6u)) + id.xy);
}
