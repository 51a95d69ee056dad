//! Checks that imports point in one direction: a file of `src` uses only the layers below its own,
//! so that each can be read without those above it.

#![allow(
    clippy::expect_used,
    reason = "a source file that cannot be read ends the test"
)]

use std::fs;
use std::path::{Path, PathBuf};

/// Page that lists the layers, the lowest first. Modules of one layer do not import from each
/// other.
const PAGE: &str = include_str!("../ARCHITECTURE.md");

/// Modules that re-export the items of all layers. No layer imports from them.
const GATHERERS: &[&str] = &["lib", "aliases", "f32", "f64"];

#[test]
fn every_import_points_down() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut imports_seen = 0;
    let mut faults = Vec::new();
    for file in rust_files(&src) {
        let path = file
            .strip_prefix(&src)
            .expect("the file was found below src");
        let place = Place::of(path);
        if GATHERERS.contains(&place.module.as_str()) {
            continue;
        }
        let source = fs::read_to_string(&file).expect("a source file is readable text");
        imports_seen += imports(&code(&source)).len();
        for fault in place.faults(&source) {
            faults.push(format!("src/{}:{fault}", path.display()));
        }
    }
    assert!(imports_seen > 0, "no import found in {}", src.display());
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

/// Module path of a source file.
struct Place {
    /// First part of its module path: `body` for both `src/body.rs` and `src/body/coin.rs`.
    module: String,
    /// Returns true if `super`, outside of all blocks, is the crate's root.
    at_top: bool,
}

impl Place {
    /// Module path of a path below `src`.
    fn of(path: &Path) -> Self {
        let parts: Vec<_> = path
            .with_extension("")
            .iter()
            .map(|part| part.to_string_lossy().into_owned())
            .collect();
        let at_top = parts.len() == 1 || parts[1..] == ["mod"];
        Self {
            module: parts[0].clone(),
            at_top,
        }
    }

    /// The imports of `source` that are wrong here, each as `line: reason`.
    fn faults(&self, source: &str) -> Vec<String> {
        let code = code(source);
        let Some(own) = layer(&self.module) else {
            return vec![format!(
                "1: `{}` is in no layer of ARCHITECTURE.md",
                self.module
            )];
        };
        let mut faults = Vec::new();
        for (line, imported) in imports(&code) {
            let reason = match layer(&imported) {
                _ if imported == self.module => continue,
                Some(other) if other < own => continue,
                Some(other) if other == own => "its neighbour",
                Some(_) => "which lies above it",
                None if GATHERERS.contains(&imported.as_str()) => {
                    "which gathers what lies above it"
                }
                None => "which is no module: import a name from where it is defined",
            };
            faults.push(format!(
                "{line}: `{}` imports `{imported}`, {reason}",
                self.module
            ));
        }
        for (number, line) in code.lines().enumerate() {
            if line.contains("super::super") || self.at_top && line.starts_with("use super::") {
                faults.push(format!(
                    "{}: say `crate::`, so that the direction is seen",
                    number + 1
                ));
            }
        }
        faults
    }
}

/// Height of a module's layer.
fn layer(module: &str) -> Option<usize> {
    layers().position(|modules| modules.split(", ").any(|name| name == module))
}

/// The lines between the marks of the page.
fn layers() -> impl Iterator<Item = &'static str> {
    let (_, list) = PAGE
        .split_once("<!-- layers: begin -->")
        .expect("the page has a list of layers");
    let (list, _) = list
        .split_once("<!-- layers: end -->")
        .expect("the list of layers has an end");
    list.lines()
        .map(str::trim)
        .filter(|line| !line.is_empty() && !line.starts_with("```"))
}

/// The source up to its tests, without comments. Each line keeps its number. (Tests of a lower
/// layer may use all layers above it.)
fn code(source: &str) -> String {
    let library = source
        .split("\n#[cfg(test)]\nmod ")
        .next()
        .unwrap_or_default();
    let lines: Vec<_> = library
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default())
        .collect();
    lines.join("\n")
}

