#!/bin/bash
# Writes the figures that depend on arithmetic only, and fails where a page has another figure than its program prints now.
# Figures that depend on the speed of a machine are not compared. The table of the literature is compared by its own test, that of the firmware by .ci/embedded.sh, that of the gallery by .ci/gallery.sh.
# The tables of known_outcomes take half an hour. The stored ones of a thousandth of the tosses, without the costs, are compared in their place.
#   bash .ci/figures.sh          the tables of single precision and of the round rim, and those of known_outcomes with few tosses, half a minute
#   bash .ci/figures.sh --all    the answer of heads_or_tails too, some minutes
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
pages=(README.md src/guide src/body/disc.rs)

# Text between marks names the command that writes it. The layers of ARCHITECTURE.md are no figures.
unnamed=$(git grep -nE '<!-- [a-z0-9 ]+: begin' -- '*.md' 'src/*.rs' | grep -v 'layers: begin' | grep -v 'written by `' || true)
[ -z "$unnamed" ] || { echo "figures: no command is named in $unnamed"; exit 1; }
before=$(mktemp -d)
trap 'rm -rf "$before"' EXIT
cp -r "${pages[@]}" "$before"

cargo run -q --release --example accuracy -- --f32 --write
cargo run -q --release --example accuracy -- --f32-motion --write
cargo run -q --release --example round_rim -- --write --out "$before/out" >/dev/null
if [ "${1-}" = --all ]; then
  cargo run -q --release --example heads_or_tails -- --write --out "$before/out"
fi
cargo run -q --release --example known_outcomes -- --check --out "$before/out" >"$before/known" || {
  grep -A1 '^stored: ' "$before/known" || true # none if it has failed earlier
  echo 'figures: known_outcomes prints other tables now. Run it with --write, and then with --quick --write'
  exit 1
}
for page in "${pages[@]}"; do
  diff -r "$before/$(basename "$page")" "$page" || { echo "figures: $page is stale (< stored, > now); the new figures are written"; exit 1; }
done
echo 'figures: as the programs print them'
