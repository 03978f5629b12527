//! Everything that the window can be asked for: one enum feeds menus, shortcuts and tooltips.

use super::browser::Browse;
use super::camera::Camera;
use super::clock::{Speed, Step};
use super::closing::Close;
use super::compare::Against;
use super::export::Export;
use super::gantt::{Columns, Filter};
use super::navigation::{Mouse, Navigation};
use super::section::Section;
use super::selection::Choose;
use super::shown::{ElementColors, WEEKS_AHEAD};
use super::theme::Scheme;
use super::timeline::Scale;
use super::visibility::Shown;
use crate::bench::export::Format;
use crate::project::Request;
use egui::{Key, Modifiers};
use glam::Vec3;
use std::path::PathBuf;
use topout_render::{DrawMode, Sun};
use topout_scene::{ElementId, NamedView};
use topout_schedule::{DateSet, Time, TimeRange};

/// A panel that folds.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Panel {
    /// Activities as rows and bars.
    Gantt,
    /// The elements by storey, type and activity.
    Tree,
    /// Progress over time, below the timeline's events.
    Curves,
    /// Every command, by name.
    Palette,
    /// Views that are kept by name.
    Viewpoints,
    /// What is cut away.
    Section,
    /// Pictures, films and reports.
    Export,
    /// What is known of the selected element.
    Inspector,
    /// Transport, date and time axis.
    Timeline,
    /// Figures of the last frames.
    Figures,
    /// Their times as a graph.
    Graph,
    /// Where the light comes from.
    Sun,
    /// Findings in the data.
    Diagnostics,
    /// The paper's table, measured here.
    Table,
    /// The list of shortcuts.
    Shortcuts,
    /// Version and graphics adapter.
    About,
}

/// A request of the user; [`super::AppState::apply`] carries it out.
#[derive(Clone, PartialEq, Debug)]
pub enum Command {
    /// Ask for model files.
    OpenModel,
    /// Ask for schedule files.
    OpenSchedule,
    /// Load the built-in skyscraper.
    OpenDemo,
    /// Load what was named; the shown project stays until that succeeds.
    Load(Request),
    /// Files dropped on the window or chosen in a dialog, of any kind.
    OpenFiles(Vec<PathBuf>),
    /// Ask for a file and write the schedule to it, as it is now.
    SaveSchedule,
    /// Write the project file.
    SaveProject,
    /// Ask where to, and write it.
    SaveProjectAs,
    /// Read the schedule of the shown project again.
    ReloadSchedule,
    /// Stop loading.
    CancelLoading,
    /// Close the message about what happened to the schedule, or to a file that was saved.
    DismissNews,
    /// Tell the user what went wrong.
    Report(String),
    /// Close the message about what went wrong.
    DismissError,
    /// Close the window.
    Quit,
    /// Show what can be done first.
    ShowHint,
    /// Show that no more.
    CloseHint,
    /// What becomes of changes before the window closes.
    AnswerClose(Close),

    /// Play or pause.
    TogglePlay,
    /// Play towards the end; asked again, twice as fast.
    PlayForward,
    /// Play towards the start; asked again, twice as fast.
    PlayBackward,
    /// Stand still.
    Pause,
    /// Stand still at the start of what is played.
    Stop,
    /// Move by hours, days, months or to an event.
    Step(Step),
    /// Go to an instant, held within the period.
    JumpTo(Time),
    /// Go to the first instant.
    ToStart,
    /// Go to the last instant.
    ToEnd,
    /// Leave out nights and days off while playing, or not.
    ToggleSkipIdle,
    /// How fast time runs while playing.
    SetSpeed(Speed),
    /// The next higher speed.
    Faster,
    /// The next lower speed.
    Slower,
    /// Play a part again and again; `None`: all, once.
    SetLoop(Option<TimeRange>),
    /// Play what the timeline shows again and again.
    LoopShown,
    /// Which part of time the timeline shows.
    ShowTime(Scale),
    /// The timeline shows the whole project.
    FitTimeline,

    /// How the scene is drawn.
    SetMode(DrawMode),
    /// Largest error allowed on the picture, physical pixels.
    SetTolerance(f32),
    /// Colour elements by something, or no longer where they are.
    ColorBy(ElementColors),
    /// Colour what starts within so many weeks.
    LookAhead(u8),
    /// Colour clusters by their level, or not.
    ToggleLevelColors,
    /// Let levels that follow each other fade into each other, or not.
    ToggleFade,
    /// Where the light comes from.
    SetSun(Sun),
    /// Build or refine the tree again after that was cancelled.
    BuildHdlod,
    /// Stop building or refining the tree; what it lacks stays drawn in full detail.
    CancelHdlod,

