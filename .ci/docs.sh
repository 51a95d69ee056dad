#!/bin/bash
# The documentation builds without a warning: no broken link, no undocumented item.
set -euo pipefail
export RUSTDOCFLAGS="-D warnings"
cargo doc -q -p tumble --no-deps --all-features
