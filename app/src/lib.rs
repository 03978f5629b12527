//! The program: command line, window and what they share. No algorithm lives here.

pub mod project;
pub mod window;
