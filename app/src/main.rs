//! topout
fn main() {}
