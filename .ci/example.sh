#!/bin/bash
# Runs the example for a few seconds of its time, in the ways that the README names, and reads the files that it leaves.
set -euo pipefail
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
coin() { cargo run -q --release --example coin -- "$@"; }

coin --duration 2 --out "$out/one"
python3 .ci/read_pictures.py "$out/one"

for method in energy-momentum report forward-euler symplectic-euler strang rk4; do
  coin --quiet --duration 0.5 --integrator "$method" --out "$out/$method"
done

coin --quiet --all --duration 2 --out "$out/all"
python3 .ci/read_pictures.py "$out/all" >"$out/list"
echo "all trials: $(wc -l <"$out/list") files"

if coin --quiet --step=-1 --out "$out/bad" 2>"$out/message"; then
  echo "the example takes a step of -1 s"
  exit 1
fi
cat "$out/message"
