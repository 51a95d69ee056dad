#!/bin/bash
# What would be published has what a user needs and nothing else, and builds by itself, also with the lowest versions of its dependencies.
set -euo pipefail
files=$(cargo package --list -p tumble --allow-dirty)
for wanted in Cargo.toml README.md assets/registry.md CHANGELOG.md LICENSE src/lib.rs; do
  grep -qx "$wanted" <<<"$files" || { echo "the package lacks $wanted"; exit 1; }
done
# A registry shows the README without what only a clone has.
.ci/registry_page.py
version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -1)
grep -qE "^## \[${version//./\\.}\] - 20[0-9]{2}-[0-9]{2}-[0-9]{2}$" CHANGELOG.md || { echo "CHANGELOG.md has no dated section of $version"; exit 1; }
allowed='\.cargo_vcs_info\.json|Cargo\.(lock|toml|toml\.orig)|README\.md|ARCHITECTURE\.md|CONTRIBUTING\.md|CHANGELOG\.md|LICENSE|(src|assets)/.+'
if grep -vxE "$allowed" <<<"$files"; then
  echo "the files above have no place in the package"
  exit 1
fi
# The first removes the archive that the second keeps. What the registry would get is built below, by a user's first program.
cargo publish -q --dry-run --no-verify --locked -p tumble --allow-dirty
cargo package -q --no-verify -p tumble --allow-dirty
archive="${CARGO_TARGET_DIR:-$PWD/target}/package/tumble-$version.crate"
echo "$(wc -l <<<"$files") files, $(stat -c %s "$archive") bytes"
[ "$(stat -c %s "$archive")" -lt 1000000 ] || { echo "the package is above 1 MB"; exit 1; }

# A user's first program, with the package in place of the repository.
rm -rf "${archive%.crate}" && tar -x -C "$(dirname "$archive")" -f "$archive"
program="${CARGO_TARGET_DIR:-$PWD/target}/package/template"
rm -rf "$program" && cp -r examples/template "$program"
sed -i "s#path = \"../..\"#path = \"${archive%.crate}\"#" "$program/Cargo.toml"
cargo fmt --check --manifest-path examples/template/Cargo.toml
# The tests of the library compile, and so do the programs of the documentation, without the features that a published package cannot ask of itself.
cargo check -q --tests --manifest-path "${archive%.crate}/Cargo.toml"
cargo test -q --doc --manifest-path "${archive%.crate}/Cargo.toml"
cargo run -q --manifest-path "$program/Cargo.toml" | grep -E '^(Heads|Tails) up$' || { echo "the template does not throw a coin"; exit 1; }

# What comes along: each crate once, and all of it may be used under one of the library's own licences.
# Crates that only a procedural macro needs, such as unicode-ident with its tables of Unicode, run in the compiler and are no part of a user's program.
along() { cargo tree -q --locked -p tumble --all-features --target all --prefix none -e normal,no-proc-macro "$@"; }
licences=$(along --format '{l}: {p}' | sort -u)
# Each term of an AND must hold, and one choice of an OR.
others=$(awk -F ': ' '
  { terms = split($1, term, / AND /)
    if (!terms) print # no licence is stated
    for (i = 1; i <= terms; i++) {
      gsub(/[()]/, "", term[i])
      is_allowed = 0
      choices = split(term[i], choice, / OR |\//)
      for (k = 1; k <= choices; k++) if (choice[k] == "MIT" || choice[k] == "Apache-2.0") is_allowed = 1
      if (!is_allowed) { print; next }
    } }' <<<"$licences")
[ -z "$others" ] || { printf '%s\n' "$others" 'the crates above have other licences'; exit 1; }
[ "$(wc -l <<<"$licences")" -gt 10 ] || { echo "only these crates come along: $licences"; exit 1; }
twice=$(along --duplicates --depth 0)
[ -z "$twice" ] || { echo "more than one version of: $twice"; exit 1; }

# Stable compilers resolve the lowest versions only when told that they are none. Tests and benches have dependencies of their own, which a user does not get.
lowest=$(mktemp -d)
trap 'rm -rf "$lowest"' EXIT
tar -x -C "$lowest" --strip-components 1 -f "$archive"
cargo hack --remove-dev-deps --manifest-path "$lowest/Cargo.toml"
rm -f "$lowest/Cargo.lock"
RUSTC_BOOTSTRAP=1 cargo update -q -Zdirect-minimal-versions --manifest-path "$lowest/Cargo.toml"
cargo check -q --locked --lib --all-features --manifest-path "$lowest/Cargo.toml"
echo "builds with: $(cargo tree -q --manifest-path "$lowest/Cargo.toml" --all-features -e normal --depth 1 --prefix none | sed '1d; s/ (.*//' | paste -sd, | sed 's/,/, /g')"
