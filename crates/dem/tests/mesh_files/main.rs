//! Files of bodies as programs write them.
mod limits;
