//! The memory of a basis in single precision.

use super::{Panel, panels};
use crate::spectrum::lanes::Buffer;

/// Blocks in single precision, one behind the other.
#[derive(Debug, Default)]
pub(in crate::spectrum) struct Blocks {
    memory: Buffer,
    /// Panels in a block.
    panels: usize,
}

impl Blocks {
    /// Addresses for so many blocks of so many rows.
    pub(in crate::spectrum) fn reserve(&mut self, rows: usize, blocks: usize) {
        self.panels = panels(rows);
        self.memory.reserve(blocks * self.panels * size_of::<Panel>() / size_of::<f64>());
    }

    /// The first blocks.
    pub(in crate::spectrum) fn first(&self, blocks: usize) -> Vec<&[Panel]> {
        // There may be no memory yet.
        if blocks == 0 {
            return Vec::new();
        }
        let all: &[Panel] = bytemuck::cast_slice(self.memory.numbers());
        all.chunks_exact(self.panels).take(blocks).collect()
    }

    /// One block.
    pub(in crate::spectrum) fn block_mut(&mut self, at: usize) -> &mut [Panel] {
        let all: &mut [Panel] = bytemuck::cast_slice_mut(self.memory.flat());
        &mut all[at * self.panels..(at + 1) * self.panels]
    }

    /// The first blocks, and the one behind them.
    pub(in crate::spectrum) fn split(&mut self, at: usize) -> (Vec<&[Panel]>, &mut [Panel]) {
        let all: &mut [Panel] = bytemuck::cast_slice_mut(self.memory.flat());
        let (first, rest) = all.split_at_mut(at * self.panels);
        (first.chunks_exact(self.panels).collect(), &mut rest[..self.panels])
    }
}
