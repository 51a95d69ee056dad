#!/bin/bash
# Runs the examples for a few seconds of their time, in the ways that README and gallery name, and reads the files that they leave.
# Those of the gallery check their own figures and fail where one is not what it should be.
set -euo pipefail
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
coin() { cargo run -q --release --example coin -- "$@"; }

# As the README types it, to its end.
coin --out "$out/one"
python3 .ci/read_pictures.py "$out/one"

for method in energy-momentum report forward-euler symplectic-euler strang rk4; do
  coin --quiet --duration 0.5 --integrator "$method" --out "$out/$method"
done

coin --quiet --all --duration 2 --out "$out/all"
for example in heads_or_tails custom_body dice tippe_top rising_egg eulers_disk slide_to_roll custom_ground sphere_with_spin; do
  cargo run -q --release --example "$example" -- --quick --out "$out/all"
done
cargo run -q --release --example choose_accuracy -- --quick --out "$out/all"
cargo run -q --release --example round_rim >"$out/round_rim"
cargo run -q --release --example measured_tosses -- --synthetic --out "$out/all"
python3 .ci/read_pictures.py "$out/all" >"$out/list"
echo "all trials and the gallery: $(wc -l <"$out/list") files"

if coin --quiet --step=-1 --out "$out/bad" 2>"$out/message"; then
  echo "the example takes a step of -1 s"
  exit 1
fi
cat "$out/message"
