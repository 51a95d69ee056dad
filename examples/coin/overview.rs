//! Page of all eight trials: `overview.html`, with links to the page of each.

use std::path::Path;

use common::{Outcome, write_file};

use crate::milestones::Milestones;
use crate::pictures;
use crate::recording::Recording;
use crate::setup::Setup;
use crate::summary::{describe_skidding, describe_time};

const TEMPLATE: &str = include_str!("overview.html");
/// Placeholder of the trials in the template.
const PLACE: &str = "<!--TRIALS-->";

/// Folder of a trial, next to the overview.
pub(crate) fn folder(setup: &Setup) -> String {
    format!("trial-{}", setup.number)
}

/// Writes the page.
pub(crate) fn write(cards: &[String], path: &Path) -> Outcome<()> {
    write_file(path, TEMPLATE.replace(PLACE, &cards.concat()))
}

/// One trial of the overview: its parameters, pictures, milestones and links.
pub(crate) fn card(recording: &Recording) -> String {
    let title = recording.setup.title();
    let parameters = recording.setup.parameters();
    let folder = folder(&recording.setup);
    let [energy, track] = pictures::small(recording);
    let facts = facts(recording);
    format!(
        r#"<article>
<h2><a href="{folder}/coin.html">{title}</a></h2>
<p>{parameters}</p>
<div class="pictures"><a href="{folder}/energy.svg">{energy}</a><a href="{folder}/track.svg">{track}</a></div>
<dl>{facts}</dl>
<p class="links"><a class="play" href="{folder}/coin.html">Play in 3-D</a> <a href="{folder}/slip.svg">slip speed</a> <a href="{folder}/centre.svg">centre</a> <a href="{folder}/coin.csv">table (CSV)</a></p>
</article>
"#
    )
}

fn facts(recording: &Recording) -> String {
    let milestones = Milestones::of(recording);
    let energy = format!("{:.2} J", recording.first().energy.total());
    let facts = [
        ("skids", describe_skidding(milestones.skidding)),
        ("passes 45°", describe_time(milestones.halfway_down)),
        ("settles", describe_time(milestones.settled)),
        ("energy at the start", energy),
    ];
    let item = |(name, value)| format!("<div><dt>{name}</dt><dd>{value}</dd></div>");
    facts.map(item).concat()
}
