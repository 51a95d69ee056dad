//! Text of a page between two marks, which a command writes.

use core::error::Error;
use std::fs;
use std::path::Path;

use super::say;

/// Replaces the text between two marks of a page of the repository.
pub fn write(page: &str, [begin, end]: [&str; 2], text: &str) -> Result<(), Box<dyn Error>> {
    let page = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join(page);
    let old = fs::read_to_string(&page)?;
    let (before, rest) = old.split_once(begin).ok_or("the page has lost its mark")?;
    let (_, after) = rest
        .split_once(end)
        .ok_or("the page has lost its end mark")?;
    fs::write(&page, format!("{before}{begin}\n\n{text}\n{end}{after}"))?;
    say(format_args!("written: {}\n", page.display()));
    Ok(())
}
