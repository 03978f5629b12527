// What the kernels share that leave out triangles which nobody sees. The twin of CullUniform in
// render/src/cull/gpu.rs.

struct Cull {
    // Part of the picture that the scene can cover, pixels: first, and one past the last.
    low: vec2<u32>,
    high: vec2<u32>,
    // Entries of `items`; those of the opaque layer come first.
    items: u32,
    opaque_items: u32,
    // Samples a pixel.
    samples: u32,
    // Of the clusters' indices: 16 or 32.
    index_bits: u32,
    // Of the depth pyramid's levels: first texel, width and height. Level 0 is the depth itself.
    levels: array<vec4<u32>, 8>,
}

// At most 32 triangles that follow each other, all in one word of the table of bits.
struct Item {
    // Index of the first triangle.
    triangle: u32,
    count: u32,
    // Added to the indices.
    base_vertex: u32,
}

// Rows of workgroups of 64 threads, one after the other.
fn thread_index(id: vec3<u32>, groups: vec3<u32>) -> u32 {
    return id.y * groups.x * 64u + id.x;
}
