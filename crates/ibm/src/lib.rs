//! Hybrid fictitious domain-immersed boundary: solid fraction, surface reconstruction, forcing and loads.
