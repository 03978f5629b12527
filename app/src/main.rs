//! topout: see a building on any day of its construction.

fn main() {}
