#!/bin/bash
# Compares the public face of the library with tests/public_api.txt, so that no change of it goes unseen: a removed or changed line breaks users.
#   .ci/public_api.sh             compares
#   .ci/public_api.sh --update    stores what is there, to be read in the commit's diff
# The compiler describes the face as JSON, which stable compilers do only when told that they are none; cargo-public-api writes it as lines. Implementations of
# derived, automatic and blanket traits are left out, and a line that a second path shows again.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
stored=tests/public_api.txt
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}/public_api"
mkdir -p "$CARGO_TARGET_DIR"

RUSTC_BOOTSTRAP=1 cargo rustdoc -q -p tumble --lib --all-features -- -Zunstable-options --output-format json
now="$CARGO_TARGET_DIR/now.txt"
cargo public-api --rustdoc-json "$CARGO_TARGET_DIR/doc/tumble.json" -sss | awk '!seen[$0]++' >"$now"
[ "$(wc -l <"$now")" -gt 100 ] || { echo "only $(wc -l <"$now") public items"; exit 1; }

if [ "${1-}" = --update ]; then
  cp "$now" "$stored"
elif ! diff "$stored" "$now"; then
  echo "the public face has changed (< stored, > now); if that is meant:  .ci/public_api.sh --update"
  exit 1
fi
echo "$(wc -l <"$now") public items"
