//! The time loop that lets flow and bodies move one another.
