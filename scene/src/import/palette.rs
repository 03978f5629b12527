//! Materials: factors, textures' means and vertex colours brought into one table.

use super::accessor::{Attribute, Kind};
use super::document::{self, AlphaMode, Checked, Document, Semantic, attribute};
use super::files::{fetch, shorten};
use super::source::Source;
use crate::Material;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::path::Path;
use topout_schedule::{Diagnostics, Severity};

/// What [`crate::Vertex::material`] can address.
pub(super) const MOST_MATERIALS: usize = 1 << 16;

/// So many bits a channel tell all colours apart that a screen can show.
const EXACT_BITS: u32 = 24;

/// A vertex colour, sixteen bits a channel, linear.
pub(super) type Color = [u16; 4];

/// Brings a colour to sixteen bits a channel. What is not a number counts as 0.
pub(super) fn quantize(color: [f32; 4]) -> Color {
    color.map(|c| (c.clamp(0.0, 1.0) * 65535.0).round() as u16)
}

/// Finds the place of a surface in [`crate::Model::materials`].
#[derive(Debug, Default)]
pub(super) struct Palette {
    /// The table.
    pub materials: Vec<Material>,
    /// Place of each material of the file; the last one is the default material.
    plain: Vec<u16>,
    colored: HashMap<(u32, Color), u16>,
}

impl Palette {
    /// The place of a material of the file (`None`: the default one), tinted by a vertex colour.
    pub fn find(&self, material: Option<usize>, color: Option<Color>) -> u16 {
        let default = self.plain.len() - 1;
        let material = material.unwrap_or(default).min(default);
        let tinted = color.and_then(|c| self.colored.get(&(material as u32, c)));
        tinted.copied().unwrap_or(self.plain[material])
    }

    /// Builds the table for the meshes that are used.
    pub fn build(
        source: &Source<'_>,
        folder: &Path,
        file: &str,
        used_meshes: &[usize],
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let document = source.document;
        let default = document.materials.len();
        let primitives = || used_meshes.iter().flat_map(|&m| &document.meshes[m].primitives);
        let used: BTreeSet<usize> =
            primitives().map(|p| p.material.map_or(default, |m| m.value().min(default))).collect();
        let means = texture_means(source, folder, file, &used, diagnostics);
        let mut surfaces: Vec<Material> = document
            .materials
            .iter()
            .enumerate()
            .map(|(i, m)| surface(document, m, means.get(&i).copied(), i, file, diagnostics))
            .collect();
        surfaces.push(Material {
            name: String::new(),
            color: [1.0; 4],
            roughness: 1.0,
            metallic: 0.0,
            transparent: false,
        });
        let tints = vertex_colors(source, used_meshes, default);
        let mut all = surfaces.clone();
        all.extend(tints.iter().map(|&(material, color)| {
            let blend = document
                .materials
                .get(material as usize)
                .is_some_and(|m| m.alpha_mode == Checked::Valid(AlphaMode::Blend));
            tint(&surfaces[material as usize], color, blend)
        }));
        let (materials, places) = reduce(all, file, diagnostics);
        let plain = places[..=default].to_vec();
        let colored = tints.into_iter().zip(places[default + 1..].iter().copied()).collect();
        Self { materials, plain, colored }
    }
}

fn tint(surface: &Material, color: Color, blend: bool) -> Material {
    let mut tinted = surface.clone();
    for (channel, share) in tinted.color.iter_mut().zip(color) {
        *channel *= f32::from(share) / 65535.0;
    }
    if blend {
        tinted.transparent = tinted.color[3] < 1.0;
    } else {
        tinted.color[3] = 1.0;
    }
    tinted
}

fn surface(
    document: &Document,
    material: &document::Material,
    texture_mean: Option<[f32; 4]>,
    index: usize,
    file: &str,
    diagnostics: &mut Diagnostics,
) -> Material {
    let pbr = &material.pbr_metallic_roughness;
    let factor = pbr.base_color_factor.0;
    let mean = texture_mean.unwrap_or([1.0; 4]);
    let mut color: [f32; 4] = std::array::from_fn(|i| (factor[i] * mean[i]).clamp(0.0, 1.0));
    let place = || format!("materials[{index}]");
    let mut transparent = false;
    match material.alpha_mode {
        Checked::Valid(AlphaMode::Blend) => transparent = color[3] < 1.0,
        Checked::Valid(AlphaMode::Opaque) => {}
        Checked::Valid(AlphaMode::Mask) => {
            diagnostics.add(Severity::Info, "alpha-mask", place(), || {
                format!("{file}: {}: alphaMode MASK is drawn solid", place())
            })
        }
        Checked::Invalid => diagnostics.add(Severity::Warning, "alpha-mode", place(), || {
            let said = document.said(&format!("/materials/{index}/alphaMode"));
            format!("{file}: {}: alphaMode {said} is unknown, drawn solid", place())
        }),
    }
    if !transparent {
        color[3] = 1.0;
    }
    let unlit = material.extensions.as_ref().is_some_and(|e| e.unlit.is_some());
    // The format's default is metal, but files that leave it out hardly mean mirrors.
    let factor = format!("/materials/{index}/pbrMetallicRoughness/metallicFactor");
    let dull = unlit || !document.says(&factor);
    let metallic = if dull { 0.0 } else { pbr.metallic_factor.0.clamp(0.0, 1.0) };
    let roughness = if unlit { 1.0 } else { pbr.roughness_factor.0.clamp(0.0, 1.0) };
    let name = material.name.clone().unwrap_or_default();
    Material { name, color, roughness, metallic, transparent }
}

