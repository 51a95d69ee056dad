//! Page of an example: text, film, pictures and checked figures. It is `page.html` with these
//! written into it.

use core::fmt::Write as _;

use super::picture::{Entry, Mark, Narrow};
use super::{Film, Options, Outcome, Picture, make_folder, say, write_file};

const TEMPLATE: &str = include_str!("page.html");
/// Placeholders of the template.
const TITLE: &str = "<!--TITLE-->";
const BODY: &str = "<!--BODY-->";
/// File of the film, next to the page.
const PLAY: &str = "play.html";

/// Page of an example.
#[derive(Debug)]
pub struct Page {
    pub title: &'static str,
    /// Paragraphs of the text. One that begins with `|` is a Markdown table, as
    /// [`table::text`](super::table::text) writes it.
    pub text: Vec<String>,
    pub checks: Vec<Check>,
    pub pictures: Vec<Picture>,
    /// Film of the run, written to `play.html` next to the page.
    pub film: Option<Film>,
}

impl Page {
    /// Writes the page and its pictures, and prints the figures. Returns true if all figures are as
    /// expected.
    pub fn write(&self, name: &str, options: &Options) -> Outcome<bool> {
        let folder = options.out.join(name);
        make_folder(&folder)?;
        for picture in &self.pictures {
            picture.write(&folder)?;
        }
        if let Some(film) = &self.film {
            film.write(&folder.join(PLAY))?;
        }
        let page = folder.join(name).with_extension("html");
        write_file(&page, self.html()?)?;
        self.print();
        say(format_args!("Written: {}\n", page.display()));
        Ok(self.checks.iter().all(Check::holds))
    }

    /// The tables of the page.
    pub fn tables(&self) -> String {
        let tables = self.text.iter().filter(|text| text.starts_with('|'));
        let tables: Vec<_> = tables.map(|table| compact(table)).collect();
        tables.join("\n\n")
    }

    fn print(&self) {
        say(format_args!("{}\n", self.title));
        for paragraph in &self.text {
            say(format_args!("{paragraph}\n"));
        }
        for check in &self.checks {
            let [what, got, range, result, source] = check.cells();
            say(format_args!(
                "  {result}  {what}: {got}, expected {range}\n        ({source})\n"
            ));
        }
    }

    fn html(&self) -> Result<String, core::fmt::Error> {
        // The film comes before the tables, so that it is seen first.
        let is_table = |text: &&String| text.starts_with('|');
        let (tables, text): (Vec<&String>, Vec<_>) = self.text.iter().partition(is_table);
        let html = |texts: Vec<&String>| texts.into_iter().map(|text| paragraph(text)).collect();
        let body = [
            html(text),
            self.film_html(),
            html(tables),
            self.pictures_html()?,
            self.checks_html()?,
        ];
        let page = TEMPLATE.replace(TITLE, &escaped(self.title));
        Ok(page.replace(BODY, &body.concat()))
    }

    fn film_html(&self) -> String {
        match self.film {
            None => String::new(),
            Some(_) => format!(
                "<iframe src=\"{PLAY}\" title=\"Film of the run\"></iframe>\n\
                 <p><a href=\"{PLAY}\">The film alone</a></p>\n"
            ),
        }
    }

    fn pictures_html(&self) -> Result<String, core::fmt::Error> {
        let mut html = String::new();
        for (number, picture) in self.pictures.iter().enumerate() {
            let (name, svg) = (picture.name(), picture.svg(&number.to_string()));
            let (class, narrow) = match picture.narrow() {
                Some(narrow) => ("both", narrow_html(narrow, &format!("{number}n"))),
                None => ("one", String::new()),
            };
            // A picture of one width is scrolled on a narrow screen, by the keyboard too.
            writeln!(
                html,
                "<figure class=\"{class}\"><div class=\"narrow\">{narrow}</div>\
                 <div class=\"full\" tabindex=\"0\" role=\"group\" \
                 aria-label=\"Picture: {name}\">{svg}</div></figure>"
            )?;
        }
        Ok(html)
    }

    fn checks_html(&self) -> Result<String, core::fmt::Error> {
        if self.checks.is_empty() {
            return Ok(String::new());
        }
        let columns = ["figure", "value", "expected", "result", "source"];
        let head = columns.map(|column| format!("<th scope=\"col\">{column}</th>"));
        let mut html = format!(
            "<h2>Checked figures</h2>\n<table class=\"checks\"><thead><tr>{}</tr></thead><tbody>\n",
            head.concat()
        );
        for check in &self.checks {
            html.push_str("<tr>");
            for (column, cell) in columns.into_iter().zip(check.cells()) {
                let class = if cell == "fail" {
                    " class=\"fail\""
                } else {
                    ""
                };
                // One element, so that a narrow screen has two columns: the name and the cell.
                let cell = escaped(&cell);
                write!(
                    html,
                    "<td data-column=\"{column}\"{class}><span>{cell}</span></td>"
                )?;
            }
            html.push_str("</tr>\n");
        }
        html.push_str("</tbody></table>\n");
        Ok(html)
    }
}

/// Returns the title, the drawing and the legend of a picture for a phone.
fn narrow_html(picture: &Narrow, tag: &str) -> String {
    let entry = |entry: &Entry| {
        let class = match entry.mark {
            Mark::Line => "line",
            Mark::Dashes => "dashes",
            Mark::Dots => "dots",
        };
        let (colour, name) = (&entry.colour, escaped(&entry.name));
        format!("<li class=\"{class}\" style=\"--colour: {colour}\">{name}</li>")
    };
    let (title, svg) = (escaped(&picture.title), picture.svg(tag));
    let legend: String = picture.legend.iter().map(entry).collect();
    format!("<figcaption>{title}</figcaption>{svg}<ul class=\"legend\">{legend}</ul>")
}

