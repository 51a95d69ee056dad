#!/bin/bash
# Every crate of the repository is formatted, those beside the workspace too.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
git ls-files '*Cargo.toml' | while read -r manifest; do
  cargo fmt --manifest-path "$manifest" --check || { echo "please run: cargo fmt --manifest-path $manifest"; exit 1; }
done
