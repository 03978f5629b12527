//! The one door to meshoptimizer.
//!
//! Decoding is safe on untrusted input: sizes are checked before anything is allocated, and the
//! library's decoders check the rest. What comes out may still be garbage (indices out of range).

/// How decoded vertex bytes are unpacked further.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Filter {
    /// As they are.
    None,
    /// Unit vectors in two components.
    Octahedral,
    /// Unit quaternions in three components.
    Quaternion,
    /// Floats as mantissa and exponent.
    Exponential,
    /// Colours as luma and chroma.
    Color,
}

/// No block of the vertex codec holds more bytes than this for each packed byte.
const LARGEST_RATIO: usize = 1024;

#[derive(Clone, Copy)]
struct Bytes<const N: usize>([u8; N]);

impl<const N: usize> Default for Bytes<N> {
    fn default() -> Self {
        Self([0; N])
    }
}

fn decode_fixed<const N: usize>(packed: &[u8], count: usize) -> Result<Vec<u8>, String> {
    let items = meshopt::decode_vertex_buffer::<Bytes<N>>(packed, count)
        .map_err(|e| format!("the packed vertices do not decode: {e}"))?;
    Ok(items.iter().flat_map(|b| b.0).collect())
}

/// Unpacks `count` vertices of `stride` bytes.
pub(crate) fn decode_vertices(
    packed: &[u8],
    count: usize,
    stride: usize,
    filter: Filter,
) -> Result<Vec<u8>, String> {
    if !stride.is_multiple_of(4) || !(4..=256).contains(&stride) {
        return Err(format!("a packed vertex of {stride} bytes is not possible"));
    }
    let size = count.saturating_mul(stride);
    if size > packed.len().saturating_mul(LARGEST_RATIO) {
        return Err(format!(
            "{count} vertices of {stride} bytes cannot be packed in {} bytes",
            packed.len()
        ));
    }
    macro_rules! by_stride {
        ($($n:literal)*) => {
            match stride / 4 {
                $($n => decode_fixed::<{ $n * 4 }>(packed, count),)*
                _ => Err(format!("a packed vertex of {stride} bytes is not possible")),
            }
        };
    }
    let mut bytes = by_stride!(
        1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32
        33 34 35 36 37 38 39 40 41 42 43 44 45 46 47 48 49 50 51 52 53 54 55 56 57 58 59 60 61
        62 63 64
    )?;
    unfilter(&mut bytes, stride, filter)?;
    Ok(bytes)
}

fn unfilter(bytes: &mut Vec<u8>, stride: usize, filter: Filter) -> Result<(), String> {
    let wrong = || Err(format!("filter {filter:?} does not go with {stride} bytes a vertex"));
    match (filter, stride) {
        (Filter::None, _) => {}
        (Filter::Octahedral, 4) => in_place::<[i8; 4]>(bytes, meshopt::decode_filter_oct),
        (Filter::Octahedral, 8) => in_place::<[i16; 4]>(bytes, meshopt::decode_filter_oct),
        (Filter::Quaternion, 8) => in_place::<[i16; 4]>(bytes, meshopt::decode_filter_quat),
        (Filter::Color, 4) => in_place::<[u8; 4]>(bytes, meshopt::decode_filter_color),
        (Filter::Color, 8) => in_place::<[u16; 4]>(bytes, meshopt::decode_filter_color),
        (Filter::Exponential, _) => in_place::<[u32; 1]>(bytes, meshopt::decode_filter_exp),
        _ => return wrong(),
    }
    Ok(())
}

/// Runs a filter on a copy that is aligned for it.
fn in_place<T: bytemuck::Pod>(bytes: &mut Vec<u8>, filter: impl FnOnce(&mut [T])) {
    let mut items: Vec<T> = bytemuck::pod_collect_to_vec(bytes);
    filter(&mut items);
    bytes.clear();
    bytes.extend_from_slice(bytemuck::cast_slice(&items));
}

