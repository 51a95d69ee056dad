//! Card of an example on the page.

use common::page::escaped;

use crate::exhibits::{Exhibit, Thumbnail};
use crate::run::Shown;

/// Returns the card: thumbnail, title, text, result, and the command that writes the page.
pub(crate) fn html(shown: &Shown) -> String {
    let exhibit = &shown.exhibit;
    let (class, result) = match shown.is_as_expected() {
        true => ("quiet", shown.result()),
        false => ("fail", shown.result()),
    };
    format!(
        "<li>\n<div class=\"thumbnail\">{}</div>\n<div class=\"text\">\
         <h2><a href=\"{}\">{}</a></h2>\n\
         <p>{}</p>\n<p class=\"{class}\">{}</p>\n<code>{}</code></div>\n</li>\n",
        thumbnail(exhibit),
        exhibit.page(),
        escaped(exhibit.title),
        escaped(exhibit.text),
        escaped(&result),
        escaped(&command(exhibit)),
    )
}

/// The link next to a thumbnail describes it, so that it has no text and takes no focus.
fn thumbnail(exhibit: &Exhibit) -> String {
    match exhibit.thumbnail {
        Thumbnail::Film(start) => format!(
            "<iframe src=\"{}#thumb={start}\" title=\"\" aria-hidden=\"true\" tabindex=\"-1\" \
             loading=\"lazy\"></iframe>",
            exhibit.play()
        ),
        Thumbnail::Drawing(file) => {
            format!(
                "<img src=\"{}/{file}\" alt=\"\" loading=\"lazy\">",
                exhibit.name
            )
        }
    }
}

fn command(exhibit: &Exhibit) -> String {
    let options = match exhibit.options {
        [] => String::new(),
        options => format!(" -- {}", options.join(" ")),
    };
    format!("cargo run --release --example {}{options}", exhibit.name)
}
