//! What the program tells: text for people, one JSON object for scripts, memory figures.

use anyhow::Context;
use serde::Serialize;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};

/// Where a sub-command's results go.
///
/// Text goes to standard output, unless something for scripts goes there: then to a terminal on standard error.
#[derive(Clone, Debug, Default)]
pub struct Output {
    json: Option<PathBuf>,
    /// Standard output holds something for scripts.
    stdout_taken: bool,
}

/// Whether a file's name stands for standard output.
pub fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Writes a whole file, or to standard output where its name is `-`. A reader of that which went away is
/// no error.
///
/// # Errors
/// When the file cannot be written; names it.
pub fn write_file(path: &Path, text: &str) -> anyhow::Result<()> {
    if is_stdout(path) {
        let _ = std::io::stdout().write_all(text.as_bytes());
        return Ok(());
    }
    std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
}

impl Output {
    /// `json` is the value of `--json`.
    pub fn new(json: Option<PathBuf>) -> Self {
        let stdout_taken = json.as_deref().is_some_and(is_stdout);
        Self { json, stdout_taken }
    }

    /// The same where another file is written, too.
    pub fn beside(self, file: Option<&Path>) -> Self {
        Self { stdout_taken: self.stdout_taken || file.is_some_and(is_stdout), ..self }
    }

    /// Prints text for people. A reader that went away (`| head`) is no error.
    pub fn say(&self, text: &str) {
        let text = text.trim_end();
        if !self.stdout_taken {
            let _ = writeln!(std::io::stdout(), "{text}");
        } else if std::io::stderr().is_terminal() {
            let _ = writeln!(std::io::stderr(), "{text}");
        }
    }

    /// Writes the object that scripts read, where `--json` asks for it.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, report: &impl Serialize) -> anyhow::Result<()> {
        let Some(path) = &self.json else { return Ok(()) };
        let mut text = serde_json::to_string_pretty(report).context("cannot write JSON")?;
        text.push('\n');
        write_file(path, &text)
    }
}

/// An error and what caused it, on one line; a cause that is told already is not repeated.
pub fn describe(error: &anyhow::Error) -> String {
    let mut text = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if text.is_empty() {
            text = cause;
        } else if !text.contains(&cause) {
            text = format!("{text}: {cause}");
        }
    }
    text
}

/// A number with thousands separated: 3,632,126.
pub fn grouped(number: impl Into<u64>) -> String {
    let digits = number.into().to_string();
    let mut text = String::with_capacity(digits.len() * 4 / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A count as `u64`, for [`grouped`].
pub fn count(number: usize) -> String {
    grouped(number as u64)
}

/// Rounded to a number of decimals, so that JSON stays readable.
pub fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10f64.powi(decimals);
    // Without the sign of a zero.
    (value * scale).round() / scale + 0.0
}

/// Memory that the process holds now, in MB (10^6 bytes); `None` where the system does not say.
pub fn rss_mb() -> Option<f64> {
    status_mb("VmRSS:")
}

/// The most memory that the process has held, in MB (10^6 bytes).
pub fn peak_rss_mb() -> Option<f64> {
    status_mb("VmHWM:")
}

fn status_mb(key: &str) -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(key))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(rounded(kib * 1024.0 / 1e6, 1))
}

/// Text in columns: the first to the left, the others to the right.
pub fn columns(rows: &[Vec<String>]) -> String {
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|c| c.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..rows.iter().map(Vec::len).max().unwrap_or(0)).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (column, cell) in row.iter().enumerate() {
            let width = widths[column];
            if column == 0 {
                line.push_str(&format!("{cell:<width$}"));
            } else {
                line.push_str(&format!("  {cell:>width$}"));
            }
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_are_told_once() {
        let cause = std::io::Error::other("disk on fire");
        let error = anyhow::Error::new(cause).context("a.glb: disk on fire").context("loading");
        assert_eq!(describe(&error), "loading: a.glb: disk on fire");
    }

    #[test]
    fn thousands_are_separated() {
        assert_eq!(grouped(0u64), "0");
        assert_eq!(grouped(999u64), "999");
        assert_eq!(grouped(1000u64), "1,000");
        assert_eq!(grouped(3_632_126u64), "3,632,126");
    }

    #[test]
    fn columns_line_up() {
        let rows = [vec!["a".into(), "1".into()], vec!["long".into(), "1,000".into()]];
        assert_eq!(columns(&rows), "a         1\nlong  1,000\n");
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn memory_is_that_of_this_process() {
        let (now, peak) = (rss_mb(), peak_rss_mb());
        assert!(now.is_some_and(|mb| mb > 1.0), "{now:?}");
        let ballast = std::hint::black_box(vec![1u8; 50_000_000]);
        assert!(peak_rss_mb() >= peak.map(|mb| mb + 30.0), "{peak:?} {:?}", peak_rss_mb());
        drop(ballast);
    }
}
