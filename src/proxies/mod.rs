//! Proxies: simplified stand-ins for groups of objects.

pub mod geometry;
