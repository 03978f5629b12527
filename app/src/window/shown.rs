//! What of the window and of the scene's colours is shown: plain values.

/// Which panels are unfolded.
#[derive(Clone, Copy, PartialEq, Debug, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Panels {
    /// See [`super::command::Panel`].
    pub gantt: bool,
    /// See [`super::command::Panel`].
    pub tree: bool,
    /// See [`super::command::Panel`].
    pub curves: bool,
    /// See [`super::command::Panel`].
    pub palette: bool,
    /// See [`super::command::Panel`].
    pub export: bool,
    /// See [`super::command::Panel`].
    pub viewpoints: bool,
    /// See [`super::command::Panel`].
    pub section: bool,
    /// See [`super::command::Panel`].
    pub inspector: bool,
    /// See [`super::command::Panel`].
    pub timeline: bool,
    /// See [`super::command::Panel`].
    pub figures: bool,
    /// See [`super::command::Panel`].
    pub graph: bool,
    /// See [`super::command::Panel`].
    pub sun: bool,
    /// See [`super::command::Panel`].
    pub diagnostics: bool,
    /// See [`super::command::Panel`].
    pub table: bool,
    /// See [`super::command::Panel`].
    pub shortcuts: bool,
    /// See [`super::command::Panel`].
    pub about: bool,
}

impl Default for Panels {
    fn default() -> Self {
        Self {
            gantt: false,
            tree: false,
            curves: true,
            palette: false,
            export: false,
            viewpoints: false,
            section: false,
            inspector: true,
            timeline: true,
            figures: true,
            graph: false,
            sun: false,
            diagnostics: false,
            table: false,
            shortcuts: false,
            about: false,
        }
    }
}

/// Weeks that a look-ahead shows at first.
pub const WEEKS_AHEAD: u8 = 4;

/// Which colours elements have.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, serde::Serialize, serde::Deserialize)]
pub enum ElementColors {
    /// Those of the model.
    Own,
    /// Those of what activities do to them.
    Activity,
    /// How much earlier or later their activities are than planned.
    Slip,
    /// Their storeys.
    Storey,
    /// Their types.
    Type,
    /// What starts within so many weeks.
    LookAhead(u8),
}
