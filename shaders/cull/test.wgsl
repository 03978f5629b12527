// Which triangles may be seen: one that covers a pixel (or sample) at which nothing of the occluders is
// nearer.

@group(0) @binding(3) var<uniform> cull: Cull;
@group(0) @binding(2) var<storage, read> pyramid: array<f32>;
@group(0) @binding(4) var<storage, read> items: array<Item>;
// Four words each, the first three are the position.
@group(0) @binding(5) var<storage, read> vertices: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> indices: array<u32>;
@group(0) @binding(7) var<storage, read_write> masks: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read_write> seen: array<atomic<u32>>;

// Rasterizers move corners to a grid, of 1/16 pixel at the coarsest, and clip space is rounded.
const SNAP_PX: f32 = 0.0625;
// Relative, what depths may differ by because of rounding.
const DEPTH_SLACK: f32 = 1.00001;
// Pixels across, below which they are looked at one by one.
const SMALL: i32 = 4;

fn corner(index: u32) -> vec4<f32> {
    return frame.clip_from_world * vec4<f32>(vertices[index].xyz, 1.0);
}

// Whether p lies on the inner side of the edge, or at most SNAP_PX outside along either axis. `turn`: 1
// where the triangle turns left in the picture's axes, else -1.
fn inside(a: vec2<f32>, b: vec2<f32>, p: vec2<f32>, turn: f32) -> bool {
    let edge = b - a;
    let side = (edge.x * (p.y - a.y) - edge.y * (p.x - a.x)) * turn;
    return side >= -SNAP_PX * (abs(edge.x) + abs(edge.y));
}

// At the near or far plane.
fn clipped(v: vec4<f32>) -> bool {
    return v.z > v.w || v.z < 0.0;
}

fn may_be_seen(triangle: u32, base: u32) -> bool {
    let at = triangle * 3u;
    let a = corner(base + index_at(at));
    let b = corner(base + index_at(at + 1u));
    let c = corner(base + index_at(at + 2u));
    if clipped(a) || clipped(b) || clipped(c) {
        return true;
    }
    let half = vec2<f32>(0.5, -0.5) * frame.size;
    let p = a.xy / a.w * half + 0.5 * frame.size;
    let q = b.xy / b.w * half + 0.5 * frame.size;
    let r = c.xy / c.w * half + 0.5 * frame.size;
    // Centres of pixels lie at halves; several samples may lie anywhere in a pixel.
    let reach = select(SNAP_PX, 0.5 + SNAP_PX, cull.samples > 1u);
    let low_px = min(p, min(q, r)) - (0.5 + reach);
    let high_px = max(p, max(q, r)) - (0.5 - reach);
    if any(high_px < vec2<f32>(0.0)) || any(low_px > frame.size - 1.0) {
        return false;
    }
    let low = vec2<i32>(ceil(max(low_px, vec2<f32>(0.0))));
    let high = vec2<i32>(floor(min(high_px, frame.size - 1.0)));
    if any(low > high) {
        return false;
    }
    let near = max(a.z / a.w, max(b.z / b.w, c.z / c.w)) * DEPTH_SLACK;
    let extent = high - low;
    if all(extent < vec2<i32>(SMALL)) {
        let across = q - p;
        let over = r - p;
        let turn = select(-1.0, 1.0, across.x * over.y - across.y * over.x > 0.0);
        for (var y = low.y; y <= high.y; y++) {
            for (var x = low.x; x <= high.x; x++) {
                let middle = vec2<f32>(f32(x), f32(y)) + 0.5;
                let covered = cull.samples > 1u
                    || (inside(p, q, middle, turn) && inside(q, r, middle, turn) && inside(r, p, middle, turn));
                if covered && farthest(vec2<i32>(x, y)) <= near {
                    return true;
                }
            }
        }
        return false;
    }
    var level = 1u;
    while level < 6u && any((high >> vec2<u32>(level)) - (low >> vec2<u32>(level)) > vec2<i32>(3)) {
        level += 1u;
    }
    let first = low >> vec2<u32>(level);
    let last = high >> vec2<u32>(level);
    let start = cull.levels[level].x;
    let width = cull.levels[level].y;
    for (var y = first.y; y <= last.y; y++) {
        for (var x = first.x; x <= last.x; x++) {
            if pyramid[start + u32(y) * width + u32(x)] <= near {
                return true;
            }
        }
    }
    return false;
}

@compute @workgroup_size(64)
fn test_triangles(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let thread = thread_index(id, groups);
    let slot = thread >> 5u;
    let bit = thread & 31u;
    if slot >= cull.items {
        return;
    }
    let item = items[slot];
    if bit >= item.count {
        return;
    }
    let triangle = item.triangle + bit;
    if may_be_seen(triangle, item.base_vertex) {
        atomicOr(&masks[slot], 1u << bit);
        atomicOr(&seen[triangle >> 5u], 1u << (triangle & 31u));
    }
}
