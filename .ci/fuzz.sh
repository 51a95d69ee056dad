#!/bin/bash
# Searches for inputs that break a promise, guided by the coverage: SECONDS_EACH (20) a target. TARGETS names some of them instead of all.
# SEED (a random one) fixes the inputs that are tried: with one seed a longer run begins with those of a shorter one.
# A finding is written to $CARGO_TARGET_DIR/fuzz/TARGET/, with the command that plays it again. NEW=1 keeps the inputs found for the next run there.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
seconds=${SECONDS_EACH:-20}
read -ra targets <<<"${TARGETS:-scene contract load outcome terrain session}"
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}"
host=$(rustc -vV | sed -n 's/^host: //p')

# libFuzzer is written in C++, and the crate libfuzzer-sys compiles it.
command -v c++ >/dev/null || .ci/tools.sh

# The counters and tables that libFuzzer reads, as the stable compiler's LLVM inserts them. With a target named, build scripts have none.
flags="--cfg fuzzing -Cpasses=sancov-module"
for option in level=4 inline-8bit-counters pc-table trace-compares; do
  flags+=" -Cllvm-args=-sanitizer-coverage-$option"
done
binaries=()
for target in "${targets[@]}"; do binaries+=(--bin "$target"); done
RUSTFLAGS="$flags" cargo build -q --release --locked --manifest-path tests/fuzz/Cargo.toml --target "$host" "${binaries[@]}"

# play TARGET: searches, and says what it has found; fails if that is a finding.
# What hangs is found by the count of its evaluations. The time limit is for what does not evaluate, and must not end a run on a busy machine.
play() {
  local target=$1 code=0 out binary executions edges
  out="$CARGO_TARGET_DIR/fuzz/$target"
  binary="$CARGO_TARGET_DIR/$host/release/$target"
  mkdir -p "$out/new"
  [ -n "${NEW:-}" ] || rm -f "$out"/new/*
  if ! "$binary" -seed="${SEED:-0}" -max_total_time="$seconds" -timeout=300 -rss_limit_mb=2048 -max_len=512 -len_control=0 \
    -print_final_stats=1 -artifact_prefix="$out/" "$out/new" "tests/fuzz/corpus/$target" >"$out/log" 2>&1; then
    grep -E 'panicked at|^thread|ERROR|SUMMARY|Test unit' -A 1 "$out/log" | head -20 || true
    echo "$target: a finding. It is played again by:  $binary $(sed -n 's/.*Test unit written to //p' "$out/log" | tail -1)"
    code=1
  fi
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$out/log")
  edges=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$out/log" | tail -1)
  printf '%-10s %9s executions, %6s edges in %s s\n' "$target" "${executions:-?}" "${edges:-?}" "$seconds"
  return "$code"
}
# As many at a time as there are cores, since each keeps one busy.
export host seconds
export -f play
printf '%s\n' "${targets[@]}" | xargs -P "$(nproc)" -I{} bash -euo pipefail -c 'play {}'
