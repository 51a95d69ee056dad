#!/bin/bash
# What would be published has what a user needs and nothing else, and builds by itself.
set -euo pipefail
files=$(cargo package --list -p tumble --allow-dirty)
for wanted in Cargo.toml README.md CHANGELOG.md LICENSE src/lib.rs; do
  grep -qx "$wanted" <<<"$files" || { echo "the package lacks $wanted"; exit 1; }
done
allowed='\.cargo_vcs_info\.json|Cargo\.(lock|toml|toml\.orig)|README\.md|ARCHITECTURE\.md|CONTRIBUTING\.md|CHANGELOG\.md|LICENSE|(src|benches|tests|assets)/.+'
if grep -vxE "$allowed" <<<"$files"; then
  echo "the files above have no place in the package"
  exit 1
fi
if grep -E '^(tests/(downstream|no_std|bits|fuzz|half_done|web)/|tests/(bits|fuzz)\.rs$|tests/public_api\.txt$|out/)' <<<"$files"; then
  echo "the files above are for the repository alone"
  exit 1
fi
cargo package -q -p tumble --allow-dirty
archive="${CARGO_TARGET_DIR:-$PWD/target}/package/tumble-$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -1).crate"
echo "$(wc -l <<<"$files") files, $(stat -c %s "$archive") bytes"
[ "$(stat -c %s "$archive")" -lt 1000000 ] || { echo "the package is above 1 MB"; exit 1; }

# A user's first program, with the package in place of the repository.
program="${CARGO_TARGET_DIR:-$PWD/target}/package/template"
rm -rf "$program" && cp -r examples/template "$program"
sed -i "s#path = \"../..\"#path = \"${archive%.crate}\"#" "$program/Cargo.toml"
cargo fmt --check --manifest-path examples/template/Cargo.toml
cargo run -q --manifest-path "$program/Cargo.toml" | grep -E '^(Heads|Tails) up$' || { echo "the template does not throw a coin"; exit 1; }
