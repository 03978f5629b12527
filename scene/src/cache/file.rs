//! The bytes of one tree.
//!
//! All numbers are little-endian. Offsets and lengths are in bytes from the file's start.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | [`MAGIC`] |
//! | 4, 4 | [`FORMAT`], [`hdlod::ALGORITHM`] |
//! | 32 | the [`Key`] |
//! | 5 x (8, 8) | offset and length of the sections, see [`Section`] |
//! | 32 | BLAKE3 of every other byte of the file |
//! | .. | the sections, each at a multiple of [`ALIGNMENT`], zeros between them |

use super::Key;
use crate::hdlod::Indices;
use crate::{Hdlod, Scene, Vertex, hdlod};
use bytemuck::{Pod, cast_slice};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};
use std::sync::Arc;
use topout_schedule::Time;

/// Counts up whenever a file is laid out in another way: also when a field of [`Hdlod`] or of a
/// type in it comes, goes or changes its type.
pub const FORMAT: u32 = 4;

const MAGIC: [u8; 8] = *b"topoutLD";
const ALIGNMENT: usize = 64;
const SECTIONS: usize = 5;
pub(super) const CHECKSUM_AT: usize = 48 + SECTIONS * 16;
pub(super) const HEADER: usize = CHECKSUM_AT + 32;
/// Longest description that is read.
const MAX_INFO: usize = 4096;

const _: () = assert!(cfg!(target_endian = "little"), "tables are mapped as they lie in memory");

/// The parts of a file, in their order.
#[derive(Clone, Copy)]
enum Section {
    /// [`Info`], as postcard.
    Info,
    /// Everything of the [`Hdlod`] but its two tables, as postcard.
    Tree,
    /// [`Hdlod::vertices`], raw.
    Vertices,
    /// [`Hdlod::indices`] of 16 bits, raw.
    Short,
    /// [`Hdlod::indices`] of 32 bits, raw; one of the two is empty.
    Long,
}

/// What a tree in the cache is of, for people.
#[derive(Clone, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
pub struct Info {
    /// What was opened.
    pub project: String,
    /// Elements of the scene.
    pub elements: u64,
    /// Triangles of the scene.
    pub triangles: u64,
    /// Inner nodes of the tree.
    pub clusters: u64,
    /// Mode of the tree: tight or paper.
    pub temporal: String,
    /// When it was made, UTC.
    pub made: Time,
}

/// Why a file is not used.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub enum Unusable {
    /// Not written by this program, or cut off at the very start.
    #[error("it is no tree of topout")]
    Foreign,
    /// Another version of the program wrote it.
    #[error("another version wrote it (format {0}, algorithm {1})")]
    OtherVersion(u32, u32),
    /// The tree of something else.
    #[error("it belongs to another project")]
    OtherKey,
    /// Shorter than it says.
    #[error("it is cut off")]
    Truncated,
    /// The checksum is wrong.
    #[error("it is damaged")]
    Damaged,
    /// Whole, and yet no tree of this scene.
    #[error("its content is wrong: {0}")]
    Content(&'static str),
}

/// Writes one tree.
pub(super) fn write(mut out: impl Write, key: &Key, info: &Info, tree: &Hdlod) -> io::Result<()> {
    let (info, rest) = (postcard(info)?, postcard(tree)?);
    let (short, long): (&[u16], &[u32]) = match &tree.indices {
        Indices::Short(table) => (table, &[]),
        Indices::Long(table) => (&[], table),
    };
    let vertices = cast_slice(tree.vertices.as_slice());
    let sections: [&[u8]; SECTIONS] = [&info, &rest, vertices, cast_slice(short), cast_slice(long)];
    let mut header = Vec::with_capacity(HEADER);
    header.extend_from_slice(&MAGIC);
    header.extend_from_slice(&FORMAT.to_le_bytes());
    header.extend_from_slice(&hdlod::ALGORITHM.to_le_bytes());
    header.extend_from_slice(&key.0);
    let mut end = HEADER;
    for section in sections {
        let start = end.next_multiple_of(ALIGNMENT);
        end = start + section.len();
        header.extend_from_slice(&(start as u64).to_le_bytes());
        header.extend_from_slice(&(section.len() as u64).to_le_bytes());
    }
    let mut hash = blake3::Hasher::new();
    hash.update(&header);
    let mut at = HEADER;
    for section in sections {
        hash.update(padding(at));
        hash.update_rayon(section);
        at = at.next_multiple_of(ALIGNMENT) + section.len();
    }
    header.extend_from_slice(hash.finalize().as_bytes());
    out.write_all(&header)?;
    let mut at = HEADER;
    for section in sections {
        out.write_all(padding(at))?;
        out.write_all(section)?;
        at = at.next_multiple_of(ALIGNMENT) + section.len();
    }
    Ok(())
}

fn postcard(value: &impl Serialize) -> io::Result<Vec<u8>> {
    postcard::to_stdvec(value).map_err(io::Error::other)
}

