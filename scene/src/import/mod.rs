//! glTF 2.0 import: files become a [`Model`].
//!
//! The `gltf` crate reads the document and its container ([`document`]); every access to bytes is
//! checked here ([`accessor`]), because files from the wild are damaged in ways that readers which
//! validate and then trust do not survive. Damage to the file's structure is an [`ImportError`];
//! damage to a part leaves that part out and is reported in [`Model::diagnostics`].

mod accessor;
mod document;
mod extras;
mod fault;
mod federate;
mod files;
mod mesh;
mod nodes;
mod palette;
mod placing;
mod source;
#[cfg(test)]
mod tests;

pub use fault::{Fault, ImportError};
pub use federate::federate;

use crate::{Cancelled, Model, Progress};
use document::{Document, Refusal};
use palette::Palette;
use rayon::prelude::*;
use source::Source;
use std::path::Path;
use topout_schedule::{Diagnostics, Severity};

/// Extensions that may be required: those that are read, and those that change nothing here.
const READ: &[&str] = &[
    "KHR_mesh_quantization",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "EXT_mesh_gpu_instancing",
    "KHR_materials_unlit",
    "KHR_texture_transform",
    "KHR_lights_punctual",
];

/// Reads a .glb or .gltf file.
///
/// # Errors
/// See [`ImportError`]; each names the file, the place and the value.
pub fn read_model(path: &Path, progress: &Progress) -> Result<Model, ImportError> {
    let file = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    progress.begin(&format!("Reading {file}"), 0)?;
    let io = |source| ImportError::Io { path: path.to_owned(), source };
    if !std::fs::metadata(path).map_err(io)?.is_file() {
        return Err(io(std::io::Error::new(std::io::ErrorKind::InvalidInput, "not a file")));
    }
    let bytes = std::fs::read(path).map_err(io)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    parse(&bytes, folder, path, &file, progress)
}

/// Reads a file's bytes; other files are looked for in `folder`.
fn parse(
    bytes: &[u8],
    folder: &Path,
    path: &Path,
    file: &str,
    progress: &Progress,
) -> Result<Model, ImportError> {
    let invalid = |fault| ImportError::Invalid { path: path.to_owned(), fault };
    let container = document::split(bytes).map_err(invalid)?;
    let document = read_document(&container.json, path)?;
    check_extensions(&document, path)?;
    let source = Source::load(&document, container.bin.as_deref(), folder).map_err(invalid)?;
    let mut diagnostics = Diagnostics::default();
    note_ignored(&document, file, &mut diagnostics);
    let hierarchy = nodes::read(&source, file, &mut diagnostics).map_err(invalid)?;

    let (used, first_nodes) = used_meshes(&document, &hierarchy);
    mesh::check_total(&source, &used).map_err(invalid)?;
    let palette = Palette::build(&source, folder, file, &used, &mut diagnostics);
    progress.begin(&format!("Reading {file}"), used.len() as u64)?;
    let meshes: Vec<mesh::Read> = used
        .par_iter()
        .zip(&first_nodes)
        .map(|(&mesh, &node)| {
            let name = nodes::node_name(&document, node);
            let read = mesh::read(&source, &palette, &mesh::Place { file, node: &name, mesh });
            progress.advance(1)?;
            Ok(read)
        })
        .collect::<Result<_, Cancelled>>()?;

    let mut model = Model {
        name: Path::new(file).file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        materials: palette.materials,
        diagnostics,
        ..Model::default()
    };
    placing::place(&document, hierarchy, &used, meshes, file, &mut model);
    if model.elements.is_empty() {
        return Err(ImportError::Empty { path: path.to_owned(), reason: why_empty(&model) });
    }
    Ok(model)
}

fn read_document(json: &[u8], path: &Path) -> Result<Document, ImportError> {
    Document::parse(json).map_err(|refusal| match refusal {
        Refusal::Fault(fault) => ImportError::Invalid { path: path.to_owned(), fault },
        Refusal::Version(version) => ImportError::Unsupported {
            path: path.to_owned(),
            feature: format!("glTF version {version:?}"),
            hint: " (2.0 is)",
        },
    })
}

fn check_extensions(document: &Document, path: &Path) -> Result<(), ImportError> {
    match document.extensions_required.iter().find(|e| !READ.contains(&e.as_str())) {
        None => Ok(()),
        Some(name) => Err(ImportError::Unsupported {
            path: path.to_owned(),
            feature: format!("the extension {name}"),
            hint: match name.as_str() {
                "KHR_draco_mesh_compression" => {
                    "; write the file again without Draco compression (EXT_meshopt_compression is \
                     read)"
                }
                _ => "",
            },
        }),
    }
}

fn note_ignored(document: &Document, file: &str, diagnostics: &mut Diagnostics) {
    if document.animations > 0 {
        diagnostics.add(Severity::Info, "animations", file, || {
            format!("{file}: {} animations are ignored", document.animations)
        });
    }
    if let Some(i) = document.nodes.iter().position(|n| n.skin.is_some()) {
        diagnostics.add(Severity::Info, "skins", format!("nodes[{i}]"), || {
            format!("{file}: nodes[{i}]: skins are ignored, meshes are shown as modelled")
        });
    }
}

/// The meshes that are placed, in the file's order, and the first node that uses each.
fn used_meshes(document: &Document, hierarchy: &nodes::Hierarchy) -> (Vec<usize>, Vec<usize>) {
    let mut first = vec![None; document.meshes.len()];
    for placement in &hierarchy.placements {
        first[placement.mesh].get_or_insert(placement.node);
    }
    first.into_iter().enumerate().filter_map(|(m, n)| Some((m, n?))).unzip()
}

fn why_empty(model: &Model) -> String {
    match model.diagnostics.iter().find(|d| d.severity == Severity::Error) {
        Some(error) => error.message.clone(),
        None => "no node of the scene has a mesh with triangles".to_owned(),
    }
}
