//! Text of a page between two marks, which a command writes.

use core::error::Error;
use std::path::Path;

use super::{read_text, say, write_file};

/// Replaces the text between two marks of a page of the repository. In a Rust file it becomes part
/// of the documentation comment. A page that has this text already is not written.
pub fn write(page: &str, [begin, end]: [&str; 2], text: &str) -> Result<(), Box<dyn Error>> {
    let page = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join(page);
    let old = read_text(&page)?;
    let (before, rest) = old.split_once(begin).ok_or("the page has lost its mark")?;
    let (_, after) = rest
        .split_once(end)
        .ok_or("the page has lost its end mark")?;
    let text = format!("\n\n{text}\n");
    let text = match page.extension().is_some_and(|extension| extension == "rs") {
        true => text.replace('\n', "\n/// ").replace("/// \n", "///\n"),
        false => text,
    };
    let new = format!("{before}{begin}{text}{end}{after}");
    // A page that is not touched need not be compiled again.
    if new == old {
        say(format_args!("unchanged: {}\n", page.display()));
    } else {
        write_file(&page, new)?;
        say(format_args!("written: {}\n", page.display()));
    }
    Ok(())
}

/// Breaks a paragraph into lines of at most 100 columns.
pub fn wrapped(text: &str) -> String {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.last_mut().filter(|line| {
            line.is_empty() || line.chars().count() + 1 + word.chars().count() <= 100
        });
        match line {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) => {
                line.push(' ');
                line.push_str(word);
            }
            None => lines.push(word.to_owned()),
        }
    }
    lines.join("\n")
}
