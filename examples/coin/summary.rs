//! Summary of a run in about twelve lines of text.

use std::fmt;

use tumble::Energy;

use crate::milestones::{Milestones, Skidding};
use crate::recording::{Audit, Recording};
use crate::tally::Tally;

/// Summary of a run, with `Display`.
#[derive(Debug)]
pub(crate) struct Summary<'a>(pub(crate) &'a Recording);

impl fmt::Display for Summary<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let recording = self.0;
        let setup = &recording.setup;
        writeln!(out, "{}: {}", setup.title(), setup.parameters())?;
        writeln!(out, "  {}", setup.computation())?;
        write_milestones(out, Milestones::of(recording))?;
        write_energy(out, "energy at the start", recording.first().energy)?;
        write_energy(out, "energy at the end", recording.last().energy)?;
        match recording.audit {
            Some(audit) => write_audit(out, audit)?,
            None => write_line(out, "energy audit", "none")?,
        }
        if recording.tally.iterations > 0 {
            write_tally(out, &recording.tally)?;
        }
        write_speed(out, recording)
    }
}

fn write_milestones(out: &mut fmt::Formatter<'_>, milestones: Milestones) -> fmt::Result {
    write_line(out, "skids", describe_skidding(milestones.skidding))?;
    let halfway_down = describe_time(milestones.halfway_down);
    write_line(out, "passes 45 degrees", halfway_down)?;
    write_line(out, "settles", describe_time(milestones.settled))
}

/// Describes the skid: `until 1.32 s`, `not at the start`.
pub(crate) fn describe_skidding(skidding: Skidding) -> String {
    match skidding {
        Skidding::Never => "not at the start".to_owned(),
        Skidding::Until(time) => format!("until {time:.2} s"),
        Skidding::Always => "to the end of the run".to_owned(),
    }
}

/// Describes a time: `at 0.49 s`, `not within the run`.
pub(crate) fn describe_time(time: Option<f64>) -> String {
    match time {
        Some(time) => format!("at {time:.2} s"),
        None => "not within the run".to_owned(),
    }
}

fn write_energy(out: &mut fmt::Formatter<'_>, label: &str, energy: Energy) -> fmt::Result {
    let kinds = format!(
        "{:.4} J = translation {:.4} + rotation {:.4} + gravity {:.4} + springs {:.4}",
        energy.total(),
        energy.translation,
        energy.rotation,
        energy.gravity,
        energy.springs
    );
    write_line(out, label, kinds)
}

fn write_audit(out: &mut fmt::Formatter<'_>, audit: Audit) -> fmt::Result {
    let joules = |energy: f64| format!("{energy:11.4} J");
    let change = audit.work.total() + audit.energy_error;
    write_line(out, "change of energy", joules(change))?;
    write_line(out, "  by friction", joules(audit.work.friction))?;
    write_line(out, "  by the dampers", joules(audit.work.damper))?;
    write_line(out, "  by the clamp at 0 N", joules(audit.work.clamp))?;
    let error = format!("{}, of the method", joules(audit.energy_error));
    write_line(out, "  energy error", error)
}

/// Writes the sums over the steps of an implicit method.
fn write_tally(out: &mut fmt::Formatter<'_>, tally: &Tally) -> fmt::Result {
    let each = tally.iterations as f64 / tally.steps as f64;
    let text = format!(
        "{each:.2} a step; {} of {} steps took a fallback, {:.1e} J removed",
        tally.fallbacks, tally.steps, tally.energy_removed
    );
    write_line(out, "iterations", text)
}

fn write_speed(out: &mut fmt::Formatter<'_>, recording: &Recording) -> fmt::Result {
    let simulated = recording.last().time;
    let wall = recording.wall_time;
    let speed = simulated / wall;
    let audit = recording.audit.map_or("", |_| ", audit included");
    let text = format!("{wall:.3} s{audit}: {speed:.0} simulated seconds per second");
    write_line(out, "computed in", text)
}

fn write_line(out: &mut fmt::Formatter<'_>, label: &str, text: impl fmt::Display) -> fmt::Result {
    writeln!(out, "  {label:<20} {text}")
}
