//! Checked reading of accessors straight from the bytes, without copying them.

use super::document::{Checked, ComponentType as Component, Type, size};
use super::fault::Fault;
use super::source::Source;

/// An accessor without bytes is all zeros; more of them than this is not credible.
const MOST_ZEROS: usize = 1 << 20;

/// What an attribute may hold.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Kind {
    /// Three floats, or integers (KHR_mesh_quantization).
    Vec3,
    /// Three or four components in [0, 1].
    Color,
    /// Four floats or normalised integers.
    Vec4,
    /// Unsigned integers.
    Index,
}

/// Typed elements in bytes. Every element up to `count` is known to lie within the bytes.
pub(super) struct Attribute<'a> {
    /// Which accessor, for messages.
    pub accessor: usize,
    /// Number of elements.
    pub count: usize,
    bytes: Option<&'a [u8]>,
    stride: usize,
    component: Component,
    width: usize,
    normalized: bool,
    overrides: Overrides<'a>,
}

/// Sparse substitution: sorted element numbers and their values.
#[derive(Default)]
struct Overrides<'a> {
    elements: Vec<u32>,
    values: &'a [u8],
}

/// The bytes of `count` elements of `size` bytes, `stride` apart, from `offset` on.
fn elements<'a>(
    bytes: &'a [u8],
    place: &str,
    offset: usize,
    count: usize,
    stride: usize,
    size: usize,
) -> Result<&'a [u8], Fault> {
    let needed = match count {
        0 => Some(0),
        n => (n - 1).checked_mul(stride).and_then(|b| b.checked_add(size)),
    };
    needed.and_then(|n| offset.checked_add(n)).and_then(|end| bytes.get(offset..end)).ok_or_else(
        || {
            Fault::new(
                place,
                format!(
                    "{count} elements of {size} bytes, {stride} apart from byte {offset}, do not \
                     fit the buffer view of {} bytes",
                    bytes.len()
                ),
            )
        },
    )
}

impl<'a> Attribute<'a> {
    /// Opens an accessor; `user` is the place that refers to it.
    pub fn open(
        source: &'a Source<'_>,
        index: usize,
        kind: Kind,
        user: &str,
    ) -> Result<Self, Fault> {
        let accessor = Fault::entry(&source.document.accessors, "accessors", index, user)?;
        let place = format!("accessors[{index}]");
        let fault = |message: String| Fault::new(place.clone(), message);
        let said = |field: &str| source.document.said(&format!("/accessors/{index}/{field}"));
        let Checked::Valid(component) = accessor.component_type else {
            return Err(fault(format!("componentType {} does not exist", said("componentType"))));
        };
        let component = component.0;
        let (width, shape) = match accessor.type_ {
            Checked::Valid(Type::Scalar) => (1, "SCALAR"),
            Checked::Valid(Type::Vec3) => (3, "VEC3"),
            Checked::Valid(Type::Vec4) => (4, "VEC4"),
            _ => return Err(fault(format!("type {} cannot be used by {user}", said("type")))),
        };
        use Component as C;
        let fits = match kind {
            Kind::Vec3 => width == 3 && component != C::U32,
            Kind::Vec4 => width == 4 && matches!(component, C::F32 | C::I8 | C::I16),
            Kind::Color => width >= 3 && matches!(component, C::F32 | C::U8 | C::U16),
            Kind::Index => width == 1 && matches!(component, C::U8 | C::U16 | C::U32),
        };
        if !fits {
            return Err(fault(format!(
                "type {shape} with componentType {} cannot be used by {user}",
                component.as_gl_enum()
            )));
        }
        let bytes_each = component.size() * width;
        let count = size(accessor.count);
        if u32::try_from(count).is_err() {
            return Err(fault(format!("count {count} is too large")));
        }
        let mut stride = bytes_each;
        let bytes = match accessor.buffer_view {
            Some(view) => {
                let view = source.view(view.value(), &place)?;
                stride = view.stride.unwrap_or(bytes_each);
                if stride < bytes_each {
                    return Err(fault(format!("byteStride {stride} is below {bytes_each} bytes")));
                }
                let offset = accessor.byte_offset.map_or(0, size);
                Some(elements(view.bytes, &place, offset, count, stride, bytes_each)?)
            }
            None if count > MOST_ZEROS => {
                return Err(fault(format!("count {count} is too large without a bufferView")));
            }
            None => None,
        };
        let overrides = Self::open_sparse(source, index, count, bytes_each)?;
        // A colour is always a share of one; other attributes say so themselves.
        let normalized = accessor.normalized || kind == Kind::Color || kind == Kind::Vec4;
        Ok(Self { accessor: index, count, bytes, stride, component, width, normalized, overrides })
    }