/// Returns a paragraph or a Markdown table as HTML.
fn paragraph(text: &str) -> String {
    if !text.starts_with('|') {
        return format!("<p>{}</p>\n", spans(text));
    }
    let mut rows = String::new();
    // The second line is the rule below the head.
    for (number, line) in text.lines().enumerate().filter(|&(number, _)| number != 1) {
        let tag = if number == 0 { "th" } else { "td" };
        let cells = line.trim().trim_matches('|').split('|');
        let cells = cells.map(|cell| format!("<{tag}>{}</{tag}>", spans(cell.trim())));
        rows += &format!("<tr>{}</tr>\n", cells.collect::<String>());
    }
    format!("<div class=\"wide\" tabindex=\"0\"><table>\n{rows}</table></div>\n")
}

/// Returns a text in HTML, with code between backticks and bold text between double asterisks.
fn spans(text: &str) -> String {
    let marked = |text: &str, mark: &str, tag: &str| {
        let mut html = String::new();
        for (number, part) in text.split(mark).enumerate() {
            html += &match number % 2 {
                0 => part.to_owned(),
                _ => format!("<{tag}>{part}</{tag}>"),
            };
        }
        html
    };
    marked(&marked(&escaped(text), "`", "code"), "**", "strong")
}

/// Returns a text without the characters that have a meaning in HTML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}

/// Returns a table without the spaces and rules that align its columns.
fn compact(table: &str) -> String {
    let cell = |cell: &str| match cell.trim() {
        "" => String::new(),
        rule if rule.bytes().all(|byte| byte == b'-') => "---".to_owned(),
        text => format!(" {text} "),
    };
    let row = |line: &str| line.split('|').map(cell).collect::<Vec<_>>().join("|");
    table.lines().map(row).collect::<Vec<_>>().join("\n")
}

/// A figure with its expected value.
#[derive(Debug)]
pub struct Check {
    /// Name of the figure, with its unit.
    pub what: String,
    /// Source of the expected value.
    pub source: String,
    pub got: f64,
    pub least: f64,
    pub most: f64,
}

impl Check {
    /// Checks that a figure is within `tolerance` of the expected value.
    pub fn near(what: &str, source: &str, got: f64, expected: f64, tolerance: f64) -> Self {
        Self::between(
            what,
            source,
            got,
            expected - tolerance,
            expected + tolerance,
        )
    }

    /// Checks that a figure is in a range.
    pub fn between(what: &str, source: &str, got: f64, least: f64, most: f64) -> Self {
        Self {
            what: what.to_owned(),
            source: source.to_owned(),
            got,
            least,
            most,
        }
    }

    /// Checks that the energy never increases in any of several runs (promise G1).
    pub fn energy(runs: impl IntoIterator<Item = Vec<f64>>) -> Self {
        let gains =
            |run: Vec<f64>| -> Vec<f64> { run.windows(2).map(|pair| pair[1] - pair[0]).collect() };
        Self::energy_gains("between two moments", runs.into_iter().flat_map(gains))
    }

    /// Checks that none of the changes of an energy (J) is above 0 (promise G1). `when` says what
    /// they are between. It fails without a change, and for one that is not finite.
    pub fn energy_gains(when: &str, gains: impl IntoIterator<Item = f64>) -> Self {
        let larger = |one: f64, other: f64| if one >= other { one } else { other };
        let gains = gains.into_iter();
        let largest = gains.map(|gain| {
            if gain.is_finite() {
                gain
            } else {
                f64::INFINITY
            }
        });
        Self::between(
            &format!("largest increase of the energy {when}, J"),
            "EnergyMomentum: the energy never increases",
            largest.reduce(larger).unwrap_or(f64::INFINITY),
            f64::NEG_INFINITY,
            0.0,
        )
    }

    fn holds(&self) -> bool {
        self.least <= self.got && self.got <= self.most
    }

    /// Cells of the table: name, figure, expected value, result and source.
    fn cells(&self) -> [String; 5] {
        let [least, most] = [self.least, self.most].map(rounded);
        let range = match (self.least.is_finite(), self.most.is_finite()) {
            (true, true) => format!("{least} to {most}"),
            (true, false) => format!("at least {least}"),
            (false, true) => format!("at most {most}"),
            (false, false) => "anything".to_owned(),
        };
        [
            self.what.clone(),
            rounded(self.got),
            range,
            if self.holds() { "pass" } else { "fail" }.to_owned(),
            self.source.clone(),
        ]
    }
}

/// Formats a number with six significant digits, without trailing zeros.
fn rounded(value: f64) -> String {
    let (mantissa, power) = split(value, 5);
    let shown = match power {
        -3..=5 => format!("{value:.*}", usize::try_from(5 - power).unwrap_or(0)),
        _ => mantissa,
    };
    let plain = match shown.contains('.') {
        true => shown.trim_end_matches('0').trim_end_matches('.'),
        false => &shown,
    };
    match power {
        -3..=5 => plain.to_owned(),
        _ => format!("{plain}e{power}"),
    }
}

/// Splits a number into a factor between 1 and 10 with `places` places, and a power of ten.
fn split(value: f64, places: usize) -> (String, i32) {
    let text = format!("{value:.places$e}");
    let (mantissa, power) = text.split_once('e').unwrap_or((&text, "0"));
    (mantissa.to_owned(), power.parse().unwrap_or(0))
}
