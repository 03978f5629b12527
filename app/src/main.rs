//! topout: see a building on any day of its construction.

use std::process::ExitCode;

fn main() -> ExitCode {
    topout::cli::run()
}