    /// Show everything.
    Fit,
    /// Show the selected elements.
    FitSelection,
    /// Look from a standard direction.
    LookFrom(NamedView),
    /// Look from an azimuth and an elevation in degrees.
    LookAlong(i16, i16),
    /// Remember where one looks from, which is about to change.
    LeaveView,
    /// Look from where one looked before.
    ViewBack,
    /// And from where one looked after that.
    ViewForward,
    /// Parallel rays, or perspective.
    ToggleParallel,
    /// Which mouse buttons do what.
    SetMouse(Mouse),
    /// Around the scene, on foot or in the air; asked again, around it.
    Navigate(Navigation),
    /// Keep camera, date, colours and what is hidden under a name.
    SaveViewpoint,
    /// Look at what was kept, by its place in the list.
    ShowViewpoint(usize),
    /// Call it something else.
    RenameViewpoint(usize, String),
    /// Keep it no longer.
    DeleteViewpoint(usize),
    /// Move the camera as a gesture says.
    MoveCamera(Camera),
    /// Select elements.
    Choose(Choose, Vec<ElementId>),
    /// Select nothing.
    ClearSelection,
    /// Select an activity, given by its place in the schedule, and its elements.
    SelectActivity(usize),
    /// Select the elements of all activities below a summary, given by its place in the outline.
    SelectSummary(u32),
    /// How the selected elements are drawn.
    DrawSelection(Shown),
    /// How some elements are drawn.
    Draw(Shown, Vec<ElementId>),
    /// How everything but the selected elements is drawn.
    Isolate(Shown),
    /// Draw everything as ever.
    ShowAll,
    /// How elements are drawn that no activity touches.
    DrawUnscheduled(Shown),

    /// Hold the shown plan against another one.
    Compare(Against),
    /// Ask for a schedule to hold it against.
    CompareFile,
    /// Show the project alone.
    StopComparing,

    /// Draw storeys so many metres farther apart; together by 0.
    Explode(f32),
    /// Draw storeys apart, or together.
    ToggleExplosion,

    /// Cut something else away; changes until [`Command::SettleSection`] are one.
    SetSection(Box<Section>),
    /// What was cut away until now is one change.
    SettleSection,
    /// Cut, or no longer; with a box where there is nothing to cut with.
    ToggleSection,
    /// Show what is in a box around the selected elements, or around everything.
    SectionBox(bool),
    /// Cut away what lies beyond a point (local space) in a direction.
    SectionAt(Vec3, Vec3),
    /// Cut nothing away.
    ClearSection,
    /// Measure with every click, or no longer.
    ToggleMeasure,
    /// A point of a distance, local space.
    MeasureAt(Vec3),
    /// Forget all distances.
    ClearMeasures,

    /// Move an activity to other dates, and what follows from it.
    MoveActivity(usize, TimeRange),
    /// Take back the last change.
    Undo,
    /// Make it again.
    Redo,

    /// How the model tree is grouped, searched and unfolded.
    Browse(Box<Browse>),
    /// Which activities the Gantt chart lists.
    SetFilter(Box<Filter>),
    /// Which columns the Gantt chart has.
    SetColumns(Columns),
    /// Fold or unfold what is below a summary, given by its place in the outline.
    Fold(u32, bool),
    /// Fold or unfold all summaries.
    FoldAll(bool),

    /// Link elements to an activity, given by its place in the schedule, by hand.
    Attach(Vec<ElementId>, usize),
    /// Take away such links, or those that a rule made.
    Detach(Vec<ElementId>, usize),

    /// Show or hide a panel.
    Toggle(Panel),
    /// Dark, light or as the system says.
    SetScheme(Scheme),
    /// Dark to light and back.
    ToggleScheme,

    /// What of the shown project is to be saved, and how.
    SetExport(Box<Export>),
    /// Ask where to.
    BrowseExport,
    /// Save it.
    StartExport,
    /// Stop saving; nothing is left of it.
    CancelExport,

    /// Measure the paper's table on the current model.
    MeasureTable,
    /// Stop measuring.
    CancelTable,
    /// Ask for a file and write the table to it.
    SaveTable(Format),
    /// Put a text on the clipboard.
    Copy(String),
}

/// Keys that ask for something.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Shortcut {
    /// Exactly these must be held.
    pub modifiers: Modifiers,
    /// And this one pressed.
    pub key: Key,
}

impl Shortcut {
    const fn key(key: Key) -> Self {
        Self { modifiers: Modifiers::NONE, key }
    }