/// The first name after each `crate::`, with its line; several for `crate::{…}`.
fn imports(code: &str) -> Vec<(usize, String)> {
    let after_crate = code
        .match_indices("crate::")
        .map(|(at, path)| at + path.len());
    let starts = after_crate.flat_map(|at| {
        if code[at..].starts_with('{') {
            items_of_group(code, at)
        } else {
            vec![at]
        }
    });
    starts
        .map(|at| {
            (
                code[..at].matches('\n').count() + 1,
                first_name(&code[at..]).to_owned(),
            )
        })
        .collect()
}

/// Start of each item of the group that opens at `open`, without the items of inner groups.
fn items_of_group(code: &str, open: usize) -> Vec<usize> {
    let (mut depth, mut starts) = (0, Vec::new());
    let mut expecting = false;
    for (at, character) in code[open..].char_indices() {
        match character {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            break;
        }
        if depth == 1 && matches!(character, '{' | ',') {
            expecting = true;
        } else if expecting && !character.is_whitespace() && character != '}' {
            starts.push(open + at);
            expecting = false;
        }
    }
    starts
}

/// The identifier that `code` begins with.
fn first_name(code: &str) -> &str {
    let end = code.find(|character: char| !character.is_alphanumeric() && character != '_');
    &code[..end.unwrap_or(code.len())]
}

/// All files `*.rs` below a folder, in order.
fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("the folder is readable");
    let mut paths: Vec<_> = entries
        .map(|entry| entry.expect("the entry is readable").path())
        .collect();
    paths.sort();
    let (folders, files): (Vec<_>, Vec<_>) = paths.into_iter().partition(|path| path.is_dir());
    let own = files
        .into_iter()
        .filter(|path| path.extension().is_some_and(|extension| extension == "rs"));
    own.chain(folders.iter().flat_map(|folder| rust_files(folder)))
        .collect()
}

/// The checker checked: what it must find and what it must let pass.
mod checker {
    use super::Place;
    use std::path::Path;

    fn faults(path: &str, source: &str) -> Vec<String> {
        Place::of(Path::new(path)).faults(source)
    }

    #[test]
    fn an_import_from_above_is_found() {
        let source = "//! A ball.\n\nuse crate::real::Real;\nuse crate::stepper::Stepper;\n";
        assert_eq!(
            faults("body/ball.rs", source),
            ["4: `body` imports `stepper`, which lies above it"]
        );
    }

    #[test]
    fn an_import_from_a_neighbour_is_found() {
        assert_eq!(
            faults("friction.rs", "use crate::ground::FlatGround;"),
            ["1: `friction` imports `ground`, its neighbour"]
        );
    }

    #[test]
    fn a_wrong_import_is_found_in_a_group_and_in_the_middle_of_a_line() {
        let group =
            "use crate::{\n    real::{Real, Vector},\n    scene::Scene,\n    state::State,\n};\n";
        assert_eq!(
            faults("ground/flat.rs", group),
            ["3: `ground` imports `scene`, which lies above it"]
        );
        let path = "fn step(stepper: &crate::stepper::Stepper) {}";
        assert_eq!(
            faults("integrator/rk4.rs", path),
            ["1: `integrator` imports `stepper`, which lies above it"]
        );
    }

    #[test]
    fn a_way_round_the_check_is_found() {
        assert_eq!(faults("state.rs", "use crate::Stepper;").len(), 1);
        assert_eq!(faults("state.rs", "use crate::f64::Stepper;").len(), 1);
        assert_eq!(faults("state.rs", "use super::stepper::Stepper;").len(), 1);
        assert_eq!(
            faults("body/ball.rs", "use super::super::stepper::Stepper;").len(),
            1
        );
        assert_eq!(faults("novelty.rs", "").len(), 1);
    }

    #[test]
    fn imports_from_below_from_itself_in_comments_and_in_tests_pass() {
        let source = "\
            /// Used by [`crate::stepper::Stepper`].\n\
            use super::RigidPointBody;\n\
            use crate::body::ContactPoint;\n\
            use crate::{error::SceneError, real::Real};\n\
            pub(crate) fn mass() {}\n\
            #[cfg(test)]\n\
            mod tests {\n    use crate::stepper::Stepper;\n}\n";
        assert_eq!(faults("body/ball.rs", source), [""; 0]);
    }
}
