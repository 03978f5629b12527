//! Bytes beside the document: external files and data URIs.

use std::borrow::Cow;
use std::path::{Component, Path};

/// The bytes behind a URI: a data URI or a file beside (or below) the document.
pub(super) fn fetch(folder: &Path, uri: &str) -> Result<Vec<u8>, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        return decode_data_uri(data);
    }
    let scheme = uri.split_once(':').filter(|(s, _)| {
        s.len() > 1 && s.bytes().all(|b| b.is_ascii_alphanumeric() || b"+-.".contains(&b))
    });
    if let Some((scheme, _)) = scheme {
        return Err(format!("{}: the scheme {scheme}: is not read", shorten(uri)));
    }
    let name = percent_decode(uri).ok_or_else(|| format!("{}: not a path", shorten(uri)))?;
    let relative = Path::new(name.as_ref());
    let mut depth = 0i32;
    for component in relative.components() {
        match component {
            Component::Normal(_) => depth += 1,
            Component::CurDir => {}
            Component::ParentDir => depth -= 1,
            Component::RootDir | Component::Prefix(_) => depth = -1,
        }
        if depth < 0 {
            return Err(format!("{name}: leaves the folder of the model"));
        }
    }
    let path = folder.join(relative);
    let problem = |e: std::io::Error| format!("{}: {e}", path.display());
    // A device or pipe could deliver bytes forever.
    if !std::fs::metadata(&path).map_err(problem)?.is_file() {
        return Err(format!("{}: not a file", path.display()));
    }
    std::fs::read(&path).map_err(problem)
}

/// A URI cut to a length that a message can hold.
pub(super) fn shorten(uri: &str) -> Cow<'_, str> {
    match uri.char_indices().nth(60) {
        Some((end, _)) => Cow::Owned(format!("{}...", &uri[..end])),
        None => Cow::Borrowed(uri),
    }
}

fn percent_decode(uri: &str) -> Option<Cow<'_, str>> {
    if !uri.contains('%') {
        return Some(Cow::Borrowed(uri)).filter(|u| !u.is_empty() && !u.contains('\0'));
    }
    let bytes = uri.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while i < bytes.len() {
        let digit = |at: usize| bytes.get(at).and_then(|&b| (b as char).to_digit(16));
        match (bytes[i], digit(i + 1), digit(i + 2)) {
            (b'%', Some(high), Some(low)) => {
                out.push((high * 16 + low) as u8);
                i += 3;
            }
            (byte, ..) => {
                out.push(byte);
                i += 1;
            }
        }
    }
    String::from_utf8(out).ok().filter(|u| !u.contains('\0')).map(Cow::Owned)
}

fn decode_data_uri(data: &str) -> Result<Vec<u8>, String> {
    let (head, body) = data.split_once(',').ok_or("data URI without a comma")?;
    if head.ends_with(";base64") {
        decode_base64(body.as_bytes())
    } else {
        percent_decode(body)
            .map(|text| text.into_owned().into_bytes())
            .ok_or_else(|| "data URI that is neither base64 nor text".to_owned())
    }
}

fn decode_base64(text: &[u8]) -> Result<Vec<u8>, String> {
    let text = text.trim_ascii_end();
    let end = text.iter().rposition(|&b| b != b'=').map_or(0, |p| p + 1);
    let mut out = Vec::with_capacity(end / 4 * 3 + 3);
    let (mut bits, mut held) = (0u32, 0u32);
    for (at, &byte) in text[..end].iter().enumerate() {
        let six = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            _ => return Err(format!("byte 0x{byte:02x} at {at} is not base64")),
        };
        bits = bits << 6 | u32::from(six);
        held += 6;
        if held >= 8 {
            held -= 8;
            out.push((bits >> held) as u8);
            bits &= (1 << held) - 1;
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn base64_of_every_length_decodes() {
        for (text, plain) in
            [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm8", "fo")]
        {
            assert_eq!(decode_base64(text.as_bytes()).unwrap(), plain.as_bytes());
        }
        assert!(decode_base64(b"Zm9v!").is_err());
    }

    #[test]
    fn paths_do_not_leave_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("sub dir")).unwrap();
        std::fs::write(folder.path().join("sub dir/a.bin"), b"abc").unwrap();
        std::fs::write(folder.path().join("b.bin"), b"b").unwrap();
        assert_eq!(fetch(folder.path(), "sub%20dir/a.bin").unwrap(), b"abc");
        assert_eq!(fetch(folder.path(), "sub dir/../b.bin").unwrap(), b"b");
        let inner = folder.path().join("sub dir");
        for bad in ["../b.bin", "/etc/hostname", "a/../../b.bin", "%2e%2e/b.bin"] {
            let message = fetch(&inner, bad).unwrap_err();
            assert!(message.contains("leaves the folder"), "{message}");
        }
        assert!(fetch(&inner, "https://example.org/x.bin").unwrap_err().contains("https"));
        assert!(fetch(&inner, "file:///etc/hostname").unwrap_err().contains("file"));
        assert!(fetch(&inner, "missing.bin").unwrap_err().contains("missing.bin"));
        assert!(fetch(folder.path(), "sub dir").unwrap_err().contains("not a file"));
        assert!(fetch(folder.path(), "a\0b").is_err());
        assert!(fetch(folder.path(), "").is_err());
    }
}
