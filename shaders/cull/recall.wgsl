// The occluders: what was seen in the frame before, of the opaque layer.

@group(0) @binding(0) var<uniform> cull: Cull;
@group(0) @binding(1) var<storage, read> items: array<Item>;
@group(0) @binding(2) var<storage, read> seen: array<u32>;
@group(0) @binding(3) var<storage, read_write> masks: array<u32>;

@compute @workgroup_size(64)
fn recall(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let slot = thread_index(id, groups);
    if slot >= cull.items {
        return;
    }
    let item = items[slot];
    let whole = 0xffffffffu >> (32u - item.count);
    let bits = (seen[item.triangle >> 5u] >> (item.triangle & 31u)) & whole;
    masks[slot] = select(0u, bits, slot < cull.opaque_items);
}
