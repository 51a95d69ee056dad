#!/bin/bash
# Builds the live page of examples/web, and tries it in Chromium from disk and from a server: no error, the stored bits, throws by mouse and touch, each
# parameter, each integrator, the energy of 10,000 steps, a replay from the address bar, a narrow and a dark screen, a slow processor. Pictures go to
# $CARGO_TARGET_DIR/web.
#   .ci/web.sh            checks the page
#   .ci/web.sh --write    stores the picture of the README, too
# Installs Chromium, Node and npm by Debian's packages, and the program that drives Chromium. Where they cannot be had, it says so and checks nothing.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
. .ci/cross.sh
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}/web"
work="$CARGO_TARGET_DIR"
mkdir -p "$work"

lints() {
  local manifest
  for manifest in examples/web/Cargo.toml examples/web/build/Cargo.toml; do
    cargo fmt --manifest-path "$manifest" --check
    cargo clippy -q --locked --manifest-path "$manifest" --all-targets -- -D warnings
  done
}
# With rustup's target where it can be had; else as .ci/targets.sh builds for other processors.
page() {
  if rustup target add wasm32-unknown-unknown >"$work/rustup.log" 2>&1; then
    cargo run -q --locked --manifest-path examples/web/build/Cargo.toml -- --out "$work/tumble.html"
  else
    cross_install "$work"
    RUSTC=$(cross_compiler) RUSTC_BOOTSTRAP=1 CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER=$(cross_linker) \
      cargo build -q --locked --manifest-path examples/web/Cargo.toml --lib --release -Zbuild-std=core --target wasm32-unknown-unknown
    cargo run -q --locked --manifest-path examples/web/build/Cargo.toml -- --out "$work/tumble.html" \
      --wasm "$work/wasm32-unknown-unknown/release/tumble_page.wasm"
  fi
}
tests() {
  lints
  cargo test -q --locked --manifest-path examples/web/Cargo.toml
}

# Page and tests are built side by side, in folders of their own.
(set -e; page) & building=$!
(set -e; CARGO_TARGET_DIR="$work/tests" tests) & testing=$!
wait "$building"
wait "$testing"
echo "page and tests: $SECONDS s"
. .ci/browser.sh
echo "browser: $SECONDS s"
cp tests/web/page.mjs "$work/page.mjs" # where Node finds the driver
PAGE="$work/tumble.html" HASHES=tests/bits/hashes.txt PICTURES="$work" timeout 170 node "$work/page.mjs"
if [ "${1:-}" = --write ]; then cp "$work/readme.png" assets/live.png; fi
