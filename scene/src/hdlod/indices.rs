//! The index table of a tree.

use std::ops::Range;

/// Corners of triangles, three each: of 16 bits while all are below 65,535, else of 32.
///
/// Clusters are small, so a table of 32 bits is seldom needed; 65,535 itself is left out because
/// some graphics interfaces take it for the end of a strip.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Indices {
    /// All below 65,535.
    Short(Vec<u16>),
    /// Any.
    Long(Vec<u32>),
}

impl Default for Indices {
    fn default() -> Self {
        Self::Short(Vec::new())
    }
}

impl Indices {
    /// Number of indices.
    pub fn len(&self) -> usize {
        match self {
            Self::Short(table) => table.len(),
            Self::Long(table) => table.len(),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes of one index.
    pub fn width(&self) -> usize {
        match self {
            Self::Short(_) => size_of::<u16>(),
            Self::Long(_) => size_of::<u32>(),
        }
    }

    /// The bytes of a range, in the machine's order.
    ///
    /// # Panics
    /// As a slice does, out of range.
    pub fn bytes(&self, range: Range<usize>) -> &[u8] {
        match self {
            Self::Short(table) => bytemuck::cast_slice(&table[range]),
            Self::Long(table) => bytemuck::cast_slice(&table[range]),
        }
    }

    /// One index.
    ///
    /// # Panics
    /// As a slice does, out of range.
    pub fn at(&self, place: usize) -> u32 {
        match self {
            Self::Short(table) => u32::from(table[place]),
            Self::Long(table) => table[place],
        }
    }

    /// The corners of one triangle of the whole table.
    ///
    /// # Panics
    /// As a slice does, out of range.
    pub fn triangle(&self, number: usize) -> [u32; 3] {
        let at = number * 3;
        match self {
            Self::Short(table) => [table[at], table[at + 1], table[at + 2]].map(u32::from),
            Self::Long(table) => [table[at], table[at + 1], table[at + 2]],
        }
    }

    /// The indices of a range.
    ///
    /// # Panics
    /// As a slice does, out of range.
    pub fn range(&self, range: Range<usize>) -> impl ExactSizeIterator<Item = u32> + '_ {
        assert!(range.end <= self.len(), "{range:?} of {}", self.len());
        range.map(|place| self.at(place))
    }

    /// The triangles of a range of indices.
    ///
    /// # Panics
    /// As a slice does, out of range.
    pub fn triangles(&self, range: Range<usize>) -> impl Iterator<Item = [u32; 3]> + '_ {
        assert!(range.end <= self.len(), "{range:?} of {}", self.len());
        let corners = move |at| [0, 1, 2].map(|k| self.at(at + k));
        (range.start..range.start + range.len() / 3 * 3).step_by(3).map(corners)
    }

    /// The table of a small tree.
    #[cfg(test)]
    pub(crate) fn short(&mut self) -> &mut Vec<u16> {
        match self {
            Self::Short(table) => table,
            Self::Long(_) => panic!("a small tree has a short table"),
        }
    }

    /// Appends; widens the table where it must.
    pub fn append(&mut self, more: impl IntoIterator<Item = u32>) {
        for index in more {
            match self {
                Self::Long(table) => table.push(index),
                Self::Short(table) if index < u32::from(u16::MAX) => table.push(index as u16),
                Self::Short(table) => {
                    let mut long: Vec<u32> = table.iter().map(|&i| u32::from(i)).collect();
                    long.push(index);
                    *self = Self::Long(long);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_short_until_an_index_does_not_fit() {
        let mut table = Indices::default();
        table.append([0, 1, 65_534]);
        assert_eq!(table, Indices::Short(vec![0, 1, 65_534]));
        assert_eq!(table.bytes(1..3).len(), 4);
        table.append([65_535, 7, 8]);
        assert_eq!(table, Indices::Long(vec![0, 1, 65_534, 65_535, 7, 8]));
        assert_eq!((table.len(), table.width()), (6, 4));
        assert_eq!(table.triangle(1), [65_535, 7, 8]);
        assert!(table.triangles(0..6).eq([[0, 1, 65_534], [65_535, 7, 8]]));
        assert!(table.range(2..4).eq([65_534, 65_535]));
    }

    #[test]
    #[should_panic(expected = "0..4 of 3")]
    fn a_range_beyond_the_table_panics() {
        let mut table = Indices::default();
        table.append([0, 1, 2]);
        let _ = table.range(0..4);
    }
}
