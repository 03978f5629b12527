//! What the process holds beyond what it uses.

/// Gives memory that was needed for a moment back to the system, after large work: the C library keeps
/// what was freed in the middle of its pools, some 100 MB after the load of a tower. Does nothing where
/// the system has another allocator. Takes some milliseconds.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub fn give_back() {
    // SAFETY: the function takes a number and may be called at any time from any thread; it touches
    // nothing that is in use.
    #[allow(unsafe_code)]
    unsafe {
        libc::malloc_trim(0);
    }
}

/// Nothing to do.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub fn give_back() {}
