//! The command line: one file a sub-command.

mod args;
mod bake;
mod bench;
mod cache;
mod check;
mod demo;
mod movie;
mod page;
mod render;
mod sections;
mod slip;
mod stage;
mod table;
mod terminal;
mod verify;

use crate::project;
use args::{Cli, Command};
use clap::Parser;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;
use topout_render::GpuError;
use topout_scene::demo::DemoError;
use topout_scene::{Cancelled, Progress, Scene};

/// The data has errors, or a file cannot be used.
const DATA: u8 = 1;
/// Wrong use, also where only the work itself can tell.
const WRONG_USE: u8 = 2;
/// No graphics adapter.
const NO_ADAPTER: u8 = 3;

/// Ended by Ctrl+C, as shells say it.
const CANCELLED: u8 = 130;

/// What was asked for makes no sense for this project.
#[derive(thiserror::Error, Debug)]
#[error("{0}")]
struct WrongUse(String);

/// How a sub-command ended, when it did its work.
enum Outcome {
    Fine,
    /// The work is done, and it found errors in the data, or promises that are not kept.
    BadData,
}

/// Runs what the command line asks for. Wrong use ends the process with code 2.
pub fn run() -> ExitCode {
    let started = Instant::now();
    let cli = Cli::parse();
    terminal::log_to_stderr();
    let result = match cli.command {
        Some(Command::Demo(args)) => demo::run(&args),
        Some(Command::Check(args)) => {
            args.check().unwrap_or_else(|error| error.exit());
            check::run(&args)
        }
        Some(Command::Bake(args)) => bake::run(&args),
        Some(Command::Render(args)) => render::run(&args, started),
        Some(Command::Movie(args)) => {
            args.check().unwrap_or_else(|error| error.exit());
            movie::run(&args)
        }
        Some(Command::Report(args)) => page::run(&args),
        Some(Command::Bench(args)) => {
            args.check().unwrap_or_else(|error| error.exit());
            bench::run(&args)
        }
        Some(Command::Cache(args)) => cache::run(&args),
        Some(Command::Verify(args)) => verify::run(&args),
        None => crate::window::run(Some(cli.viewer_request())).map(|()| Outcome::Fine),
    };
    match result {
        Ok(Outcome::Fine) => ExitCode::SUCCESS,
        Ok(Outcome::BadData) => ExitCode::from(DATA),
        Err(error) => {
            terminal::say_error(&error);
            ExitCode::from(exit_code(&error))
        }
    }
}

fn exit_code(error: &anyhow::Error) -> u8 {
    let caused_by =
        |wanted: fn(&(dyn std::error::Error + 'static)) -> bool| error.chain().any(wanted);
    if caused_by(|e| {
        matches!(e.downcast_ref(), Some(GpuError::NoAdapter(_) | GpuError::NoDevice { .. }))
    }) {
        NO_ADAPTER
    } else if caused_by(|e| e.is::<DemoError>() || e.is::<WrongUse>()) {
        WRONG_USE
    } else if caused_by(|e| e.is::<Cancelled>()) {
        CANCELLED
    } else {
        DATA
    }
}

/// Loads a project with a progress line on the terminal.
fn load(request: &project::Request, progress: &Arc<Progress>) -> anyhow::Result<Scene> {
    let _line = terminal::ProgressLine::show(progress);
    project::load(request, progress)
}

/// From now on Ctrl+C, or what ends a session, asks the work to stop at its next step, so that it can tidy up;
/// the second time the program ends at once.
fn stop_on_ctrl_c(progress: &Arc<Progress>) {
    let progress = Arc::clone(progress);
    let set = ctrlc::set_handler(move || {
        if progress.check().is_err() {
            std::process::exit(CANCELLED.into());
        }
        progress.cancel();
    });
    if let Err(error) = set {
        tracing::warn!("Ctrl+C will not tidy up: {error}");
    }
}
