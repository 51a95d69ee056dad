#!/bin/bash
# Counts the mutants of the library that its tests find; tests/mutants/README.md has the results.
#   bash .ci/mutants.sh --sample 200 --seed 1      a random sample of all folders of src
#   bash .ci/mutants.sh --only limiter             all mutants of what a promise rests on
#   bash .ci/mutants.sh --diff main                those of a change; fails if one survives
# It needs `cargo install --locked cargo-mutants`. A run that was stopped goes on where it was.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
cargo mutants --version >/dev/null || { echo 'please run: cargo install --locked --debug cargo-mutants'; exit 1; }
exec python3 .ci/mutants.py "$@"
