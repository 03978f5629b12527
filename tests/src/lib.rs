//! Harness for whole-program tests and golden pictures.
