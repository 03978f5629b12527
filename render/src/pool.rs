//! Geometry on the GPU: unique meshes, instances, materials, and the clusters beside them.

use crate::gpu::{Gpu, GpuError};
use bytemuck::{Pod, Zeroable};
use glam::Affine3A;
use std::ops::Range;
use topout_scene::hdlod::Indices;
use topout_scene::{Hdlod, Material, Mesh, Scene, Vertex, hdlod};
use topout_schedule::Look;
use wgpu::util::DrawIndexedIndirectArgs;
use wgpu::{BufferUsages, IndexFormat};

/// Bytes of one vertex.
pub(crate) const VERTEX_BYTES: u64 = size_of::<Vertex>() as u64;
/// Bytes of one instance.
pub(crate) const INSTANCE_BYTES: u64 = size_of::<InstanceRow>() as u64;

/// world_from_mesh as three rows, one per instance.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct InstanceRow {
    pub rows: [[f32; 4]; 3],
}

impl From<&Affine3A> for InstanceRow {
    fn from(a: &Affine3A) -> Self {
        let (m, t) = (a.matrix3, a.translation);
        let row = |i: usize| [m.x_axis[i], m.y_axis[i], m.z_axis[i], t[i]];
        Self { rows: [row(0), row(1), row(2)] }
    }
}

/// The twin of `Material` in `shaders/common/instance.wgsl`; a test compares the two.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct MaterialRow {
    pub color: [f32; 4],
    pub roughness: f32,
    pub metallic: f32,
    pub padding: [f32; 2],
}

impl From<&Material> for MaterialRow {
    fn from(m: &Material) -> Self {
        Self { color: m.color, roughness: m.roughness, metallic: m.metallic, padding: [0.0; 2] }
    }
}

/// Vertices and indices in two buffers.
#[derive(Debug)]
pub(crate) struct Geometry {
    pub vertices: wgpu::Buffer,
    pub indices: wgpu::Buffer,
    /// 16 bits where they do.
    pub format: IndexFormat,
    /// Whether kernels can read both.
    pub readable: bool,
    vertex_count: usize,
    index_count: usize,
}

/// Where a unique mesh lies in the pool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MeshRange {
    pub base_vertex: u32,
    pub first_index: u32,
    /// Indices of the opaque triangles, which come first.
    pub opaque: u32,
    /// Indices of the transparent triangles, which follow.
    pub transparent: u32,
}

/// Everything that the draw commands of a scene refer to.
///
/// The clusters of an HDLOD have buffers of their own beside those of the scene: they come and go
/// without a copy of the scene's geometry, and each buffer stays below the adapter's limit for
/// longer. They share instances and materials with it.
#[derive(Debug)]
pub(crate) struct Pool {
    pub scene: Geometry,
    pub clusters: Option<Geometry>,
    /// One [`InstanceRow`] per model instance, then the identity for clusters, once for each look.
    pub instances: wgpu::Buffer,
    /// How each of these looks, see [`look_word`].
    pub looks: wgpu::Buffer,
    pub materials: wgpu::Buffer,
    pub meshes: Vec<MeshRange>,
    /// Index of the first identity in `instances`; that of a look is so many after it.
    pub identity: u32,
}

/// Bytes of the word of one instance.
pub(crate) const LOOK_BYTES: u64 = 4;

