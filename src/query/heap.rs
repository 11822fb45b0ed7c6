//! The process's memory: how much it has, and what is free given back to the system.

/// Has every large block mapped by itself, so that it goes back to the system when it is freed; for the whole process.
///
/// Left to itself the GNU C library raises the size from which it does so up to 32 MB, and each thread's heap then
/// keeps the blocks of the largest mesh that it has solved. On SHREC 2007 with four threads this is a tenth of the most
/// that the process has, and half of what it has afterwards.
pub(crate) fn map_large_blocks() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        #[expect(unsafe_code, reason = "the function has no safe name")]
        // SAFETY: it may be called by any thread at any time, and changes where blocks are taken from, nothing else.
        unsafe {
            libc::mallopt(libc::M_MMAP_THRESHOLD, 256 * 1024);
        }
    }
}

/// Gives back what this process's allocator holds and nobody uses.
///
/// The GNU C library keeps what a thread has freed for that thread, but for [large blocks](map_large_blocks). Given
/// back while SHREC 2007 is solved by four threads, this is a twelfth of the most that the process has; given back
/// after sixty of its meshes, half of what is left.
pub(super) fn give_back() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        #[expect(unsafe_code, reason = "the function has no safe name")]
        // SAFETY: it may be called by any thread at any time, and touches only memory that is free.
        unsafe {
            libc::malloc_trim(0);
        }
    }
}

/// Bytes of memory that the process has now, where the system says so.
pub(super) fn memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn the_process_has_some_memory() {
        assert!(memory().is_some_and(|bytes| bytes > 1 << 20));
    }
}
