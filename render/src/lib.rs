//! Everything on the GPU: uploads, passes, timing, read-back.
