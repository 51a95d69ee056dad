//! Texts that are inserted.

/// Text that is inserted before a byte.
///
/// Several texts at one place are in the order of `rank`: ends of expressions first, the inner ones
/// before the outer ones, then beginnings, the outer ones before the inner ones.
#[derive(Debug)]
pub(crate) struct Edit {
    pub(crate) offset: usize,
    pub(crate) rank: i32,
    pub(crate) text: String,
}

/// Inserts all texts.
pub(crate) fn apply(source: &str, mut edits: Vec<Edit>) -> String {
    edits.sort_by_key(|edit| (edit.offset, edit.rank));
    let (mut result, mut done) = (String::new(), 0);
    for edit in edits {
        result.push_str(&source[done..edit.offset]);
        result.push_str(&edit.text);
        done = edit.offset;
    }
    result.push_str(&source[done..]);
    result
}
