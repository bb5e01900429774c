//! What must hold for all.