    fn open_sparse(
        source: &'a Source<'_>,
        index: usize,
        count: usize,
        bytes_each: usize,
    ) -> Result<Overrides<'a>, Fault> {
        let Some(sparse) = &source.document.accessors[index].sparse else {
            return Ok(Overrides::default());
        };
        let place = format!("accessors[{index}].sparse");
        let fault = |message: String| Fault::new(place.clone(), message);
        let Checked::Valid(component) = sparse.indices.component_type else {
            let pointer = format!("/accessors/{index}/sparse/indices/componentType");
            let said = source.document.said(&pointer);
            return Err(fault(format!("componentType {said} is no index")));
        };
        let component = component.0;
        let n = size(sparse.count);
        if n > count {
            return Err(fault(format!("count {n} exceeds the accessor's {count}")));
        }
        let width = component.size();
        let view = source.view(sparse.indices.buffer_view.value(), &place)?;
        let raw = elements(view.bytes, &place, size(sparse.indices.byte_offset), n, width, width)?;
        let numbers: Vec<u32> = (0..n).map(|i| read_index(&raw[i * width..], component)).collect();
        if !numbers.is_sorted_by(|a, b| a < b) {
            return Err(fault("indices do not increase".to_owned()));
        }
        if let Some(&last) = numbers.last()
            && last as usize >= count
        {
            return Err(fault(format!("index {last} is out of range, there are {count}")));
        }
        let view = source.view(sparse.values.buffer_view.value(), &place)?;
        let offset = size(sparse.values.byte_offset);
        let values = elements(view.bytes, &place, offset, n, bytes_each, bytes_each)?;
        Ok(Overrides { elements: numbers, values })
    }

    /// The bytes of one element; `None` reads as zeros.
    fn element(&self, index: usize) -> Option<&'a [u8]> {
        assert!(index < self.count, "elements are asked for within the count");
        if !self.overrides.elements.is_empty()
            && let Ok(at) = self.overrides.elements.binary_search(&(index as u32))
        {
            return Some(&self.overrides.values[at * self.component.size() * self.width..]);
        }
        self.bytes.map(|bytes| &bytes[index * self.stride..])
    }

    /// The first `N` components of an element; those it lacks are 1 (the alpha of a colour).
    pub fn floats<const N: usize>(&self, index: usize) -> [f32; N] {
        let Some(bytes) = self.element(index) else {
            return [0.0; N];
        };
        let size = self.component.size();
        std::array::from_fn(|i| {
            if i < self.width {
                read_float(&bytes[i * size..], self.component, self.normalized)
            } else {
                1.0
            }
        })
    }

    /// An element of an index accessor.
    pub fn index(&self, index: usize) -> u32 {
        self.element(index).map_or(0, |bytes| read_index(bytes, self.component))
    }
}

fn read_float(bytes: &[u8], component: Component, normalized: bool) -> f32 {
    let (value, scale) = match component {
        Component::F32 => return f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        Component::U32 => {
            return u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as f32;
        }
        Component::I8 => (f32::from(bytes[0] as i8), 127.0),
        Component::U8 => (f32::from(bytes[0]), 255.0),
        Component::I16 => (f32::from(i16::from_le_bytes([bytes[0], bytes[1]])), 32767.0),
        Component::U16 => (f32::from(u16::from_le_bytes([bytes[0], bytes[1]])), 65535.0),
    };
    if normalized { (value / scale).max(-1.0) } else { value }
}

fn read_index(bytes: &[u8], component: Component) -> u32 {
    match component {
        Component::U8 => u32::from(bytes[0]),
        Component::U16 => u32::from(u16::from_le_bytes([bytes[0], bytes[1]])),
        _ => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
    }
}
