//! CPU time.