fn index_bytes(indices: &[u32], width: usize) -> Vec<u8> {
    if width == 2 {
        indices.iter().flat_map(|&i| (i as u16).to_le_bytes()).collect()
    } else {
        indices.iter().flat_map(|&i| i.to_le_bytes()).collect()
    }
}

/// Unpacks a triangle list of `count` indices, each `width` (2 or 4) bytes.
pub(crate) fn decode_triangles(
    packed: &[u8],
    count: usize,
    width: usize,
) -> Result<Vec<u8>, String> {
    // A triangle takes at least one byte.
    if !matches!(width, 2 | 4) || !count.is_multiple_of(3) || count / 3 > packed.len() {
        return Err(format!(
            "{count} triangle indices of {width} bytes cannot be packed in {} bytes",
            packed.len()
        ));
    }
    let indices = meshopt::decode_index_buffer::<u32>(packed, count)
        .map_err(|e| format!("the packed triangles do not decode: {e}"))?;
    Ok(index_bytes(&indices, width))
}

/// Unpacks `count` indices of any topology, each `width` (2 or 4) bytes.
pub(crate) fn decode_indices(packed: &[u8], count: usize, width: usize) -> Result<Vec<u8>, String> {
    if !matches!(width, 2 | 4) || count > packed.len() {
        return Err(format!(
            "{count} indices of {width} bytes cannot be packed in {} bytes",
            packed.len()
        ));
    }
    let indices = meshopt::decode_index_sequence::<u32>(packed, count)
        .map_err(|e| format!("the packed indices do not decode: {e}"))?;
    Ok(index_bytes(&indices, width))
}

/// Which of the library's simplifiers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Way {
    /// Edge contraction by quadrics that keeps the topology.
    Default,
    /// Clustering on a grid.
    Sloppy,
}

/// Simplifies a soup as far as an error in metres allows, and says what error the library reports
/// (metres). Corners at one place are one vertex. For comparison only: the figure is no bound (R10).
pub(crate) fn simplify(
    soup: &[[glam::Vec3; 3]],
    error_m: f32,
    way: Way,
) -> (Vec<[glam::Vec3; 3]>, f32) {
    let mut places = std::collections::HashMap::new();
    let mut positions: Vec<[f32; 3]> = Vec::new();
    let indices: Vec<u32> = soup
        .iter()
        .flatten()
        .map(|corner| {
            // Adding zero makes -0 and 0 the same bits.
            let position = (*corner + glam::Vec3::ZERO).to_array();
            *places.entry(position.map(f32::to_bits)).or_insert_with(|| {
                positions.push(position);
                positions.len() as u32 - 1
            })
        })
        .collect();
    let scale = meshopt::simplify_scale_decoder(&positions).max(f32::MIN_POSITIVE);
    let (error, mut reported) = (error_m / scale, 0f32);
    let kept = match way {
        Way::Default => meshopt::simplify_decoder(
            &indices,
            &positions,
            0,
            error,
            meshopt::SimplifyOptions::None,
            Some(&mut reported),
        ),
        Way::Sloppy => {
            meshopt::simplify_sloppy_decoder(&indices, &positions, 0, error, Some(&mut reported))
        }
    };
    let triangles = kept
        .chunks_exact(3)
        .map(|t| [t[0], t[1], t[2]].map(|i| glam::Vec3::from(positions[i as usize])));
    (triangles.collect(), reported * scale)
}

/// Packing, for tests that build compressed files.
#[cfg(test)]
pub(crate) mod pack {
    /// Packs vertices.
    pub(crate) fn vertices<T: Copy>(items: &[T]) -> Vec<u8> {
        meshopt::encode_vertex_buffer(items).expect("packing cannot fail")
    }

    /// Packs a triangle list.
    pub(crate) fn triangles(indices: &[u32], vertices: usize) -> Vec<u8> {
        meshopt::encode_index_buffer(indices, vertices).expect("packing cannot fail")
    }

    /// Packs indices of any topology.
    pub(crate) fn indices(indices: &[u32], vertices: usize) -> Vec<u8> {
        meshopt::encode_index_sequence(indices, vertices).expect("packing cannot fail")
    }

