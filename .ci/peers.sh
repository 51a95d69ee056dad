#!/bin/bash
# The comparison with peers builds, its answers hold, and a scene of it runs. Not part of .ci/run, as rapier compiles for minutes: a step before a release.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../benches/peers"
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/../../target}/peers"
cargo fmt --check
cargo clippy -q --release --all-targets -- -D warnings
cargo test -q --release
cargo run -q --release -- --turns 1 --scene 'middle axis'