    const fn shift(key: Key) -> Self {
        Self { modifiers: Modifiers::SHIFT, key }
    }

    const fn alt(key: Key) -> Self {
        Self { modifiers: Modifiers::ALT, key }
    }

    const fn command(key: Key) -> Self {
        Self { modifiers: Modifiers::COMMAND, key }
    }

    const fn command_shift(key: Key) -> Self {
        Self { modifiers: Modifiers::COMMAND.plus(Modifiers::SHIFT), key }
    }

    /// As written in menus and in the manual: `Ctrl+Shift+O`.
    pub fn text(&self) -> String {
        let mut text = String::new();
        if self.modifiers.command {
            text.push_str(if cfg!(target_os = "macos") { "Cmd+" } else { "Ctrl+" });
        }
        if self.modifiers.alt {
            text.push_str("Alt+");
        }
        if self.modifiers.shift {
            text.push_str("Shift+");
        }
        text + match self.key {
            Key::ArrowLeft => "Left",
            Key::ArrowRight => "Right",
            Key::ArrowUp => "Up",
            Key::ArrowDown => "Down",
            Key::Comma => ",",
            Key::Period => ".",
            Key::OpenBracket => "[",
            Key::CloseBracket => "]",
            key => key.name(),
        }
    }
}

/// A command with a name of its own and perhaps keys.
#[derive(Clone, Debug)]
pub struct Action {
    /// What it asks for.
    pub command: Command,
    /// Name in menus.
    pub name: &'static str,
    /// Keys.
    pub shortcut: Option<Shortcut>,
    /// Whether holding the keys repeats it.
    pub repeats: bool,
}

