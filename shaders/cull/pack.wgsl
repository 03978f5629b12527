// Brings the indices of the triangles that are left together, in their old order.

struct Command {
    index_count: u32,
    instance_count: u32,
    first_index: u32,
    base_vertex: u32,
    first_instance: u32,
}

@group(0) @binding(0) var<uniform> cull: Cull;
@group(0) @binding(1) var<storage, read> items: array<Item>;
@group(0) @binding(2) var<storage, read> indices: array<u32>;
@group(0) @binding(3) var<storage, read> masks: array<u32>;
// For each item, how many triangles are left before it; one more at the end.
@group(0) @binding(4) var<storage, read_write> offsets: array<u32>;
@group(0) @binding(5) var<storage, read_write> packed: array<u32>;
// Opaque and transparent.
@group(0) @binding(6) var<storage, read_write> commands: array<Command, 2>;

const THREADS: u32 = 256u;
var<workgroup> sums: array<u32, 256>;

// One workgroup.
@compute @workgroup_size(256)
fn count(@builtin(local_invocation_index) thread: u32) {
    let share = (cull.items + THREADS - 1u) / THREADS;
    let first = min(thread * share, cull.items);
    let last = min(first + share, cull.items);
    var sum = 0u;
    for (var i = first; i < last; i++) {
        sum += countOneBits(masks[i]);
    }
    sums[thread] = sum;
    workgroupBarrier();
    if thread == 0u {
        var before = 0u;
        for (var i = 0u; i < THREADS; i++) {
            let here = sums[i];
            sums[i] = before;
            before += here;
        }
        offsets[cull.items] = before;
    }
    workgroupBarrier();
    var before = sums[thread];
    for (var i = first; i < last; i++) {
        offsets[i] = before;
        before += countOneBits(masks[i]);
    }
    storageBarrier();
    if thread == 0u {
        let opaque = offsets[cull.opaque_items];
        let all = offsets[cull.items];
        commands[0] = Command(opaque * 3u, 1u, 0u, 0u, 0u);
        commands[1] = Command((all - opaque) * 3u, 1u, opaque * 3u, 0u, 0u);
    }
}

@compute @workgroup_size(64)
fn pack(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let slot = thread_index(id, groups);
    if slot >= cull.items {
        return;
    }
    let item = items[slot];
    var mask = masks[slot];
    var to = offsets[slot] * 3u;
    while mask != 0u {
        let bit = countTrailingZeros(mask);
        mask &= mask - 1u;
        let at = (item.triangle + bit) * 3u;
        packed[to] = index_at(at) + item.base_vertex;
        packed[to + 1u] = index_at(at + 1u) + item.base_vertex;
        packed[to + 2u] = index_at(at + 2u) + item.base_vertex;
        to += 3u;
    }
}
