//! The program: command line, window and what they share. No algorithm lives here.

pub mod bench;
pub mod cli;
pub mod estimate;
pub mod flip;
pub mod ideal;
pub mod memory;
pub mod output;
pub mod project;
pub mod report;
pub mod tree;
pub mod window;