/// Every named command, in the order of the menus.
pub fn actions() -> Vec<Action> {
    use Command as C;
    use Shortcut as S;
    let action = |command, name, shortcut| Action { command, name, shortcut, repeats: false };
    let step = |step, name, shortcut| Action {
        command: C::Step(step),
        name,
        shortcut: Some(shortcut),
        repeats: true,
    };
    vec![
        action(C::OpenModel, "Open model…", Some(S::command(Key::O))),
        action(C::OpenSchedule, "Open schedule…", Some(S::command_shift(Key::O))),
        action(C::ReloadSchedule, "Reload schedule", Some(S::command(Key::R))),
        action(C::OpenDemo, "Open demo project", Some(S::command(Key::D))),
        action(C::SaveSchedule, "Save schedule as…", None),
        action(C::SaveProject, "Save project", Some(S::command(Key::S))),
        action(C::SaveProjectAs, "Save project as…", Some(S::command_shift(Key::S))),
        action(C::Toggle(Panel::Export), "Export…", Some(S::command(Key::E))),
        action(C::Quit, "Quit", Some(S::command(Key::Q))),
        action(C::Undo, "Undo", Some(S::command(Key::Z))),
        action(C::Redo, "Redo", Some(S::command_shift(Key::Z))),
        action(C::Fit, "Fit all", Some(S::key(Key::F))),
        action(C::FitSelection, "Fit selection", Some(S::shift(Key::F))),
        action(C::ClearSelection, "Clear selection", Some(S::key(Key::Escape))),
        action(C::DrawSelection(Shown::Hidden), "Hide selection", Some(S::key(Key::X))),
        action(C::DrawSelection(Shown::Ghost), "Ghost selection", Some(S::key(Key::Z))),
        action(C::DrawSelection(Shown::Whole), "Show selection", Some(S::shift(Key::X))),
        action(C::Isolate(Shown::Hidden), "Isolate selection", Some(S::key(Key::S))),
        action(C::Isolate(Shown::Ghost), "Ghost everything else", Some(S::shift(Key::S))),
        action(C::ShowAll, "Show all", Some(S::key(Key::U))),
        action(C::DrawUnscheduled(Shown::Whole), "Unscheduled elements: shown", None),
        action(C::DrawUnscheduled(Shown::Ghost), "Unscheduled elements: ghosts", None),
        action(C::DrawUnscheduled(Shown::Hidden), "Unscheduled elements: hidden", None),
        action(C::ViewBack, "View before", Some(S::key(Key::Backspace))),
        action(C::ViewForward, "View after", Some(S::shift(Key::Backspace))),
        action(C::SaveViewpoint, "Save viewpoint", Some(S::key(Key::V))),
        action(C::ToggleSection, "Section", Some(S::key(Key::Q))),
        action(C::SectionBox(true), "Section box around selection", Some(S::shift(Key::Q))),
        action(C::SectionBox(false), "Section box around all", None),
        action(C::ClearSection, "Remove section", None),
        action(C::Toggle(Panel::Section), "Section…", Some(S::alt(Key::Q))),
        action(C::ToggleMeasure, "Measure", Some(S::key(Key::Y))),
        action(C::ClearMeasures, "Remove distances", Some(S::shift(Key::Y))),
        action(C::ToggleExplosion, "Storeys apart", Some(S::shift(Key::E))),
        action(C::Toggle(Panel::Viewpoints), "Viewpoints…", Some(S::shift(Key::V))),
        action(C::ToggleParallel, "Parallel projection", Some(S::key(Key::Num7))),
        action(C::Navigate(Navigation::Walk), "Walk", Some(S::key(Key::W))),
        action(C::Navigate(Navigation::Fly), "Fly", Some(S::shift(Key::W))),
        action(C::LookFrom(NamedView::Front), "Front", Some(S::key(Key::Num1))),
        action(C::LookFrom(NamedView::Back), "Back", Some(S::key(Key::Num2))),
        action(C::LookFrom(NamedView::Left), "Left", Some(S::key(Key::Num3))),
        action(C::LookFrom(NamedView::Right), "Right", Some(S::key(Key::Num4))),
        action(C::LookFrom(NamedView::Top), "Top", Some(S::key(Key::Num5))),
        action(C::LookFrom(NamedView::Iso), "Iso", Some(S::key(Key::Num6))),
        action(C::SetMode(DrawMode::Hdlod), "Draw HDLOD", Some(S::key(Key::H))),
        action(C::SetMode(DrawMode::Batched), "Draw batched", Some(S::key(Key::B))),
        action(C::SetMode(DrawMode::Objects), "Draw objects", Some(S::key(Key::O))),
        action(C::Toggle(Panel::Tree), "Model tree", Some(S::key(Key::M))),
        action(C::Toggle(Panel::Inspector), "Inspector", Some(S::key(Key::I))),
        action(C::Toggle(Panel::Gantt), "Gantt chart", Some(S::key(Key::N))),
        action(C::Toggle(Panel::Curves), "Progress curves", None),
        action(C::Toggle(Panel::Timeline), "Timeline", Some(S::key(Key::T))),
        action(C::Toggle(Panel::Figures), "Frame figures", Some(S::key(Key::P))),
        action(C::Toggle(Panel::Graph), "Frame times", Some(S::key(Key::G))),
        action(C::Toggle(Panel::Sun), "Sun…", None),
        action(C::Toggle(Panel::Diagnostics), "Diagnostics", Some(S::key(Key::D))),
        action(C::ColorBy(ElementColors::Activity), "Color by activity", Some(S::key(Key::A))),
        action(C::ColorBy(ElementColors::Slip), "Color by slip", Some(S::shift(Key::A))),
        action(C::ColorBy(ElementColors::Storey), "Color by storey", None),
        action(C::ColorBy(ElementColors::Type), "Color by type", None),
        action(
            C::ColorBy(ElementColors::LookAhead(WEEKS_AHEAD)),
            "Color by look-ahead",
            Some(S::alt(Key::A)),
        ),
        action(C::ToggleLevelColors, "Color by level", Some(S::key(Key::C))),
        action(C::ToggleFade, "Fade between levels", None),
        action(C::ToggleScheme, "Dark or light", Some(S::command(Key::L))),
        action(C::TogglePlay, "Play or pause", Some(S::key(Key::Space))),
        action(C::PlayForward, "Play", Some(S::key(Key::L))),
        action(C::Pause, "Pause", Some(S::key(Key::K))),
        action(C::PlayBackward, "Play backward", Some(S::key(Key::J))),
        action(C::Stop, "Stop", None),
        action(C::LoopShown, "Loop what the timeline shows", Some(S::key(Key::R))),
        action(C::SetLoop(None), "No loop", Some(S::shift(Key::R))),
        action(C::FitTimeline, "Fit timeline", Some(S::shift(Key::T))),
        action(C::ToggleSkipIdle, "Skip non-working time", None),
        step(Step::Days(1), "Day forward", S::key(Key::ArrowRight)),
        step(Step::Days(-1), "Day back", S::key(Key::ArrowLeft)),
        step(Step::Days(7), "Week forward", S::shift(Key::ArrowRight)),
        step(Step::Days(-7), "Week back", S::shift(Key::ArrowLeft)),
        step(Step::Months(1), "Month forward", S::alt(Key::ArrowRight)),
        step(Step::Months(-1), "Month back", S::alt(Key::ArrowLeft)),
        step(Step::Hours(1), "Hour forward", S::key(Key::Period)),
        step(Step::Hours(-1), "Hour back", S::key(Key::Comma)),
        step(Step::Event(1), "Next event", S::command(Key::ArrowRight)),
        step(Step::Event(-1), "Previous event", S::command(Key::ArrowLeft)),
        action(C::ToStart, "Start of project", Some(S::key(Key::Home))),
        action(C::ToEnd, "End of project", Some(S::key(Key::End))),
        action(C::Faster, "Play faster", Some(S::key(Key::CloseBracket))),
        action(C::Slower, "Play slower", Some(S::key(Key::OpenBracket))),
        action(C::Toggle(Panel::Palette), "Command palette…", Some(S::command(Key::P))),
        action(C::Toggle(Panel::Table), "HDLOD table…", Some(S::command(Key::T))),
        action(C::Toggle(Panel::Shortcuts), "Keyboard shortcuts", Some(S::key(Key::F1))),
        action(C::ShowHint, "First steps", None),
        action(C::Toggle(Panel::About), "About topout…", None),
    ]
    .into_iter()
    .chain(Mouse::ALL.map(|(mouse, name)| action(C::SetMouse(mouse), name, None)))
    .chain([
        action(C::Compare(Against::Now), "Compare with the plan as it is now", None),
        action(C::Compare(Against::Dates(DateSet::Planned)), "Compare with planned dates", None),
        action(C::Compare(Against::Dates(DateSet::Actual)), "Compare with actual dates", None),
        action(C::Compare(Against::Dates(DateSet::Baseline)), "Compare with baseline dates", None),
        action(C::Compare(Against::Dates(DateSet::Forecast)), "Compare with forecast dates", None),
        action(C::CompareFile, "Compare with another schedule…", None),
        action(C::StopComparing, "Stop comparing", Some(S::key(Key::E))),
    ])
    .collect()
}

