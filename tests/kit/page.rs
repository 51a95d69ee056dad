//! Tables of the guide that a test writes.

use std::fs;
use std::path::{Path, PathBuf};

/// Rows of a table in a page of the guide.
pub(crate) struct Table {
    /// Name of the page, without its ending.
    pub(crate) page: &'static str,
    /// Text before the rows: a mark that names the command that writes them, and the headings.
    pub(crate) begin: &'static str,
    /// Text after the rows.
    pub(crate) end: &'static str,
    /// Command that stores other rows.
    pub(crate) command: &'static str,
}

impl Table {
    /// Fails if the page has other rows. With `UPDATE` in the environment it stores these.
    pub(crate) fn has(&self, rows: &str) {
        let page = fs::read_to_string(self.file()).unwrap();
        let (before, rest) = page.split_once(self.begin).unwrap();
        let (stored, after) = rest.split_once(self.end).unwrap();
        if std::env::var_os("UPDATE").is_some() {
            let text = [before, self.begin, rows, self.end, after].concat();
            fs::write(self.file(), text).unwrap();
        } else {
            assert!(
                stored == rows,
                "the table has changed; `UPDATE=1 {}` stores it if that is meant\n\
                 stored:\n{stored}\nnow:\n{rows}",
                self.command
            );
        }
    }

    fn file(&self) -> PathBuf {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/guide");
        folder.join(self.page).with_extension("md")
    }
}
