#!/bin/bash
# Lints of the workspace, of all targets with all features, and of the crates beside it that compile for this machine.
# Those of examples/web are in .ci/web.sh and those of benches/peers in .ci/peers.sh.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
cargo clippy -q --workspace --all-targets --all-features -- -D warnings
for beside in examples/embedded tests/bits tests/no_std; do
  cargo clippy -q --locked --manifest-path "$beside/Cargo.toml" --lib --bins -- -D warnings
done