    /// Unit vectors, eight bits a component.
    pub(crate) fn octahedral(normals: &[[f32; 4]]) -> Vec<[i8; 4]> {
        meshopt::encode_filter_oct(normals, 8)
    }

    /// Floats with 24 bits of mantissa.
    pub(crate) fn exponential(values: &[[f32; 3]]) -> Vec<[u32; 3]> {
        meshopt::encode_filter_exp(values, 24, meshopt::EncodeExpMode::Separate)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn vertices_of_every_stride_survive() {
        let items: Vec<[u8; 12]> = (0..300u32).map(|i| [(i * 7) as u8; 12]).collect();
        let packed = pack::vertices(&items);
        let bytes = decode_vertices(&packed, 300, 12, Filter::None).unwrap();
        assert_eq!(bytes, items.concat());
        let wide: Vec<[u8; 256]> = (0..5u8).map(|i| [i; 256]).collect();
        let packed = pack::vertices(&wide);
        assert_eq!(decode_vertices(&packed, 5, 256, Filter::None).unwrap(), wide.concat());
    }

    #[test]
    fn constant_vertices_pack_below_the_ratio_that_is_allowed() {
        let items = vec![[9u8; 16]; 1_000_000];
        let packed = pack::vertices(&items);
        assert_eq!(
            decode_vertices(&packed, items.len(), 16, Filter::None).unwrap().len(),
            16_000_000
        );
    }

    #[test]
    fn exponential_floats_come_back() {
        let values = [[1.5f32, -2.25, 1024.0], [0.0, 1e-3, 7.0]];
        let packed = pack::vertices(&pack::exponential(&values));
        let bytes = decode_vertices(&packed, 2, 12, Filter::Exponential).unwrap();
        let floats: Vec<f32> = bytemuck::pod_collect_to_vec(&bytes);
        for (a, b) in floats.iter().zip(values.concat()) {
            assert!((a - b).abs() <= 1e-6 * b.abs(), "{a} {b}");
        }
    }

    #[test]
    fn triangles_and_sequences_survive_and_keep_their_width() {
        let indices = [0u32, 1, 2, 2, 1, 3];
        let packed = pack::triangles(&indices, 4);
        let bytes = decode_triangles(&packed, 6, 4).unwrap();
        let back: Vec<u32> = bytemuck::pod_collect_to_vec(&bytes);
        // The codec may rotate a triangle but keeps its winding.
        let set = |i: &[u32]| -> Vec<Vec<u32>> {
            i.chunks(3)
                .map(|t| {
                    let k = (0..3).min_by_key(|&k| t[k]).unwrap();
                    vec![t[k], t[(k + 1) % 3], t[(k + 2) % 3]]
                })
                .collect()
        };
        assert_eq!(set(&back), set(&indices));
        let packed = pack::indices(&indices, 4);
        let bytes = decode_indices(&packed, 6, 2).unwrap();
        let back: Vec<u16> = bytemuck::pod_collect_to_vec(&bytes);
        assert_eq!(back, [0, 1, 2, 2, 1, 3]);
    }

    #[test]
    fn impossible_sizes_are_refused_before_allocating() {
        assert!(decode_vertices(&[0; 64], usize::MAX / 2, 256, Filter::None).is_err());
        assert!(decode_vertices(&[0; 64], 1 << 40, 4, Filter::None).is_err());
        assert!(decode_vertices(&[0; 64], 1, 6, Filter::None).is_err());
        assert!(decode_vertices(&[0; 64], 1, 260, Filter::None).is_err());
        assert!(decode_triangles(&[0; 64], 3 << 40, 4).is_err());
        assert!(decode_triangles(&[0; 64], 4, 4).is_err());
        assert!(decode_indices(&[0; 64], 1 << 40, 4).is_err());
        assert!(decode_vertices(&[0; 64], 4, 12, Filter::Quaternion).is_err());
        assert!(decode_vertices(&[], 0, 4, Filter::None).is_err());
    }
}
