#!/bin/bash
# Runs the examples coin and tosses for a few seconds of their time, in the ways that the README names, and reads the files that they leave.
# The others run in .ci/gallery.sh and check their own figures; known_outcomes runs in .ci/figures.sh.
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

# Tosses that are killed and resumed in other parts, on another number of threads, have the bytes of those that are not.
cargo build -q --release --example tosses
# The program itself, so that the kill does not reach a shell in its place.
tosses=("${CARGO_TARGET_DIR:-target}/release/examples/tosses" --to 2000)
"${tosses[@]}" --out "$out/whole" --part 2000 --threads 1
"${tosses[@]}" --out "$out/killed" --part 7 >/dev/null &
killed=$!
until [ "$(find "$out/killed" -name '*.part.json' 2>/dev/null | wc -l)" -ge 5 ]; do
  kill -0 "$killed" 2>/dev/null || { echo "the tosses have ended before the kill"; exit 1; }
  sleep 0.01
done
kill -9 "$killed"
wait "$killed" 2>/dev/null || true
before=$(find "$out/killed" -name '*.part.json' | wc -l)
if [ "$before" -ge 286 ] || [ -e "$out/killed/result.json" ]; then
  echo "all $before parts were done before the kill: it shows nothing"
  exit 1
fi
"${tosses[@]}" --out "$out/killed" --merge >"$out/gaps"
grep -q '^missing: --from ' "$out/gaps" || { echo "the gaps are not listed"; exit 1; }
"${tosses[@]}" --out "$out/killed" --part 7 >/dev/null
cmp "$out/whole/result.json" "$out/killed/result.json"
# Other parts of more tosses join those that are there.
"${tosses[@]}" --out "$out/more" --to 700 --part 300 >/dev/null
"${tosses[@]}" --out "$out/more" --part 250 >/dev/null
cmp "$out/whole/result.json" "$out/more/result.json"
echo "tosses: the same bytes after kill -9 with $before of 286 parts"
"${tosses[@]}" --out "$out/replay" --toss 123456

# So have the tasks of a Slurm array.
for task in 3 1 0 2; do
  SLURM_ARRAY_TASK_ID=$task SIZE=500 PART=100 PROGRAM="${tosses[0]}" FOLDER="$out/array" bash examples/tosses/on_slurm.sh >/dev/null
done
"${tosses[@]}" --out "$out/array" --merge >/dev/null
cmp "$out/whole/result.json" "$out/array/result.json"

# Whatever the runs above have left: the trials alone have no picture.
python3 .ci/read_pictures.py "$out" >"$out/list"
echo "all runs: $(wc -l <"$out/list") files"

code=0
coin --quiet --step=-1 --out "$out/bad" 2>"$out/message" || code=$?
if [ "$code" != 2 ] || ! grep -q '^error: --step must be above 0 s, got -1$' "$out/message"; then
  echo "a step of -1 s: exit code $code, and"
  cat "$out/message"
  exit 1
fi