/// A look for the shaders, see `looked` in `shaders/common/instance.wgsl`; 0 is an element's own.
pub(crate) fn look_word(look: &Look) -> u32 {
    let linear = |gamma: u8| {
        let c = f32::from(gamma) / 255.0;
        if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    // The shader squares it again.
    let root = |gamma: u8| (linear(gamma).sqrt() * 255.0).round() as u8;
    let opacity = (look.opacity.clamp(0.0, 1.0) * 127.0).round() as u8;
    match look.color {
        None if !look.is_see_through() => 0,
        None => u32::from_le_bytes([0, 0, 0, opacity.max(1)]),
        Some(color) => {
            let [r, g, b] = color.map(root);
            u32::from_le_bytes([r, g, b, opacity.max(1) | 0x80])
        }
    }
}

impl Geometry {
    fn new(
        gpu: &Gpu,
        labels: [&'static str; 2],
        vertices: u64,
        indices: u64,
        format: IndexFormat,
    ) -> Result<Self, GpuError> {
        // A command's base vertex is an i32, its first index a u32.
        let check = |what, count: u64, limit: u64| {
            if count > limit {
                return Err(GpuError::TooBig { what, bytes: count * 4, limit: limit * 4 });
            }
            Ok(())
        };
        check(labels[0], vertices, i32::MAX as u64)?;
        check(labels[1], indices, u64::from(u32::MAX))?;
        let limit = gpu.device.limits().max_storage_buffer_binding_size;
        // Writes and kernels take whole words.
        let index_bytes = (indices * u64::from(format.byte_size())).next_multiple_of(4);
        let readable = vertices * VERTEX_BYTES <= limit && index_bytes <= limit;
        let storage = if readable { BufferUsages::STORAGE } else { BufferUsages::empty() };
        let usage = BufferUsages::COPY_DST | storage;
        Ok(Self {
            readable,
            vertices: gpu.buffer(
                labels[0],
                vertices * VERTEX_BYTES,
                usage | BufferUsages::VERTEX,
            )?,
            indices: gpu.buffer(labels[1], index_bytes, usage | BufferUsages::INDEX)?,
            format,
            vertex_count: vertices as usize,
            index_count: indices as usize,
        })
    }

    /// Bits of one index.
    pub fn index_bits(&self) -> u32 {
        8 * self.format.byte_size()
    }

    fn bytes(&self) -> u64 {
        self.vertices.size() + self.indices.size()
    }
}

impl Pool {
    /// Of the scene or of the clusters: what commands read.
    pub fn set_buffers(&self, pass: &mut wgpu::RenderPass<'_>, geometry: &Geometry) {
        pass.set_vertex_buffer(0, geometry.vertices.slice(..));
        pass.set_vertex_buffer(1, self.instances.slice(..));
        pass.set_vertex_buffer(2, self.looks.slice(..));
        pass.set_index_buffer(geometry.indices.slice(..), geometry.format);
    }

    /// Carries out commands one by one.
    pub fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        geometry: &Geometry,
        commands: &[DrawIndexedIndirectArgs],
    ) {
        if commands.is_empty() {
            return;
        }
        self.set_buffers(pass, geometry);
        for c in commands {
            let indices = c.first_index..c.first_index + c.index_count;
            let instance = c.first_instance..c.first_instance + 1;
            pass.draw_indexed(indices, c.base_vertex, instance);
        }
    }

    /// Uploads a scene.
    ///
    /// # Errors
    /// If it does not fit on the device.
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, GpuError> {
        let model = &scene.model;
        let meshes = mesh_ranges(&model.meshes)?;
        let count = |f: fn(&Mesh) -> usize| model.meshes.iter().map(|m| f(m) as u64).sum::<u64>();
        let short = model.meshes.iter().all(|m| m.vertices.len() <= usize::from(u16::MAX));
        let geometry = Geometry::new(
            gpu,
            ["scene vertices", "scene indices"],
            count(|m| m.vertices.len()),
            count(|m| m.indices.len()),
            if short { IndexFormat::Uint16 } else { IndexFormat::Uint32 },
        )?;
        let usage = BufferUsages::COPY_DST;
        let instances = model.instances.len() as u64 + 1;
        let [instances, looks] =
            [("instances", INSTANCE_BYTES), ("looks", LOOK_BYTES)].map(|(label, bytes)| {
                gpu.buffer(
                    label,
                    instances * bytes,
                    usage | BufferUsages::VERTEX | BufferUsages::COPY_SRC,
                )
            });
        let (instances, looks) = (instances?, looks?);
        // Those of the model, then those that clusters mix of them.
        let blends = hdlod::blends(model.materials.len());
        let rows: Vec<MaterialRow> =
            model.materials.iter().chain(&blends).map(MaterialRow::from).collect();
        let material_bytes = rows.len().max(1) * size_of::<MaterialRow>();
        let materials =
            gpu.buffer("materials", material_bytes as u64, usage | BufferUsages::STORAGE)?;

        let mut upload = Upload::new(gpu, &geometry.vertices);
        model.meshes.iter().for_each(|m| upload.push(&m.vertices));
        upload.finish();
        let mut upload = Upload::new(gpu, &geometry.indices);
        for mesh in &model.meshes {
            if short {
                let indices: Vec<u16> = mesh.indices.iter().map(|&i| i as u16).collect();
                upload.push(&indices);
            } else {
                upload.push(&mesh.indices);
            }
        }
        upload.finish();
        let mut upload = Upload::new(gpu, &instances);
        for instance in &model.instances {
            upload.push(&[InstanceRow::from(&instance.world_from_mesh)]);
        }
        upload.push(&[InstanceRow::from(&Affine3A::IDENTITY)]);
        upload.finish();
        let mut upload = Upload::new(gpu, &materials);
        upload.push(&rows);
        upload.finish();

        let identity = model.instances.len() as u32;
        Ok(Self { scene: geometry, clusters: None, instances, looks, materials, meshes, identity })
    }

    /// Takes the looks that there may be: all instances look as they are, and the identities are there
    /// for each of them.
    ///
    /// # Errors
    /// If they do not fit on the device; everything stays as it was then.
    pub fn set_palette(&mut self, gpu: &Gpu, palette: &[Look]) -> Result<(), GpuError> {
        let usage = BufferUsages::COPY_DST | BufferUsages::COPY_SRC | BufferUsages::VERTEX;
        let (own, count) = (u64::from(self.identity), palette.len().max(1));
        let rows = own + count as u64;
        let looks = gpu.buffer("looks", rows * LOOK_BYTES, usage)?;
        if self.instances.size() != rows * INSTANCE_BYTES {
            let instances = gpu.buffer("instances", rows * INSTANCE_BYTES, usage)?;
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            let bytes = own * INSTANCE_BYTES;
            encoder.copy_buffer_to_buffer(&self.instances, 0, &instances, 0, bytes);
            gpu.queue.submit([encoder.finish()]);
            let mut upload = Upload::new(gpu, &instances);
            upload.offset = bytes;
            upload.push(&vec![InstanceRow::from(&Affine3A::IDENTITY); count]);
            upload.finish();
            self.instances = instances;
        }
        // A new buffer holds zeros.
        let words: Vec<u32> = palette.iter().map(look_word).collect();
        let mut upload = Upload::new(gpu, &looks);
        upload.offset = own * LOOK_BYTES;
        upload.push(&words);
        upload.finish();
        self.looks = looks;
        Ok(())
    }

    /// Adds the geometry of clusters, in place of what was there before.
    ///
    /// # Errors
    /// If it does not fit on the device; there are no clusters then.
    pub fn set_clusters(&mut self, gpu: &Gpu, hdlod: &Hdlod) -> Result<(), GpuError> {
        self.clusters = None;
        let geometry = Geometry::new(
            gpu,
            ["cluster vertices", "cluster indices"],
            hdlod.vertices.len() as u64,
            hdlod.indices.len() as u64,
            format_of(&hdlod.indices),
        )?;
        let mut upload = Upload::new(gpu, &geometry.vertices);
        upload.push(&hdlod.vertices);
        upload.finish();
        let mut upload = Upload::new(gpu, &geometry.indices);
        upload.push(hdlod.indices.bytes(0..hdlod.indices.len()));
        upload.finish();
        self.clusters = Some(geometry);
        Ok(())
    }

    /// Sends parts of the indices of clusters whose vertices and number of indices are those that are
    /// there; false if they cannot be.
    pub fn update_clusters(&mut self, gpu: &Gpu, hdlod: &Hdlod, dirty: &[Range<usize>]) -> bool {
        let Some(clusters) = &self.clusters else { return false };
        if clusters.vertex_count != hdlod.vertices.len()
            || clusters.index_count != hdlod.indices.len()
            || clusters.format != format_of(&hdlod.indices)
        {
            return false;
        }
        for range in dirty {
            // From one whole word to another, as far as there are any.
            let start = range.start & !1;
            let end = range.end.next_multiple_of(2).min(hdlod.indices.len());
            let mut upload = Upload::new(gpu, &clusters.indices);
            upload.offset = (start * hdlod.indices.width()) as u64;
            upload.push(hdlod.indices.bytes(start..end));
            upload.finish();
        }
        true
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.scene.bytes()
            + self.clusters.as_ref().map_or(0, Geometry::bytes)
            + self.instances.size()
            + self.looks.size()
            + self.materials.size()
    }
}

fn format_of(indices: &Indices) -> IndexFormat {
    match indices {
        Indices::Short(_) => IndexFormat::Uint16,
        Indices::Long(_) => IndexFormat::Uint32,
    }
}

/// Meshes one after the other.
fn mesh_ranges(meshes: &[Mesh]) -> Result<Vec<MeshRange>, GpuError> {
    let (mut base_vertex, mut first_index) = (0u64, 0u64);
    let too_big = |what, bytes| GpuError::TooBig { what, bytes, limit: u64::from(u32::MAX) };
    meshes
        .iter()
        .map(|mesh| {
            let range = MeshRange {
                base_vertex: u32::try_from(base_vertex)
                    .map_err(|_| too_big("scene vertices", base_vertex * VERTEX_BYTES))?,
                first_index: u32::try_from(first_index)
                    .map_err(|_| too_big("scene indices", first_index * 4))?,
                opaque: mesh.opaque,
                transparent: mesh.indices.len() as u32 - mesh.opaque,
            };
            base_vertex += mesh.vertices.len() as u64;
            first_index += mesh.indices.len() as u64;
            Ok(range)
        })
        .collect()
}

/// Fills a buffer piece by piece, so that many small meshes make few writes and a huge table does
/// not exist twice on the way.
struct Upload<'a> {
    gpu: &'a Gpu,
    buffer: &'a wgpu::Buffer,
    staging: Vec<u8>,
    offset: u64,
}

impl<'a> Upload<'a> {
    /// 8 MiB a write.
    const PIECE: usize = 8 << 20;

    fn new(gpu: &'a Gpu, buffer: &'a wgpu::Buffer) -> Self {
        Self { gpu, buffer, staging: Vec::new(), offset: 0 }
    }

    fn push<T: Pod>(&mut self, items: &[T]) {
        for piece in bytemuck::cast_slice(items).chunks(Self::PIECE) {
            if self.staging.len() + piece.len() > Self::PIECE {
                self.flush();
            }
            self.staging.extend_from_slice(piece);
        }
    }

    fn flush(&mut self) {
        if !self.staging.is_empty() {
            self.gpu.queue.write_buffer(self.buffer, self.offset, &self.staging);
            self.offset += self.staging.len() as u64;
            self.staging.clear();
            // Sends the write on its way, else all pieces pile up in staging memory.
            self.gpu.queue.submit([]);
        }
    }

    fn finish(mut self) {
        // A write is of whole words.
        self.staging.resize(self.staging.len().next_multiple_of(4), 0);
        self.flush();
    }
}
