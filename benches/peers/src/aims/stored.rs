//! Aims whose figures other commands of the repository measure and store.

use std::fs;
use std::path::Path;

use crate::aims::Aim;

fn stored(path: &str) -> Result<String, String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(path);
    fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))
}

/// Instructions of a step on one round edge over those on 120 points (`.ci/instructions`).
pub(super) fn of_round_edges() -> Result<Vec<Aim>, String> {
    let counts = stored("benches/instructions.txt")?;
    let count = |integrator: &str, phase: &str, scene: &str| -> Result<f64, String> {
        let wanted = [integrator, phase, scene];
        (counts.lines())
            .map(|line| line.split_whitespace().collect::<Vec<_>>())
            .find_map(|cells| {
                (cells.len() == 4 && cells[..3] == wanted).then(|| cells[3].parse().ok())
            })
            .flatten()
            .ok_or_else(|| format!("no count of {integrator} {phase} {scene}"))
    };
    let mut aims = Vec::new();
    for (integrator, phase, at_most) in [
        ("SymplecticEuler", "upright", 1.5),
        ("SymplecticEuler", "tumbling", 1.5),
        ("Rk4", "upright", 1.5),
        ("Rk4", "tumbling", 1.5),
        ("EnergyMomentum", "upright", 2.0),
    ] {
        let ratio = count(integrator, phase, "round")? / count(integrator, phase, "120")?;
        let what = format!("`{integrator}`, {phase}: instructions of a round edge over 120 points");
        aims.push(Aim::new(what, at_most, Some(ratio)));
    }
    Ok(aims)
}

/// Cost of a decided toss (`--example known_outcomes -- --methods --write`).
pub(super) fn of_tosses() -> Result<Vec<Aim>, String> {
    let page = stored("src/guide/outcomes.md")?;
    let heading = "| scene | labels, % | in µs |";
    let rows = (page.lines())
        .skip_while(|line| !line.starts_with(heading))
        .skip(2)
        .take_while(|line| line.starts_with('|'));
    let aims: Option<Vec<Aim>> = rows
        .map(|line| {
            let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
            let [scene, labels, at_most, measured, _] = cells[..] else {
                return None;
            };
            let what = format!("a decided toss, {scene}, {labels} % of the labels right");
            let aim = Aim::new(what, at_most.parse().ok()?, measured.parse().ok());
            Some(aim.in_unit("µs"))
        })
        .collect();
    aims.filter(|aims| !aims.is_empty())
        .ok_or_else(|| format!("src/guide/outcomes.md has no table \"{heading}\""))
}