/// Mean colour of the base-colour texture of each used material that has a readable one.
fn texture_means(
    source: &Source<'_>,
    folder: &Path,
    file: &str,
    used: &BTreeSet<usize>,
    diagnostics: &mut Diagnostics,
) -> BTreeMap<usize, [f32; 4]> {
    let document = source.document;
    let mut jobs: BTreeMap<(usize, bool), Vec<usize>> = BTreeMap::new();
    let mut warn = |place: String, message: String| {
        diagnostics.add(Severity::Warning, "texture", place.clone(), || {
            format!("{file}: {place}: {message}; the plain base colour is used")
        });
    };
    for &index in used {
        let Some(material) = document.materials.get(index) else { continue };
        let Some(info) = &material.pbr_metallic_roughness.base_color_texture else { continue };
        let texture = document.textures.get(info.index.value());
        let image = texture.map(|t| t.source.value());
        match image {
            Some(image) if image < document.images.len() => {
                let by_alpha = matches!(
                    material.alpha_mode,
                    Checked::Valid(AlphaMode::Blend | AlphaMode::Mask)
                );
                jobs.entry((image, by_alpha)).or_default().push(index);
            }
            _ => warn(
                format!("materials[{index}]"),
                format!("textures[{}] has no image that is read", info.index.value()),
            ),
        }
    }
    let jobs: Vec<_> = jobs.into_iter().collect();
    let results: Vec<Result<[f32; 4], String>> = jobs
        .par_iter()
        .map(|((image, by_alpha), _)| image_mean(source, folder, *image, *by_alpha))
        .collect();
    let mut means = BTreeMap::new();
    for (((image, _), materials), result) in jobs.into_iter().zip(results) {
        match result {
            Ok(mean) => means.extend(materials.into_iter().map(|m| (m, mean))),
            Err(message) => warn(format!("images[{image}]"), message),
        }
    }
    means
}

fn image_mean(
    source: &Source<'_>,
    folder: &Path,
    index: usize,
    by_alpha: bool,
) -> Result<[f32; 4], String> {
    let image = &source.document.images[index];
    let fetched;
    let bytes = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => {
            fetched = fetch(folder, uri)?;
            &fetched[..]
        }
        (None, Some(view)) => {
            source.view(view.value(), &format!("images[{index}]")).map_err(|f| f.to_string())?.bytes
        }
        (None, None) => return Err("has neither a uri nor a bufferView".to_owned()),
    };
    let name = image.uri.as_deref().map_or("the image".into(), shorten);
    let mut reader = image::ImageReader::new(std::io::Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|e| format!("{name}: {e}"))?;
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(32_768);
    limits.max_image_height = Some(32_768);
    reader.limits(limits);
    let pixels = reader.decode().map_err(|e| format!("{name}: {e}"))?.into_rgba8();
    mean_color(pixels.pixels().map(|p| p.0), by_alpha)
        .ok_or_else(|| format!("{name}: has no pixels"))
}

/// Mean of sRGB pixels in linear light; `by_alpha` lets what is invisible not count.
fn mean_color(pixels: impl Iterator<Item = [u8; 4]>, by_alpha: bool) -> Option<[f32; 4]> {
    let linear: [f64; 256] = std::array::from_fn(|i| {
        let c = i as f64 / 255.0;
        if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    });
    let (mut sum, mut weight, mut alpha, mut count) = ([0.0f64; 3], 0.0f64, 0.0f64, 0u64);
    for [r, g, b, a] in pixels {
        let share = f64::from(a) / 255.0;
        let w = if by_alpha { share } else { 1.0 };
        for (s, c) in sum.iter_mut().zip([r, g, b]) {
            *s += linear[usize::from(c)] * w;
        }
        weight += w;
        alpha += share;
        count += 1;
    }
    if count == 0 {
        return None;
    }
    let of = |s: f64| if weight > 0.0 { (s / weight) as f32 } else { 1.0 };
    Some([of(sum[0]), of(sum[1]), of(sum[2]), (alpha / count as f64) as f32])
}

