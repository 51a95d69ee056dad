#!/bin/bash
# Builds the gallery of all examples, and looks at each of its pages in Chromium, on a desktop and on a phone, light and dark: no error, no texts that overlap,
# are cut or too small, no legend over a curve, no empty canvas or drawing, no control without a name, no page that is wider than the screen; films play, stop, and
# stand still for who asks for it; the keyboard reaches each card; at most 20 MB. Pictures go to $CARGO_TARGET_DIR/gallery, unless CI is set.
# The examples check their own figures, and the gallery fails where one is not what it should be, or where the guide has another table of them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
work="${CARGO_TARGET_DIR:-$PWD/target}/gallery"
rm -rf "$work/pages"
mkdir -p "$work"

page=src/guide/gallery.md
cp "$page" "$work/stored.md"
cargo run -q --release --example gallery -- --write --out "$work/pages"
diff "$work/stored.md" "$page" || { echo "the gallery: $page is stale (< stored, > now); the new figures are written"; exit 1; }
python3 .ci/read_pictures.py "$work/pages" >"$work/list"
echo "the gallery: $(wc -l <"$work/list") files"

. .ci/browser.sh
cp tests/web/gallery.mjs "$work/gallery.mjs" # where Node finds the driver
FOLDER="$work/pages" PICTURES="$work" timeout 400 node "$work/gallery.mjs"
