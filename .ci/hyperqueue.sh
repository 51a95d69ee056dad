#!/bin/bash
# Tosses on a HyperQueue server with two workers, killed in the middle and started again, have the bytes of one process.
# Installs HyperQueue into a temporary folder, and Debian's python3-venv if it is missing. Where it cannot be had, it says so and checks nothing.
set -euo pipefail
. .ci/debian.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# What Debian leaves out of its package python3.
python3 -c 'import ensurepip' 2>/dev/null || debian_install python3-venv >"$work/apt.log" 2>&1 || cat "$work/apt.log"
if ! { python3 -m venv "$work/python" && "$work/python/bin/pip" install -q --disable-pip-version-check hyperqueue==0.27.0; }; then
  echo "NOT CHECKED: HyperQueue cannot be installed on this machine"
  exit 0
fi
cargo build -q --release --example tosses
program="${CARGO_TARGET_DIR:-target}/release/examples/tosses"
"$program" --to 4000 --part 4000 --threads 1 --out "$work/whole" >/dev/null

queue=("$work/python/bin/python" examples/tosses/on_hyperqueue.py --tosses 4000 --size 50 --program "$program" --out "$work/queue")
parts() { find "$work/queue" -name '*.part.json' 2>/dev/null | wc -l; }
"${queue[@]}" >"$work/log" 2>&1 &
until [ "$(parts)" -ge 5 ]; do
  kill -0 $! 2>/dev/null || { cat "$work/log"; echo "the queue has ended"; exit 1; }
  sleep 0.05
done
kill -9 $!
wait $! 2>/dev/null || true
before=$(parts)
[ "$before" -lt 80 ] || { echo "all parts were done before the kill: it shows nothing"; exit 1; }
"${queue[@]}" 2>/dev/null | tail -1
cmp "$work/whole/result.json" "$work/queue/result.json"
echo "HyperQueue: the same bytes after kill -9 with $before of 80 parts"
