//! Rigid bodies of any shape: overlap volume, contact forces and motion.
