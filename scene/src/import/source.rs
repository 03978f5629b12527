//! Bytes of buffers and buffer views, checked before use.

use super::document::{Compression, Document, size};
use super::fault::Fault;
use super::files::{fetch, shorten};
use crate::optimizer::{self, Filter};
use std::borrow::Cow;
use std::path::Path;
use std::sync::OnceLock;

/// The document with the bytes it refers to.
pub(super) struct Source<'a> {
    /// What the file says.
    pub document: &'a Document,
    /// Bytes of each buffer; `None` for one without data of its own (a fallback).
    buffers: Vec<Option<Cow<'a, [u8]>>>,
    /// Unpacked buffer views, made when first needed.
    unpacked: Vec<OnceLock<Result<Vec<u8>, String>>>,
}

/// Bytes of a buffer view.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    /// All of them.
    pub bytes: &'a [u8],
    /// Distance between elements, where the view gives one.
    pub stride: Option<usize>,
}

impl<'a> Source<'a> {
    /// Reads all buffers; a missing or short one is a fault that names it.
    pub fn load(
        document: &'a Document,
        bin: Option<&'a [u8]>,
        folder: &Path,
    ) -> Result<Self, Fault> {
        let mut buffers = Vec::with_capacity(document.buffers.len());
        for (i, buffer) in document.buffers.iter().enumerate() {
            let fault = |message: String| Fault::new(format!("buffers[{i}]"), message);
            let bytes = match (&buffer.uri, bin) {
                (Some(uri), _) => Some(Cow::Owned(fetch(folder, uri).map_err(fault)?)),
                (None, Some(bin)) if i == 0 && !document.is_fallback(i) => Some(Cow::Borrowed(bin)),
                (None, _) => None,
            };
            if let Some(bytes) = &bytes
                && bytes.len() < size(buffer.byte_length)
            {
                let name = buffer.uri.as_deref().map_or(Cow::Borrowed("the BIN chunk"), shorten);
                return Err(fault(format!(
                    "{name} holds {} bytes, byteLength says {}",
                    bytes.len(),
                    buffer.byte_length.0
                )));
            }
            buffers.push(bytes);
        }
        let unpacked = document.buffer_views.iter().map(|_| OnceLock::new()).collect();
        Ok(Self { document, buffers, unpacked })
    }

    fn range(
        &self,
        place: &str,
        buffer: usize,
        offset: usize,
        length: usize,
    ) -> Result<&[u8], Fault> {
        let bytes = Fault::entry(&self.buffers, "buffers", buffer, place)?;
        let bytes = bytes.as_deref().ok_or_else(|| {
            Fault::new(place, format!("buffers[{buffer}] has neither a uri nor a BIN chunk"))
        })?;
        let announced = size(self.document.buffers[buffer].byte_length);
        let bytes = &bytes[..announced.min(bytes.len())];
        offset.checked_add(length).and_then(|end| bytes.get(offset..end)).ok_or_else(|| {
            Fault::new(
                place,
                format!(
                    "bytes {offset} to {} lie outside buffers[{buffer}] of {} bytes",
                    offset.saturating_add(length),
                    bytes.len()
                ),
            )
        })
    }

    /// The bytes of a buffer view, unpacked if need be. `user` is the place that asks.
    pub fn view(&self, index: usize, user: &str) -> Result<View<'_>, Fault> {
        let view = Fault::entry(&self.document.buffer_views, "bufferViews", index, user)?;
        let place = format!("bufferViews[{index}]");
        if let Some(packed) = &self.document.packed[index] {
            let unpacked = self.unpacked[index]
                .get_or_init(|| self.unpack(&place, packed).map_err(|fault| fault.message));
            return match unpacked {
                Ok(bytes) => Ok(View { bytes, stride: Some(packed.byte_stride) }),
                Err(message) => Err(Fault::new(place, message.clone())),
            };
        }
        let offset = view.byte_offset.map_or(0, size);
        let bytes = self.range(&place, view.buffer.value(), offset, size(view.byte_length))?;
        let stride = view.byte_stride.map(|s| s.0);
        if let Some(stride) = stride
            && !(4..=252).contains(&stride)
        {
            return Err(Fault::new(place, format!("byteStride {stride} is not in 4 to 252")));
        }
        Ok(View { bytes, stride })
    }

    fn unpack(&self, place: &str, packed: &Compression) -> Result<Vec<u8>, Fault> {
        let bytes = self.range(place, packed.buffer, packed.byte_offset, packed.byte_length)?;
        let fault = |message: String| Fault::new(place, message);
        let filter = match packed.filter.as_deref() {
            None | Some("NONE") => Filter::None,
            Some("OCTAHEDRAL") => Filter::Octahedral,
            Some("QUATERNION") => Filter::Quaternion,
            Some("EXPONENTIAL") => Filter::Exponential,
            Some("COLOR") => Filter::Color,
            Some(other) => return Err(fault(format!("unknown filter {other:?}"))),
        };
        let (count, stride) = (packed.count, packed.byte_stride);
        match packed.mode.as_str() {
            "ATTRIBUTES" => optimizer::decode_vertices(bytes, count, stride, filter),
            "TRIANGLES" => optimizer::decode_triangles(bytes, count, stride),
            "INDICES" => optimizer::decode_indices(bytes, count, stride),
            other => Err(format!("unknown compression mode {other:?}")),
        }
        .map_err(fault)
    }
}
