//! Tests of the import. Small files are built in code by [`build`].
#![allow(clippy::unwrap_used)]

mod build;
mod corpus;
mod damage;
mod features;
mod fuzz;
mod real;
mod structure;
