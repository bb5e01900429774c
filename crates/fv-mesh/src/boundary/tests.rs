//! Boundary conditions: values, balance, ghosts.
