//! Tables that are readable in a terminal and valid in a Markdown file.

use super::say;

/// Prints rows of cells as a Markdown table with aligned columns. The first row is the head.
pub fn print(rows: &[Vec<String>]) {
    say(text(rows));
}

/// Returns rows of cells as the text of a Markdown table with aligned columns.
pub fn text(rows: &[Vec<String>]) -> String {
    let Some(head) = rows.first() else {
        return String::new();
    };
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..head.len()).map(width).collect();
    let mut lines = Vec::new();
    for (number, row) in rows.iter().enumerate() {
        let padded = row.iter().zip(&widths);
        let cells: Vec<String> = padded
            .map(|(cell, width)| format!("{cell:width$}"))
            .collect();
        lines.push(format!("| {} |\n", cells.join(" | ")));
        if number == 0 {
            let rules: Vec<String> = widths.iter().map(|width| "-".repeat(width + 2)).collect();
            lines.push(format!("|{}|\n", rules.join("|")));
        }
    }
    lines.concat()
}

/// Converts values to a row of cells.
pub fn cells<const N: usize>(cells: [impl ToString; N]) -> Vec<String> {
    cells.map(|cell| cell.to_string()).to_vec()
}
