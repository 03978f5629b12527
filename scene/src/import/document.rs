//! The parts of a glTF document that topout reads, as plain data.
//!
//! Transforms stay f64: national grid coordinates do not fit an f32. Indices are checked where they
//! are used, by the code that can name the place. Unknown fields are skipped.

use serde::Deserialize;
use serde::de::{Deserializer, Error, IgnoredAny, Unexpected, Visitor};
use serde_json::Value;
use std::fmt;

/// A whole number that is not negative; glTF allows `3.0` for `3`.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub(super) struct Whole(pub usize);

impl<'de> Deserialize<'de> for Whole {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct WholeVisitor;

        impl Visitor<'_> for WholeVisitor {
            type Value = Whole;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a whole number that is not negative")
            }

            fn visit_u64<E: Error>(self, value: u64) -> Result<Whole, E> {
                usize::try_from(value)
                    .map(Whole)
                    .map_err(|_| E::invalid_value(Unexpected::Unsigned(value), &self))
            }

            fn visit_i64<E: Error>(self, value: i64) -> Result<Whole, E> {
                let unsigned = u64::try_from(value)
                    .map_err(|_| E::invalid_value(Unexpected::Signed(value), &self))?;
                self.visit_u64(unsigned)
            }

            fn visit_f64<E: Error>(self, value: f64) -> Result<Whole, E> {
                // Beyond 2^53 a double no longer counts in ones.
                if value.fract() == 0.0 && (0.0..9_007_199_254_740_992.0).contains(&value) {
                    self.visit_u64(value as u64)
                } else {
                    Err(E::invalid_value(Unexpected::Float(value), &self))
                }
            }
        }

        deserializer.deserialize_any(WholeVisitor)
    }
}

/// The root object.
#[derive(Deserialize, Debug, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Document {
    pub asset: Asset,
    pub extensions_required: Vec<String>,
    pub scene: Option<Whole>,
    pub scenes: Vec<Scene>,
    pub nodes: Vec<Node>,
    pub meshes: Vec<Mesh>,
    pub accessors: Vec<Accessor>,
    pub buffer_views: Vec<BufferView>,
    pub buffers: Vec<Buffer>,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    pub images: Vec<Image>,
    pub animations: Vec<IgnoredAny>,
}

/// What wrote the file, and for which version.
#[derive(Deserialize, Debug, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Asset {
    pub version: String,
    pub min_version: Option<String>,
}

/// Only the version: enough to recognise a glTF 1.0 file, whose other fields differ.
#[derive(Deserialize, Debug, Default)]
#[serde(default)]
pub(super) struct Head {
    pub asset: Asset,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default)]
pub(super) struct Scene {
    pub nodes: Vec<Whole>,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default)]
pub(super) struct Node {
    pub name: Option<String>,
    pub mesh: Option<Whole>,
    pub skin: Option<IgnoredAny>,
    pub children: Vec<Whole>,
    pub matrix: Option<Vec<f64>>,
    pub translation: Option<[f64; 3]>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
    pub extras: Option<Value>,
    pub extensions: NodeExtensions,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default)]
pub(super) struct NodeExtensions {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub instancing: Option<Instancing>,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default)]
pub(super) struct Instancing {
    pub attributes: InstancingAttributes,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default, rename_all = "UPPERCASE")]
pub(super) struct InstancingAttributes {
    pub translation: Option<Whole>,
    pub rotation: Option<Whole>,
    pub scale: Option<Whole>,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default)]
pub(super) struct Mesh {
    pub primitives: Vec<Primitive>,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default)]
pub(super) struct Primitive {
    pub attributes: Attributes,
    pub indices: Option<Whole>,
    pub material: Option<Whole>,
    pub mode: Option<Whole>,
    pub targets: Vec<IgnoredAny>,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default)]
pub(super) struct Attributes {
    #[serde(rename = "POSITION")]
    pub position: Option<Whole>,
    #[serde(rename = "NORMAL")]
    pub normal: Option<Whole>,
    #[serde(rename = "COLOR_0")]
    pub color: Option<Whole>,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Accessor {
    pub buffer_view: Option<Whole>,
    pub byte_offset: Whole,
    pub component_type: Whole,
    pub normalized: bool,
    pub count: Whole,
    #[serde(rename = "type")]
    pub shape: String,
    pub sparse: Option<Sparse>,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default)]
pub(super) struct Sparse {
    pub count: Whole,
    pub indices: SparsePart,
    pub values: SparsePart,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct SparsePart {
    pub buffer_view: Whole,
    pub byte_offset: Whole,
    pub component_type: Whole,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct BufferView {
    pub buffer: Whole,
    pub byte_offset: Whole,
    pub byte_length: Whole,
    pub byte_stride: Option<Whole>,
    pub extensions: ViewExtensions,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default)]
pub(super) struct ViewExtensions {
    #[serde(rename = "EXT_meshopt_compression", alias = "KHR_meshopt_compression")]
    pub compression: Option<Compression>,
}

/// A buffer view packed by meshoptimizer; `buffer` and the bytes are those of the packed data.
#[derive(Deserialize, Debug, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Compression {
    pub buffer: Whole,
    pub byte_offset: Whole,
    pub byte_length: Whole,
    pub byte_stride: Whole,
    pub count: Whole,
    pub mode: String,
    pub filter: Option<String>,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Buffer {
    pub uri: Option<String>,
    pub byte_length: Whole,
    pub extensions: BufferExtensions,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default)]
pub(super) struct BufferExtensions {
    #[serde(rename = "EXT_meshopt_compression", alias = "KHR_meshopt_compression")]
    pub compression: Option<IgnoredAny>,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Material {
    pub name: Option<String>,
    pub pbr_metallic_roughness: Pbr,
    pub alpha_mode: Option<String>,
    pub extensions: MaterialExtensions,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default)]
pub(super) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_unlit")]
    pub unlit: Option<IgnoredAny>,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Pbr {
    pub base_color_factor: Option<[f32; 4]>,
    pub base_color_texture: Option<TextureInfo>,
    pub metallic_factor: Option<f32>,
    pub roughness_factor: Option<f32>,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default)]
pub(super) struct TextureInfo {
    pub index: Whole,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default)]
pub(super) struct Texture {
    pub source: Option<Whole>,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Image {
    pub uri: Option<String>,
    pub buffer_view: Option<Whole>,
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn whole_numbers_may_be_written_as_floats_but_not_broken_or_negative() {
        assert_eq!(serde_json::from_str::<Whole>("3.0").unwrap(), Whole(3));
        assert_eq!(serde_json::from_str::<Whole>("3").unwrap(), Whole(3));
        for bad in ["3.5", "-1", "-1.0", "1e300", "\"3\"", "null"] {
            assert!(serde_json::from_str::<Whole>(bad).is_err(), "{bad}");
        }
    }
}
