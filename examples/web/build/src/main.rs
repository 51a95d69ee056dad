//! Builds the live page: the library in WebAssembly, the style and the scripts in one HTML file.
//!
//! The library and the scripts are compressed. A short script in plain text, `unpack.js`, starts
//! them.

use std::env;
use std::error::Error;
use std::fs;
use std::num::NonZeroU64;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use lexopt::prelude::*;
use zopfli::Format;

const HELP: &str = "\
Builds the live page and writes it as one HTML file, which needs no network and no server.

Usage: cargo run --manifest-path examples/web/build/Cargo.toml -- [OPTIONS]

Options:
  --out FILE    page to write [default: out/tumble.html]
  --wasm FILE   the library, if it is already built; otherwise cargo builds it, which needs
                `rustup target add wasm32-unknown-unknown`
  --help        this text";

/// Scripts in the order in which they are joined. Each uses names of those before it, and of
/// `unpack.js`.
const SCRIPTS: [&str; 9] = [
    "module.js",
    "address.js",
    "mesh.js",
    "view.js",
    "hand.js",
    "energy.js",
    "panel.js",
    "tosses.js",
    "main.js",
];

/// Largest page, bytes.
const MOST: usize = 300_000;
/// Iterations of the compressor. Its own default of 15 leaves a thousandth more.
const ITERATIONS: NonZeroU64 = NonZeroU64::new(60).unwrap();

type Outcome<T> = Result<T, Box<dyn Error>>;

struct Options {
    out: PathBuf,
    wasm: Option<PathBuf>,
}

fn main() -> ExitCode {
    match options().and_then(|options| options.map_or(Ok(()), |options| work(&options))) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Reads the arguments. Returns `None` after the help text.
fn options() -> Outcome<Option<Options>> {
    let mut options = Options {
        out: "out/tumble.html".into(),
        wasm: None,
    };
    let mut arguments = lexopt::Parser::from_env();
    while let Some(argument) = arguments.next()? {
        match argument {
            Long("out") => options.out = arguments.value()?.into(),
            Long("wasm") => options.wasm = Some(arguments.value()?.into()),
            Long("help") => {
                println!("{HELP}");
                return Ok(None);
            }
            _ => return Err(argument.unexpected().into()),
        }
    }
    Ok(Some(options))
}

fn work(options: &Options) -> Outcome<()> {
    let wasm = match &options.wasm {
        Some(file) => file.clone(),
        None => built()?,
    };
    let page = joined(&fs::read(&wasm).map_err(|error| format!("{}: {error}", wasm.display()))?)?;
    if page.len() > MOST {
        return Err(format!(
            "the page must have at most {MOST} bytes, got {}",
            page.len()
        )
        .into());
    }
    if let Some(folder) = options.out.parent() {
        fs::create_dir_all(folder)?;
    }
    fs::write(&options.out, &page)?;
    println!("{}: {} bytes", options.out.display(), page.len());
    Ok(())
}

/// Folder of the page's crate.
fn crate_folder() -> Outcome<&'static Path> {
    Ok(Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .ok_or("no folder of the page")?)
}

/// Builds the library for WebAssembly in the target folder of this program.
fn built() -> Outcome<PathBuf> {
    let program = env::current_exe()?;
    let target = program.ancestors().nth(2).ok_or("no target folder")?;
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo)
        .args([
            "build",
            "--release",
            "--lib",
            "--locked",
            "--target",
            "wasm32-unknown-unknown",
        ])
        .arg("--manifest-path")
        .arg(crate_folder()?.join("Cargo.toml"))
        .arg("--target-dir")
        .arg(target)
        .status()?;
    if !status.success() {
        return Err("the library is not built; \
                    `rustup target add wasm32-unknown-unknown` installs the target"
            .into());
    }
    Ok(target.join("wasm32-unknown-unknown/release/tumble_page.wasm"))
}

/// Joins the page.
fn joined(wasm: &[u8]) -> Outcome<String> {
    let folder = crate_folder()?;
    let read = |path: PathBuf| {
        fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))
    };
    let source = |name: &str| read(folder.join("page").join(name));
    let mut script = String::new();
    for name in SCRIPTS {
        script += &dense(&source(name)?);
    }
    let hashes = folder.join("../../tests/bits/hashes.txt");
    let (module, scripts) = (compressed(wasm)?, compressed(script.as_bytes())?);
    let parts = [
        ("/* style.css */", sheet(&source("style.css")?)),
        ("/* worker.js */", dense(&source("worker.js")?)),
        ("/* unpack.js */", dense(&source("unpack.js")?)),
        ("<!-- stored -->", stored_hash(&read(hashes)?)?),
        ("<!-- length of module -->", module.len().to_string()),
        ("<!-- module -->", packed(module)),
        ("<!-- length of scripts -->", scripts.len().to_string()),
        ("<!-- scripts -->", packed(scripts)),
    ];
    let mut page = dense(&source("index.html")?);
    for (marker, text) in parts {
        if page.matches(marker).count() != 1 {
            return Err(format!("index.html must have one {marker}").into());
        }
        page = page.replace(marker, &text);
    }
    Ok(page)
}

/// Finds the hash of the page's own battery among the stored ones.
fn stored_hash(hashes: &str) -> Outcome<String> {
    let mut rows = hashes.lines();
    let hash = rows.find_map(|row| row.strip_prefix("f64 live page "));
    Ok(hash.ok_or("no row of the page among the hashes")?.into())
}

/// Leaves out indentation, empty lines and lines of comments, which a visitor does not read.
fn dense(source: &str) -> String {
    let lines = source.lines().map(str::trim_start);
    let kept = lines.filter(|line| !line.is_empty() && !line.starts_with("// "));
    kept.flat_map(|line| [line, "\n"]).collect()
}

/// Leaves out the ends of lines too, after which a style sheet needs none.
fn sheet(source: &str) -> String {
    let ends = ["{\n", "}\n", ";\n", ",\n"];
    (ends.iter()).fold(dense(source), |sheet, end| sheet.replace(end, &end[..1]))
}

fn compressed(bytes: &[u8]) -> Outcome<Vec<u8>> {
    let mut gzip = Vec::new();
    let options = zopfli::Options {
        iteration_count: ITERATIONS,
        ..zopfli::Options::default()
    };
    zopfli::compress(options, Format::Gzip, bytes, &mut gzip)?;
    Ok(gzip)
}

/// Writes nine bytes as eleven digits of base 94, of which `unpack.js` knows the characters. Zeros
/// fill up the last nine. It is shorter by a fiftieth than Z85, which writes four bytes as five.
fn packed(mut bytes: Vec<u8>) -> String {
    bytes.resize(bytes.len().next_multiple_of(9), 0);
    bytes.chunks(9).flat_map(digits).map(char::from).collect()
}

/// Digits of a group of nine bytes, the first byte first.
fn digits(group: &[u8]) -> [u8; 11] {
    let mut number = (group.iter()).fold(0_u128, |number, byte| (number << 8) | u128::from(*byte));
    let mut digits = [0; 11];
    for digit in digits.iter_mut().rev() {
        let place = (number % 94) as u8;
        number /= 94;
        // Without "<", which could begin a tag.
        *digit = b' ' + place + u8::from(place > b'<' - b' ' - 1);
    }
    digits
}
