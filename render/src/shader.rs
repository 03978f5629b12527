//! The text of shaders: what was compiled in, or, while they are worked on, what their files say now.

use crate::cull::gpu::KERNELS;
use crate::passes::SHADERS;
use std::borrow::Cow;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

/// A shader, made of files that follow each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shader {
    pub name: &'static str,
    /// Names below `shaders/`.
    pub files: &'static [&'static str],
    /// What they said when this was compiled.
    pub text: &'static str,
}

/// The shader of a name, made of files below `shaders/`.
macro_rules! shader {
    ($name:literal, $($file:literal),+ $(,)?) => {
        $crate::shader::Shader {
            name: $name,
            files: &[$($file),+],
            text: concat!(
                $(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../shaders/", $file))),+
            ),
        }
    };
}
pub(crate) use shader;

/// Every shader that is compiled.
pub(crate) fn all() -> impl Iterator<Item = Shader> {
    SHADERS.into_iter().chain(KERNELS)
}

/// Texts of files that stand in for what was compiled in; by default there are none.
#[derive(Clone, Debug, Default)]
pub(crate) struct ShaderTexts(Option<Arc<HashMap<&'static str, String>>>);

impl ShaderTexts {
    pub fn of(&self, shader: Shader) -> Cow<'static, str> {
        let text = |file| self.0.as_ref()?.get(file).map(String::as_str);
        let texts: Option<String> = shader.files.iter().map(|file| text(*file)).collect();
        texts.map_or(Cow::Borrowed(shader.text), Cow::Owned)
    }
}

/// Why shaders were not taken over from their files.
#[derive(Debug, thiserror::Error)]
pub enum ShaderError {
    /// A file cannot be read.
    #[error("{}: {source}", file.display())]
    Unreadable {
        /// Which.
        file: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// What the files say is not valid, or does not fit what the program gives to it.
    #[error("the shaders stay as they were: {0}")]
    Invalid(String),
}

/// The folder of the shaders' files, looked after while they are worked on.
#[derive(Debug)]
pub struct ShaderFolder {
    folder: PathBuf,
    stamps: Vec<Stamp>,
}

/// Last change and length of a file; `None` where it cannot be looked at.
type Stamp = Option<(SystemTime, u64)>;

impl ShaderFolder {
    /// What counts as changed is what differs from now on.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        let folder = folder.into();
        Self { stamps: stamps(&folder), folder }
    }

    /// The folder that the program was compiled from.
    pub fn of_source() -> Self {
        Self::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../shaders"))
    }

    /// Whether a file has changed since the last call.
    pub fn has_changed(&mut self) -> bool {
        let now = stamps(&self.folder);
        std::mem::replace(&mut self.stamps, now) != self.stamps
    }

    /// What the files say now.
    ///
    /// # Errors
    /// [`ShaderError::Unreadable`]
    pub(crate) fn read(&self) -> Result<ShaderTexts, ShaderError> {
        let read = |name| {
            let file = self.folder.join(name);
            match std::fs::read_to_string(&file) {
                Ok(text) => Ok((name, text)),
                Err(source) => Err(ShaderError::Unreadable { file, source }),
            }
        };
        let texts: Result<_, _> = files().map(read).collect();
        Ok(ShaderTexts(Some(Arc::new(texts?))))
    }
}

/// The files of all shaders, some more than once.
fn files() -> impl Iterator<Item = &'static str> {
    all().flat_map(|shader| shader.files.iter().copied())
}

fn stamps(folder: &Path) -> Vec<Stamp> {
    let stamp = |file: &str| {
        let data = std::fs::metadata(folder.join(file)).ok()?;
        Some((data.modified().ok()?, data.len()))
    };
    files().map(stamp).collect()
}
