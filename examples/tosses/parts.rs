//! One file for each part of the tosses.

use std::error::Error;
use std::fs::{self, File};
use std::io::{ErrorKind, Write as _};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use indicatif::{ProgressBar, ProgressStyle};
use tumble::CoinFace;
use tumble::ensemble::{Ensemble, Stop, Tally};

use crate::Arguments;
use crate::scene;
use common::{Outcome, cannot, make_folder, say};

/// Plays the tosses that no file has, and merges all of them.
pub(crate) fn play(arguments: &Arguments) -> Outcome<()> {
    let table = scene::table(scene::TOLERANCE)?;
    let throw = scene::throw(&table)?;
    let ensemble = scene::ensemble(&throw, arguments.seed);
    make_folder(&arguments.out)?;
    let missing = missing(arguments, &ensemble)?;
    let left: u64 = missing.iter().map(|gap| gap.end - gap.start).sum();
    let all = arguments.tosses.end - arguments.tosses.start;
    let bar = bar(all)?;
    let mut done = all - left;
    for tosses in missing.iter().flat_map(|gap| parts(gap, arguments.part)) {
        let tally = ensemble.run_until(
            tosses.clone(),
            &Stop::at_end(),
            |progress| bar.set_position(done + progress.done),
            |toss| throw.play(toss),
        )?;
        let file = arguments.out.join(name(&tosses));
        write(&file, &serde_json::to_string(&tally)?)?;
        done += tosses.end - tosses.start;
    }
    bar.finish_and_clear();
    merge(arguments)
}

/// Returns the tosses that are in no file that can be read. A result of another ensemble is not
/// replaced.
fn missing(arguments: &Arguments, ensemble: &Ensemble) -> Outcome<Vec<Range<u64>>> {
    let Some(there) = merged(&readable(&arguments.out)?)? else {
        return Ok(vec![arguments.tosses.clone()]);
    };
    if there.seed() != ensemble.seed() || there.scene() != ensemble.scene() {
        let shown = arguments.out.display();
        return Err(format!("{shown} has another seed or scene: choose another folder").into());
    }
    Ok(there.gaps(arguments.tosses.clone()))
}

/// Files of the parts that can be read, in order. Any other file is renamed: its tosses are played
/// again, and parts of another length do not replace it.
fn readable(folder: &Path) -> Outcome<Vec<PathBuf>> {
    let mut readable = Vec::new();
    for file in files(folder)? {
        match read(&file) {
            Ok(_) => readable.push(file),
            Err(error) => set_aside(&file, &*error)?,
        }
    }
    Ok(readable)
}

/// Renames a file that cannot be read to its name with `.broken`.
fn set_aside(file: &Path, error: &dyn Error) -> Outcome<()> {
    let mut aside = file.as_os_str().to_owned();
    aside.push(".broken");
    let aside = Path::new(&aside);
    let shown = file.display();
    match fs::rename(file, aside) {
        Ok(()) => say(format_args!(
            "cannot read {shown}: {error}; renamed to {}\n",
            aside.display()
        )),
        // Another process has renamed it.
        Err(renamed) if renamed.kind() == ErrorKind::NotFound => {}
        Err(renamed) => return Err(cannot("rename", file)(renamed).into()),
    }
    Ok(())
}

/// Files of the parts in a folder, in order.
fn files(folder: &Path) -> Outcome<Vec<PathBuf>> {
    let mut files = Vec::new();
    let entries = fs::read_dir(folder).map_err(cannot("read", folder))?;
    for entry in entries {
        let path = entry?.path();
        if path.to_string_lossy().ends_with(".part.json") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// Merges the parts of these files.
fn merged(files: &[PathBuf]) -> Outcome<Option<Tally<CoinFace>>> {
    let mut merged: Option<Tally<CoinFace>> = None;
    for file in files {
        let part = read(file).map_err(cannot("read", file))?;
        match &mut merged {
            None => merged = Some(part),
            Some(merged) => merged.merge(&part).map_err(cannot("merge", file))?,
        }
    }
    Ok(merged)
}

/// Merges all parts of the folder, lists the gaps, and writes the result.
pub(crate) fn merge(arguments: &Arguments) -> Outcome<()> {
    let shown = arguments.out.display();
    let merged = merged(&files(&arguments.out)?)?;
    let merged = merged.ok_or_else(|| format!("no part in {shown}"))?;
    let result = arguments.out.join("result.json");
    write(&result, &serde_json::to_string(&merged)?)?;
    say(format_args!("{merged}\n"));
    for gap in merged.gaps(arguments.tosses.clone()) {
        say(format_args!(
            "missing: --from {} --to {}\n",
            gap.start, gap.end
        ));
    }
    say(format_args!("Written: {}\n", result.display()));
    Ok(())
}

/// Parts of a range, which end at multiples of their length.
fn parts(range: &Range<u64>, part: u64) -> impl Iterator<Item = Range<u64>> + use<> {
    let Range { start, end } = *range;
    let mut next = start;
    std::iter::from_fn(move || {
        let first = next;
        next = (first / part + 1).saturating_mul(part).min(end);
        (first < end).then_some(first..next)
    })
}

fn name(tosses: &Range<u64>) -> String {
    format!("{:012}-{:012}.part.json", tosses.start, tosses.end)
}

fn read(file: &Path) -> Outcome<Tally<CoinFace>> {
    Ok(serde_json::from_str(&fs::read_to_string(file)?)?)
}

/// Writes a file under a name of its own, and renames it when it is complete. So the file is there
/// as a whole or not at all, even if several machines write it.
fn write(file: &Path, text: &str) -> Outcome<()> {
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH)?;
    let own = format!("{}-{}.tmp", std::process::id(), now.as_nanos());
    let temporary: PathBuf = file.with_extension(own);
    let written = File::create_new(&temporary).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        file.sync_all()
    });
    let renamed = written.and_then(|()| fs::rename(&temporary, file));
    if let Err(error) = &renamed
        && error.kind() != ErrorKind::AlreadyExists
    {
        let _ = fs::remove_file(&temporary);
    }
    Ok(renamed.map_err(cannot("write", file))?)
}

/// Shows itself only on a terminal.
fn bar(tosses: u64) -> Outcome<ProgressBar> {
    let style =
        ProgressStyle::with_template("tosses {wide_bar} {percent} %, {per_sec}, {eta} left")?;
    Ok(ProgressBar::new(tosses).with_style(style))
}
