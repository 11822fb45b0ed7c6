//! Memory for blocks.

#![expect(clippy::inline_always, reason = "a kernel is compiled for an instruction set only where it is inlined")]

use std::alloc::{Layout, handle_alloc_error};

use memmap2::{MmapMut, MmapOptions};

use super::Row;

/// Bytes from which memory is taken in huge pages, where there are any: of small ones a solver touches so many that
/// it spends a few hundredths of its time on having them made and on finding them.
const LARGE: usize = 1 << 16;

/// Numbers in pages of their own: they start at a cache line, so that no row straddles two, and take no memory until
/// they are written for the first time.
#[derive(Debug, Default)]
pub(in crate::spectrum) struct Buffer {
    pages: Option<MmapMut>,
    len: usize,
}

impl Buffer {
    /// So many numbers; what was in it is lost when it has to grow.
    pub(in crate::spectrum) fn reserve(&mut self, len: usize) {
        let bytes = size_of::<f64>() * len;
        if self.pages.as_ref().is_none_or(|pages| pages.len() < bytes) {
            self.pages = None;
            if bytes > 0 {
                self.pages = Some(pages(bytes));
            }
        }
        self.len = len;
    }

    /// All numbers.
    #[inline(always)]
    pub(in crate::spectrum) fn flat(&mut self) -> &mut [f64] {
        self.pages.as_mut().map_or(&mut [], |pages| &mut bytemuck::cast_slice_mut(pages)[..self.len])
    }

    /// All numbers, eight to a row.
    #[inline(always)]
    pub(in crate::spectrum) fn rows(&self) -> &[Row] {
        self.numbers().as_chunks().0
    }

    /// All numbers, eight to a row.
    #[inline(always)]
    pub(in crate::spectrum) fn rows_mut(&mut self) -> &mut [Row] {
        self.flat().as_chunks_mut().0
    }

    /// All numbers.
    #[inline(always)]
    pub(in crate::spectrum) fn numbers(&self) -> &[f64] {
        self.pages.as_ref().map_or(&[], |pages| &bytemuck::cast_slice(pages)[..self.len])
    }
}

/// New pages for so many bytes. Ends the program where there is no address for them, as vectors do.
fn pages(bytes: usize) -> MmapMut {
    let pages = MmapOptions::new().len(bytes).no_reserve_swap().map_anon();
    let pages = pages.unwrap_or_else(|_| match Layout::from_size_align(bytes, 64) {
        Ok(layout) => handle_alloc_error(layout),
        Err(_) => handle_alloc_error(Layout::new::<Row>()),
    });
    #[cfg(target_os = "linux")]
    if bytes >= LARGE {
        // A kernel without them refuses; then there are small pages.
        let _ = pages.advise(memmap2::Advice::HugePage);
    }
    pages
}
