//! Memory for blocks.

#![expect(clippy::inline_always, reason = "a kernel is compiled for an instruction set only where it is inlined")]

use super::{Row, WIDTH};

/// Numbers that start at a cache line, so that no row straddles two.
#[derive(Debug, Default)]
pub(in crate::spectrum) struct Buffer {
    data: Vec<f64>,
    offset: usize,
    len: usize,
}

impl Buffer {
    /// At least this many numbers; what was in it is lost when it has to grow.
    pub(in crate::spectrum) fn reserve(&mut self, len: usize) {
        if self.data.len() < len + WIDTH {
            self.data = vec![0.0; len + WIDTH];
            let away = self.data.as_ptr().align_offset(64);
            self.offset = if away < WIDTH { away } else { 0 };
        }
        self.len = len;
    }

    /// All numbers.
    #[inline(always)]
    pub(in crate::spectrum) fn flat(&mut self) -> &mut [f64] {
        &mut self.data[self.offset..self.offset + self.len]
    }

    /// All numbers, eight to a row.
    #[inline(always)]
    pub(in crate::spectrum) fn rows(&self) -> &[Row] {
        self.data[self.offset..self.offset + self.len].as_chunks().0
    }

    /// All numbers, eight to a row.
    #[inline(always)]
    pub(in crate::spectrum) fn rows_mut(&mut self) -> &mut [Row] {
        self.data[self.offset..self.offset + self.len].as_chunks_mut().0
    }
}
