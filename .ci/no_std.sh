#!/bin/bash
# Shows on this machine, with the ordinary compiler, that the core needs no standard library and no allocator and cannot panic:
# tests/no_std is linked into one object, and whatever that object still asks for is looked at. Last, the look itself is put to the test.
set -euo pipefail
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}/no_std"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# What compilers call of their own accord, and every target has.
allowed='memcpy|memmove|memset|memcmp|bcmp'

cargo build -q --release --locked --manifest-path tests/no_std/Cargo.toml
library="$CARGO_TARGET_DIR/release/libtumble_no_std.a"
mapfile -t probes < <(nm --defined-only "$library" 2>/dev/null | awk '$2 == "T" && $3 ~ /^probe_/ && $3 != "probe_control" { print $3 }')
[ ${#probes[@]} != 0 ] || { echo "no probe in $library"; exit 1; }

# link PROBE…: writes each symbol that these probes need from outside to $work/needed. Only what they reach is kept: the rest of the archive proves nothing.
# A symbol is needed if a relocation of what is kept names it. The linker also keeps the names that only the rest needs.
link() {
  ld -r --gc-sections --entry="$1" "${@/#/--undefined=}" -o "$work/probes.o" "$library"
  # The compiler's own library, which conversions of long integers need, carries bitcode. nm may read that in place of the symbols.
  objcopy --remove-section=.llvmbc --remove-section=.llvmcmd "$work/probes.o"
  nm --undefined-only "$work/probes.o" | awk '{ print $2 }' | sort -u >"$work/undefined"
  readelf --relocs --wide "$work/probes.o" | awk '{ print $5 }' | sort -u | comm -12 - "$work/undefined" >"$work/needed"
  echo "$# probes need from outside: $(tr '\n' ' ' <"$work/needed")"
}

link "${probes[@]}"
if grep -vxE "$allowed" "$work/needed" >"$work/unwanted"; then
  echo "the core must not need $(tr '\n' ' ' <"$work/unwanted")"
  exit 1
fi

link probe_control
if ! grep -qx a_panic_remains "$work/needed"; then
  echo "the control panics by design, and this check did not see it"
  exit 1
fi
