//! Writes mutants into a copy of the source, so that all of them are compiled once.
//!
//! ```text
//! tumble_weave MUTANTS.json FOLDER
//! ```
//!
//! `MUTANTS.json` is a list of mutants as `cargo mutants --list --json` prints it, each with an
//! `id` above 0. `FOLDER` is the copy. An expression `a + b` with the mutant 7 becomes
//! `(if crate::mutant(7) { a - b } else { a + b })`. The program prints the ids of the mutants that
//! it has not written: those in a constant, where no function of this kind can be called, and those
//! whose expression it has not found.

mod edit;
mod node;

use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;
use std::{env, fs};

/// Mutant of one expression or of one function.
#[derive(Clone, Debug, Deserialize)]
struct Mutant {
    id: u32,
    file: String,
    genre: String,
    replacement: String,
    span: Span,
}

#[derive(Clone, Copy, Debug, Deserialize)]
struct Span {
    start: Place,
}

/// Place in a file, counted from 1.
#[derive(Clone, Copy, Debug, Deserialize)]
struct Place {
    line: usize,
    column: usize,
}

impl Place {
    /// Number of bytes before the place.
    fn offset(self, text: &str) -> Option<usize> {
        let line = text.split_inclusive('\n').nth(self.line - 1)?;
        let before: usize = (text.split_inclusive('\n').take(self.line - 1))
            .map(str::len)
            .sum();
        let column: usize = line.chars().take(self.column - 1).map(char::len_utf8).sum();
        Some(before + column)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = env::args().skip(1);
    let (Some(list), Some(folder)) = (arguments.next(), arguments.next()) else {
        return Err("usage: tumble_weave MUTANTS.json FOLDER".into());
    };
    let mutants: Vec<Mutant> = serde_json::from_str(&fs::read_to_string(list)?)?;
    let mut by_file: BTreeMap<String, Vec<Mutant>> = BTreeMap::new();
    for mutant in mutants {
        by_file.entry(mutant.file.clone()).or_default().push(mutant);
    }
    for (file, mutants) in by_file {
        let path = Path::new(&folder).join(&file);
        let text = fs::read_to_string(&path)?;
        let (woven, left) = weave(&text, &mutants)?;
        fs::write(&path, woven)?;
        for id in left {
            println!("{id}");
        }
    }
    Ok(())
}

/// Returns the text with the mutants, and the ids of those that are left out.
fn weave(text: &str, mutants: &[Mutant]) -> syn::Result<(String, Vec<u32>)> {
    let mut at: BTreeMap<usize, Vec<&Mutant>> = BTreeMap::new();
    for mutant in mutants {
        if let Some(offset) = mutant.span.start.offset(text) {
            at.entry(offset).or_default().push(mutant);
        }
    }
    let (edits, written) = node::edits(text, &syn::parse_file(text)?, &at);
    let left = mutants.iter().map(|mutant| mutant.id);
    let left = left.filter(|id| !written.contains(id)).collect();
    Ok((edit::apply(text, edits), left))
}
