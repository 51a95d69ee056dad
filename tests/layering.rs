//! Checks that imports point in one direction: a file of `src` uses only the layers below its own,
//! so that each can be read without those above it. Inside a folder the imports form no circle, and
//! the stages of a step do not import from the module that calls them.

#![allow(
    clippy::expect_used,
    reason = "a source file that cannot be read ends the test"
)]
#![allow(
    clippy::std_instead_of_alloc,
    reason = "a test has the standard library"
)]

use std::collections::{BTreeMap, BTreeSet};
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

/// Modules whose parts are the stages of a step. A part imports from its siblings and never from
/// the module that it is a part of.
const OF_STAGES: &[&str] = &["contact", "integrator"];

#[test]
fn inside_a_folder_imports_form_no_circle() {
    let folders = folders();
    let mut faults = Vec::new();
    for (folder, imports) in &folders {
        if let Some(circle) = circle(imports) {
            faults.push(format!("src/{folder}: {}", circle.join(" -> ")));
        }
    }
    assert!(folders.len() > 10, "{}", folders.len());
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

#[test]
fn a_circle_is_found() {
    let edges = |list: &[(&str, &str)]| {
        let mut imports = BTreeMap::<String, BTreeSet<String>>::new();
        for (from, to) in list {
            let targets = imports.entry((*from).to_owned()).or_default();
            targets.insert((*to).to_owned());
        }
        imports
    };
    assert!(circle(&edges(&[("a", "b"), ("b", "c"), ("a", "c")])).is_none());
    let found = circle(&edges(&[("a", "b"), ("b", "c"), ("c", "b")]));
    assert_eq!(found.expect("b and c import each other").len(), 3);
}

#[test]
fn a_stage_does_not_import_from_the_module_that_calls_it() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut faults = Vec::new();
    let mut looked_at = 0;
    for (file, path, source) in sources(&src) {
        if path.len() < 2 || !OF_STAGES.contains(&path[0].as_str()) {
            continue;
        }
        let parent = &path[..path.len() - 1];
        looked_at += 1;
        for import in absolute_imports(&code(&source), &path) {
            let from_parent = import.len() == path.len() && import[..parent.len()] == *parent;
            let is_module = is_module(&src, &import);
            if from_parent && !is_module {
                faults.push(format!("{file}: `{}`", import.join("::")));
            }
        }
    }
    assert!(looked_at > 40, "{looked_at}");
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

/// For each folder of `src`: the siblings that each of its modules imports from.
fn folders() -> BTreeMap<String, BTreeMap<String, BTreeSet<String>>> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut folders = BTreeMap::<String, BTreeMap<String, BTreeSet<String>>>::new();
    for (_, path, source) in sources(&src) {
        for import in absolute_imports(&code(&source), &path) {
            // The deepest folder that contains both.
            let shared = (path.iter().zip(&import))
                .take_while(|(own, other)| own == other)
                .count();
            let (Some(own), Some(other)) = (path.get(shared), import.get(shared)) else {
                continue;
            };
            if shared > 0 && is_module(&src, &import[..=shared]) {
                let folder = folders.entry(path[..shared].join("/")).or_default();
                folder.entry(own.clone()).or_default().insert(other.clone());
            }
        }
    }
    folders
}

/// A circle of imports, if there is one: its modules in order, with the first one again at the end.
fn circle(imports: &BTreeMap<String, BTreeSet<String>>) -> Option<Vec<String>> {
    fn follow(
        at: &str,
        imports: &BTreeMap<String, BTreeSet<String>>,
        way: &mut Vec<String>,
        done: &mut BTreeSet<String>,
    ) -> Option<Vec<String>> {
        if let Some(start) = way.iter().position(|module| module == at) {
            let mut circle = way[start..].to_vec();
            circle.push(at.to_owned());
            return Some(circle);
        }
        if !done.insert(at.to_owned()) {
            return None;
        }
        way.push(at.to_owned());
        for next in imports.get(at).into_iter().flatten() {
            if let Some(circle) = follow(next, imports, way, done) {
                return Some(circle);
            }
        }
        way.pop();
        None
    }
    let mut done = BTreeSet::new();
    let mut starts = imports.keys();
    starts.find_map(|start| follow(start, imports, &mut Vec::new(), &mut done))
}

/// Name, module path and text of each source file.
fn sources(src: &Path) -> Vec<(String, Vec<String>, String)> {
    let files = rust_files(src).into_iter().map(|file| {
        let path = file
            .strip_prefix(src)
            .expect("the file was found below src");
        let parts = path.with_extension("");
        let parts = parts.iter().map(|part| part.to_string_lossy().into_owned());
        let source = fs::read_to_string(&file).expect("a source file is readable text");
        (format!("src/{}", path.display()), parts.collect(), source)
    });
    files.collect()
}

/// Returns true if a path from the crate's root is that of a source file.
fn is_module(src: &Path, path: &[String]) -> bool {
    let file: PathBuf = path.iter().collect();
    src.join(file).with_extension("rs").is_file()
}

/// The paths after each `crate::` and `super::` of a module, from the crate's root.
fn absolute_imports(code: &str, module: &[String]) -> Vec<Vec<String>> {
    let mut paths = Vec::new();
    for (start, base) in [
        ("crate::", &[][..]),
        ("super::", &module[..module.len() - 1]),
    ] {
        for (at, _) in code.match_indices(start) {
            // A module declared in a block has another parent.
            let is_of_file = code[..at].rsplit('\n').next().is_some_and(|line| {
                start == "crate::"
                    || line.ends_with("use ") && !line.starts_with(' ')
                    || is_path_in_body(code, at, line)
            });
            if is_of_file {
                paths.extend(paths_at(code, at + start.len(), base.to_vec()));
            }
        }
    }
    paths
}

/// Returns true if a `super::` is a path within a function of the file itself, and not of a module
/// in a block. Tests are the only such modules, and come last.
fn is_path_in_body(code: &str, at: usize, line: &str) -> bool {
    let begins_a_path =
        !line.ends_with("in ") && !line.ends_with("use ") && !line.ends_with("super::");
    begins_a_path && !code[..at].contains("\nmod tests {")
}

/// The paths that begin at a place of the source: one, or one for each item of a group.
fn paths_at(code: &str, at: usize, mut path: Vec<String>) -> Vec<Vec<String>> {
    if code[at..].starts_with('{') {
        let items = items_of_group(code, at).into_iter();
        return items
            .flat_map(|item| paths_at(code, item, path.clone()))
            .collect();
    }
    let name = first_name(&code[at..]);
    path.push(name.to_owned());
    let after = at + name.len();
    if code[after..].starts_with("::") && !name.is_empty() {
        return paths_at(code, after + 2, path);
    }
    vec![path]
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

/// All files `*.rs` below a folder, in order, without those of unit tests, which may use all
/// layers.
fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("the folder is readable");
    let mut paths: Vec<_> = entries
        .map(|entry| entry.expect("the entry is readable").path())
        .collect();
    paths.sort();
    let (folders, files): (Vec<_>, Vec<_>) = paths.into_iter().partition(|path| path.is_dir());
    let own = files
        .into_iter()
        .filter(|path| path.extension().is_some_and(|extension| extension == "rs"))
        .filter(|path| !path.ends_with("tests.rs"));
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