/// Zeros up to the next section.
fn padding(at: usize) -> &'static [u8] {
    &[0; ALIGNMENT][..at.next_multiple_of(ALIGNMENT) - at]
}

/// Reads the tree of a scene from the bytes of a file. Allocates no more than a few times the
/// file's length.
pub(super) fn read(bytes: &[u8], key: &Key, scene: &Scene) -> Result<Hdlod, Unusable> {
    let header = Header::read(bytes)?;
    if header.key != key.0 {
        return Err(Unusable::OtherKey);
    }
    header.check(bytes)?;
    let (tables, tree) = rayon::join(
        || Some((header.table(bytes, Section::Vertices)?, header.indices(bytes)?)),
        || postcard::from_bytes::<Hdlod>(header.section(bytes, Section::Tree)?).ok(),
    );
    let (vertices, indices): (Vec<Vertex>, Indices) = tables.ok_or(Unusable::Content("a table"))?;
    let tree = tree.ok_or(Unusable::Content("the tree"))?;
    let tree = Hdlod { vertices: Arc::new(vertices), indices, ..tree };
    tree.validate(scene).map_err(Unusable::Content)?;
    Ok(tree)
}

/// Reads what a file is of, from its start; believes what it says.
pub(super) fn read_info(start: &[u8]) -> Result<Info, Unusable> {
    let header = Header::read(start)?;
    let bytes = header.section(start, Section::Info).ok_or(Unusable::Truncated)?;
    postcard::from_bytes(bytes).map_err(|_| Unusable::Content("the description"))
}

/// Bytes at a file's start that [`read_info`] needs.
pub(super) const INFO_BYTES: usize = HEADER.next_multiple_of(ALIGNMENT) + MAX_INFO;

/// The fixed bytes at the start, with versions that this program reads.
struct Header {
    key: [u8; 32],
    sections: [(u64, u64); SECTIONS],
    checksum: [u8; 32],
}

impl Header {
    fn read(bytes: &[u8]) -> Result<Self, Unusable> {
        let mut rest = bytes;
        if take(&mut rest).ok_or(Unusable::Foreign)? != MAGIC {
            return Err(Unusable::Foreign);
        }
        let mut number = || Some(u32::from_le_bytes(take(&mut rest)?));
        let format = number().ok_or(Unusable::Truncated)?;
        let algorithm = number().ok_or(Unusable::Truncated)?;
        if (format, algorithm) != (FORMAT, hdlod::ALGORITHM) {
            return Err(Unusable::OtherVersion(format, algorithm));
        }
        Self::read_rest(rest).ok_or(Unusable::Truncated)
    }

    fn read_rest(mut rest: &[u8]) -> Option<Self> {
        let key = take(&mut rest)?;
        let mut sections = [(0, 0); SECTIONS];
        for (start, length) in &mut sections {
            *start = u64::from_le_bytes(take(&mut rest)?);
            *length = u64::from_le_bytes(take(&mut rest)?);
        }
        Some(Self { key, sections, checksum: take(&mut rest)? })
    }

    /// Whether the file is whole and ends where it should, byte for byte as it was written.
    fn check(&self, bytes: &[u8]) -> Result<(), Unusable> {
        let (start, length) = self.sections[SECTIONS - 1];
        let end = start.checked_add(length).ok_or(Unusable::Damaged)?;
        if (bytes.len() as u64) < end.max(HEADER as u64) {
            return Err(Unusable::Truncated);
        }
        let mut hash = blake3::Hasher::new();
        hash.update(&bytes[..CHECKSUM_AT]);
        hash.update_rayon(&bytes[HEADER..]);
        if *hash.finalize().as_bytes() == self.checksum { Ok(()) } else { Err(Unusable::Damaged) }
    }

    fn section<'a>(&self, bytes: &'a [u8], section: Section) -> Option<&'a [u8]> {
        let (start, length) = self.sections[section as usize];
        let start = usize::try_from(start).ok()?;
        bytes.get(start..start.checked_add(usize::try_from(length).ok()?)?)
    }

    fn indices(&self, bytes: &[u8]) -> Option<Indices> {
        let long: Vec<u32> = self.table(bytes, Section::Long)?;
        if long.is_empty() {
            return Some(Indices::Short(self.table(bytes, Section::Short)?));
        }
        self.section(bytes, Section::Short)?.is_empty().then_some(Indices::Long(long))
    }

    /// A copy of a table: the only one on the way from the file to the tree.
    fn table<T: Pod>(&self, bytes: &[u8], section: Section) -> Option<Vec<T>> {
        let items: &[T] = bytemuck::try_cast_slice(self.section(bytes, section)?).ok()?;
        Some(items.to_vec())
    }
}

/// The next `N` bytes.
fn take<const N: usize>(rest: &mut &[u8]) -> Option<[u8; N]> {
    let (first, left) = rest.split_first_chunk::<N>()?;
    *rest = left;
    Some(*first)
}