/// Every distinct pair of material and vertex colour. Accessors that cannot be read are left to
/// the code that builds meshes.
fn vertex_colors(source: &Source<'_>, used_meshes: &[usize], default: usize) -> Vec<(u32, Color)> {
    let pairs: BTreeSet<(usize, usize)> = used_meshes
        .iter()
        .flat_map(|&m| &source.document.meshes[m].primitives)
        .filter_map(|p| {
            let color = attribute(p, Semantic::Colors(0))?;
            Some((p.material.map_or(default, |m| m.value().min(default)), color))
        })
        .collect();
    let sets: Vec<HashSet<(u32, Color)>> = pairs
        .into_par_iter()
        .map(|(material, accessor)| {
            let Ok(colors) = Attribute::open(source, accessor, Kind::Color, "COLOR_0") else {
                return HashSet::new();
            };
            let color = |i| (material as u32, quantize(colors.floats(i)));
            (0..colors.count).map(color).collect()
        })
        .collect();
    let mut all: Vec<_> = sets.into_iter().flatten().collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// Brings a list of materials down to what a vertex can address; returns the table and the place
/// of each. Lists that fit are kept as they are, longer ones lose equal looks, then fine
/// differences of colour.
pub(super) fn reduce(
    all: Vec<Material>,
    file: &str,
    diagnostics: &mut Diagnostics,
) -> (Vec<Material>, Vec<u16>) {
    if all.len() <= MOST_MATERIALS {
        let places = (0..all.len()).map(|i| i as u16).collect();
        return (all, places);
    }
    for bits in [EXACT_BITS, 8, 7, 6, 5, 4, 3, 2] {
        let steps = ((1u64 << bits) - 1) as f32;
        let level = |v: f32| (v.clamp(0.0, 1.0) * steps).round() as u32;
        let mut table: HashMap<([u32; 6], bool), u16> = HashMap::new();
        let mut materials: Vec<Material> = Vec::new();
        let mut places = Vec::with_capacity(all.len());
        for material in &all {
            let [r, g, b, a] = material.color;
            let key = [r, g, b, a, material.roughness, material.metallic].map(level);
            let full = materials.len() == MOST_MATERIALS;
            let place = match table.entry((key, material.transparent)) {
                std::collections::hash_map::Entry::Occupied(known) => *known.get(),
                std::collections::hash_map::Entry::Vacant(_) if full => break,
                std::collections::hash_map::Entry::Vacant(free) => {
                    let mut kept = material.clone();
                    if bits < EXACT_BITS {
                        kept.color = [0, 1, 2, 3].map(|i| key[i] as f32 / steps);
                        // What is blended stays so, and what is solid stays solid.
                        kept.color[3] = if material.transparent { kept.color[3] } else { 1.0 };
                    }
                    materials.push(kept);
                    *free.insert((materials.len() - 1) as u16)
                }
            };
            places.push(place);
        }
        if places.len() == all.len() {
            diagnostics.add(Severity::Warning, "many-colors", file, || {
                format!(
                    "{file}: {} materials and vertex colours are drawn with {}",
                    all.len(),
                    materials.len()
                )
            });
            return (materials, places);
        }
    }
    unreachable!("two bits a channel leave at most 8192 looks")
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn plain(color: [f32; 4]) -> Material {
        Material { name: String::new(), color, roughness: 0.5, metallic: 0.0, transparent: false }
    }

    #[test]
    fn mean_is_taken_in_linear_light() {
        let mean = mean_color([[0, 0, 0, 255], [255, 255, 255, 255]].into_iter(), false).unwrap();
        assert!((mean[0] - 0.5).abs() < 1e-6);
        let mean = mean_color([[0, 0, 0, 0], [255, 0, 0, 255]].into_iter(), true).unwrap();
        assert_eq!(mean, [1.0, 0.0, 0.0, 0.5]);
        assert_eq!(mean_color(std::iter::empty(), false), None);
    }

    #[test]
    fn short_lists_are_kept_in_order() {
        let mut diagnostics = Diagnostics::default();
        let all = vec![plain([0.1; 4]), plain([0.1; 4])];
        let (materials, places) = reduce(all.clone(), "f", &mut diagnostics);
        assert_eq!((materials, places), (all, vec![0, 1]));
        assert!(diagnostics.get("many-colors").is_none());
    }

    #[test]
    fn long_lists_lose_fine_differences_only() {
        let mut diagnostics = Diagnostics::default();
        let all: Vec<Material> = (0..200_000u32)
            .map(|i| plain([(i % 1000) as f32 / 999.0, (i / 1000) as f32 / 199.0, 0.3, 1.0]))
            .collect();
        let (materials, places) = reduce(all.clone(), "f", &mut diagnostics);
        assert!(materials.len() <= MOST_MATERIALS && materials.len() > 10_000);
        for (material, &place) in all.iter().zip(&places) {
            for (a, b) in material.color.iter().zip(materials[usize::from(place)].color) {
                assert!((a - b).abs() <= 0.5 / 255.0 + 1e-6);
            }
        }
        assert_eq!(diagnostics.get("many-colors").unwrap().severity, Severity::Warning);
    }

    #[test]
    fn equal_looks_merge_before_colours_suffer() {
        let mut diagnostics = Diagnostics::default();
        let all: Vec<Material> =
            (0..70_000u32).map(|i| plain([(i % 7) as f32 / 7.0, 0.0, 0.0, 1.0])).collect();
        let (materials, places) = reduce(all.clone(), "f", &mut diagnostics);
        assert_eq!(materials.len(), 7);
        assert!(all.iter().zip(&places).all(|(m, &p)| *m == materials[usize::from(p)]));
    }
}
