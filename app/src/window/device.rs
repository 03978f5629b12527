//! When the graphics device is lost: another window on another device, with all that the first one showed.
//!
//! eframe opens one device for a window and cannot change it. So a window whose device is gone paints nothing
//! more, closes, and leaves its [`AppState`] to a window that is opened in its place by the same program:
//! project, tree, selection and undo stay in memory. Where that fails, what was not saved lies in a recovery
//! file, and the message names it.

use super::state::AppState;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::path::Path;
use std::rc::Rc;
use std::time::{Duration, Instant};
use topout_render::Fault;

/// Seconds after which a window loses its device, for trying what follows.
const LOSE_VARIABLE: &str = "TOPOUT_LOSE_DEVICE_AFTER";
/// Set for a program that was started again by itself; it does not do so in turn.
const STARTED_AGAIN: &str = "TOPOUT_STARTED_AGAIN";

/// So many losses within [`SPELL`] are more than a driver that is replaced or a computer that slept.
const FEW: usize = 3;
/// See [`FEW`].
const SPELL: Duration = Duration::from_secs(60);

/// What a window leaves whose device was lost.
pub struct Left {
    /// All that it showed.
    pub state: AppState,
    /// What the driver said.
    pub why: String,
}

/// Where a window leaves it.
pub type Estate = Rc<RefCell<Option<Left>>>;

/// When devices were lost.
#[derive(Debug, Default)]
pub struct Losses(VecDeque<Instant>);

impl Losses {
    /// One was lost now: whether another one is worth trying.
    pub fn may_open_again(&mut self, now: Instant) -> bool {
        self.0.retain(|lost| now.saturating_duration_since(*lost) < SPELL);
        self.0.push_back(now);
        self.0.len() <= FEW
    }
}

/// Destroys a device after a time that the environment may name: at any moment, as drivers do.
pub fn lose_if_asked(device: &wgpu::Device) {
    let seconds = std::env::var(LOSE_VARIABLE).ok().and_then(|text| text.parse().ok());
    let Some(Ok(after)) = seconds.map(Duration::try_from_secs_f64) else { return };
    let device = device.clone();
    // It ends with the program; where there is no thread, nothing is tried.
    let _ = std::thread::Builder::new().name("topout-lose".to_owned()).spawn(move || {
        std::thread::sleep(after);
        device.destroy();
    });
}

/// Where the project is, for messages.
fn whereabouts(kept: Option<&Path>) -> String {
    match kept {
        Some(file) => format!("The project is kept as it was: topout \"{}\"", file.display()),
        None => "Nothing was open that is not saved.".to_owned(),
    }
}

/// Said where devices are lost again and again.
pub fn too_often(why: &str, kept: Option<&Path>) -> String {
    let advice = match why.to_lowercase().contains("memory") {
        true => "Close other programs that draw, or make the window smaller.",
        false => "A newer driver may help, or another one: WGPU_BACKEND=gl topout.",
    };
    let kept = whereabouts(kept);
    format!(
        "the graphics device was lost {} times within a minute ({why}). {advice} {kept}",
        FEW + 1
    )
}

/// Said where no other device came.
pub fn none_came(why: &str, kept: Option<&Path>) -> String {
    format!("the graphics device was lost ({why}), and no other one opened. {}", whereabouts(kept))
}

/// Said in the window that follows.
pub fn opened_again(why: &str) -> String {
    format!(
        "The graphics device was lost ({why}) and was opened again. Nothing of the project is lost."
    )
}

/// What the user is told of a fault.
pub fn explain(fault: &Fault) -> String {
    match fault {
        Fault::OutOfMemory(what) => format!(
            "The graphics memory is full, so something is missing in the picture ({what}). Close other programs \
             that draw, make the window smaller, or allow a larger tolerance. The project is not affected."
        ),
        Fault::Refused(what) => format!(
            "The graphics device refused something, so the picture may not be whole. The project is not \
             affected. What it said: {what}"
        ),
    }
}

/// Starts this program again with a project, where it was not started that way itself.
pub fn start_again(project: Option<&Path>) -> std::io::Result<bool> {
    if std::env::var_os(STARTED_AGAIN).is_some() {
        return Ok(false);
    }
    let mut program = std::process::Command::new(std::env::current_exe()?);
    program.args(project).env(STARTED_AGAIN, "1").spawn()?;
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_is_opened_again_unless_it_is_lost_time_and_again() {
        let mut losses = Losses::default();
        let start = Instant::now();
        let at = |seconds| start + Duration::from_secs(seconds);
        let tries = [0, 10, 20, 30, 79, 81].map(|seconds| losses.may_open_again(at(seconds)));
        assert_eq!(tries, [true, true, true, false, true, true], "the early ones are forgotten");
        assert_eq!([82, 200].map(|seconds| losses.may_open_again(at(seconds))), [false, true]);
    }

    #[test]
    fn messages_say_where_the_project_is() {
        let file = Path::new("/tmp/kept.topout");
        for text in [too_often("reset", Some(file)), none_came("reset", Some(file))] {
            assert!(
                text.contains("reset") && text.contains("topout \"/tmp/kept.topout\""),
                "{text}"
            );
        }
        let no_room = too_often("Not enough memory left.", None);
        assert!(no_room.contains("smaller") && !no_room.contains("driver"), "{no_room}");
        let full = explain(&Fault::OutOfMemory("no room for glass".to_owned()));
        assert!(full.contains("no room for glass") && full.contains("tolerance"), "{full}");
    }
}
