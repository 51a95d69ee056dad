#!/bin/bash
# Shows on this machine, with the ordinary compiler, that the core needs no standard library and no allocator and cannot panic:
# tests/no_std is linked into one object, and whatever that object still asks for is looked at. Last, the look itself is put to the test.
set -euo pipefail
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}/no_std"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# What compilers call of their own accord, and every target has.
allowed='memcpy|memmove|memset|memcmp|bcmp'

# link FEATURES: builds the probes, and writes each symbol that they need from outside to $work/needed.
link() {
  cargo build -q --release --locked --manifest-path tests/no_std/Cargo.toml --features "$1"
  local library="$CARGO_TARGET_DIR/release/libtumble_no_std.a" probes
  mapfile -t probes < <(nm --defined-only "$library" 2>/dev/null | awk '$2 == "T" && $3 ~ /^probe_/ { print $3 }')
  [ ${#probes[@]} != 0 ] || { echo "no probe in $library"; exit 1; }
  # Only what the probes reach is kept: the rest of the archive proves nothing.
  ld -r --gc-sections --entry="${probes[0]}" "${probes[@]/#/--undefined=}" -o "$work/probes.o" "$library"
  nm --undefined-only "$work/probes.o" | awk '{ print $2 }' | sort -u >"$work/needed"
  echo "${#probes[@]} probes need from outside: $(tr '\n' ' ' <"$work/needed")"
}

link ""
if grep -vxE "$allowed" "$work/needed" >"$work/unwanted"; then
  echo "the core must not need $(tr '\n' ' ' <"$work/unwanted")"
  exit 1
fi

link control
if ! grep -qx a_panic_remains "$work/needed"; then
  echo "the control panics by design, and this check did not see it"
  exit 1
fi
