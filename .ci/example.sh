#!/bin/bash
# Runs the example for two seconds of its time and reads the files that it leaves.
set -euo pipefail
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
cargo run -q --release --example coin -- --duration 2 --out "$out"
python3 .ci/read_pictures.py "$out"
