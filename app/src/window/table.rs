//! The paper's table, measured on the shown project.

use super::command::Command;
use super::loading::{Project, Wake};
use super::state::AppState;
use glam::UVec2;
use std::sync::Arc;
use topout_scene::Hdlod;

/// Nothing, a measurement that is going on, or its result.
#[derive(Default)]
pub struct Table {}

impl Table {
    /// Starts measuring; a measurement that is going on is dropped.
    pub fn start(&mut self, _: &Project, _: Option<Arc<Hdlod>>, _: UVec2, _: f32, _: &Wake) {}
    /// Stops measuring.
    pub fn cancel(&mut self) {}
    /// Takes over the result.
    pub fn poll(&mut self) {}
    /// Whether a thread is measuring.
    pub fn is_measuring(&self) -> bool {
        false
    }
}

/// The window with the table.
pub fn show(_: &egui::Context, _: &AppState, _: &mut Vec<Command>) {}
