//! Messages of the compiler for an incomplete part: they name the role and what is missing.
//!
//! Each program of `tests/half_done` does not compile. The quoted lines at its top must appear in
//! the message. The compiler's version adds more lines, which may change.

use std::path::{MAIN_SEPARATOR, Path, PathBuf};
use std::process::Command;
use std::{env, fs};

fn programs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../half_done")
}

/// Messages of the compiler for all programs, each error separately.
fn errors() -> String {
    let output = Command::new(env!("CARGO"))
        .args([
            "check",
            "--keep-going",
            "--offline",
            "--locked",
            "--manifest-path",
        ])
        .arg(programs().join("Cargo.toml"))
        .env(
            "CARGO_TARGET_DIR",
            Path::new(env!("CARGO_TARGET_TMPDIR")).join("half_done"),
        )
        .env("CARGO_TERM_COLOR", "never")
        .output()
        .unwrap();
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_half_done_part_is_told_what_is_missing() {
    let said = errors();
    for program in fs::read_dir(programs().join("src/bin")).unwrap() {
        let path = program.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        // An error ends with an empty line, and names its file.
        let of_program: String = (said.split("\n\n"))
            .filter(|error| error.contains(&format!("bin{MAIN_SEPARATOR}{name}.rs:")))
            .collect();
        let source = fs::read_to_string(&path).unwrap();
        let wanted: Vec<&str> = (source.lines())
            .filter_map(|line| line.strip_prefix("//! > "))
            .collect();
        assert!(!wanted.is_empty(), "{name} expects nothing");
        for line in wanted {
            assert!(
                of_program.contains(line),
                "of {name} the compiler does not say\n{line}\nbut\n{of_program}\nand in all\n{said}"
            );
        }
    }
}
