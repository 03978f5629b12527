// The clusters' indices, of 16 or of 32 bits.
fn index_at(place: u32) -> u32 {
    if cull.index_bits == 32u {
        return indices[place];
    }
    return extractBits(indices[place >> 1u], (place & 1u) * 16u, 16u);
}
