//! Tests of the reader on documents made by hand and on the sample scenes.

mod builder;
mod geometry;
mod graph;
mod instances;
mod materials;
mod properties;
mod samples;