/// The commands that this frame's key presses ask for. Nothing while a text is being typed or a
/// menu is open, which Escape and the arrows belong to; nor what moves one while walking.
pub fn from_keys(ctx: &egui::Context, navigation: Navigation) -> Vec<Command> {
    // Escape takes the focus from a field before anybody else sees it.
    let typed = egui::Id::unique("typing");
    let (now, before) = (typing(ctx), ctx.data(|data| data.get_temp(typed).unwrap_or(false)));
    ctx.data_mut(|data| data.insert_temp(typed, now));
    if now || before || egui::Popup::is_any_open(ctx) {
        return Vec::new();
    }
    let actions = actions();
    let mut commands = Vec::new();
    ctx.input_mut(|input| {
        input.events.retain(|event| {
            let egui::Event::Key { key, pressed: true, modifiers, repeat, .. } = event else {
                return true;
            };
            if navigation.uses(*key) && !modifiers.command {
                return true;
            }
            let found = actions.iter().find(|a| {
                a.shortcut.is_some_and(|s| s.key == *key && modifiers.matches_exact(s.modifiers))
            });
            let Some(action) = found else { return true };
            if action.repeats || !repeat {
                commands.push(action.command.clone());
            }
            false
        });
    });
    commands
}

/// Whether the focused widget takes text.
fn typing(ctx: &egui::Context) -> bool {
    ctx.memory(|m| m.focused())
        .is_some_and(|id| egui::text_edit::TextEditState::load(ctx, id).is_some())
}

/// The keys of a command, as written in menus; empty where there are none.
pub fn keys_of(command: &Command) -> String {
    actions()
        .iter()
        .find(|a| a.command == *command)
        .and_then(|a| a.shortcut)
        .map_or_else(String::new, |s| s.text())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_actions_share_keys_or_a_command() {
        let actions = actions();
        for (i, a) in actions.iter().enumerate() {
            for b in &actions[i + 1..] {
                assert_ne!(a.command, b.command, "{} and {}", a.name, b.name);
                assert!(
                    a.shortcut.is_none() || a.shortcut != b.shortcut,
                    "{} and {} share keys",
                    a.name,
                    b.name
                );
            }
        }
    }

    #[test]
    fn keys_are_written_as_users_know_them() {
        assert_eq!(keys_of(&Command::OpenSchedule), "Ctrl+Shift+O");
        assert_eq!(keys_of(&Command::Step(Step::Days(7))), "Shift+Right");
        assert_eq!(keys_of(&Command::Step(Step::Months(-1))), "Alt+Left");
        assert_eq!(keys_of(&Command::Faster), "]");
        assert_eq!(keys_of(&Command::TogglePlay), "Space");
        assert_eq!(keys_of(&Command::CancelTable), "");
    }
}
