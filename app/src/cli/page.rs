//! `topout report`: a page with pictures and progress.

use super::{Outcome, args};

/// Draws, writes and reports.
pub fn run(_args: &args::Page) -> anyhow::Result<Outcome> {
    anyhow::bail!("not yet")
}
