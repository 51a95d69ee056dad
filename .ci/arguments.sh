#!/bin/bash
# Calls each example with wrong arguments, a folder that cannot be made, and broken files: each has to say what is wrong.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
cargo build -q --release --examples
python3 .ci/arguments.py "${CARGO_TARGET_DIR:-$PWD/target}/release/examples"
