#!/bin/bash
# Runs the battery of tests/bits with this machine's widest vectors and on four other targets, and compares with tests/bits/hashes.txt.
# From the top folder:  .ci/targets.sh
# To find the scene that differs:  SCENES=1 .ci/targets.sh  leaves a line for each scene in $CARGO_TARGET_DIR/bits/*.scenes
#
# | program      | rows                      | opt-level | what it tries                                           |
# |--------------|---------------------------|-----------|---------------------------------------------------------|
# | host-native  | all                       | 3         | this machine's widest vectors, tumble's features        |
# | aarch64      | all                       | 2         | vectors of another processor                            |
# | wasm32       | all                       | 1         | a compiler behind the compiler; glam's features, as     |
# |              |                           |           | somebody else in the tree sets them                     |
# | thumbv7em-hf | its share, and all of f32 | 2         | f32 in a unit of the processor, f64 by integers         |
# | riscv32imac  | its share                 | 2         | f32 and f64 by integers                                 |
#
# The battery on this machine without optimisation and with tumble's features is a test of `cargo test` (tests/downstream/tests/bits.rs). The last two share
# the rows between them (RISC_V and CORTEX_M in the battery): the same functions of the compiler's library compute f64 on both, and take minutes.
# Of the second battery in f64 they run one method each.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
. .ci/cross.sh
results="${CARGO_TARGET_DIR:-$PWD/target}/bits" stored=tests/bits/hashes.txt detail="${SCENES:+scenes}"
mkdir -p "$results"
cross_tools "$results"
cross_rustc=$(cross_compiler) linker=$(cross_linker)
export results stored detail cross_rustc linker

build() { cargo build -q --locked --manifest-path tests/bits/Cargo.toml --bin tumble_bits "$@"; }
# run NAME ROWS COMMAND…: runs the battery, and says in a line whether it has the stored bits; fails if not, or if a stored row that matches ROWS is not there.
run() {
  local code=0 start=$SECONDS wanted="$results/$1.wanted"
  timeout 1500 "${@:3}" >"$results/$1.scenes" || code=$?
  # A line for a scene is indented.
  grep -v '^ ' "$results/$1.scenes" >"$results/$1.txt" || true
  # The stored rows that it has or must have, in their order.
  awk -v rows="$2" 'FILENAME == ARGV[1] { has[$0]; next } $0 in has || $0 ~ rows' "$results/$1.txt" "$stored" >"$wanted"
  if [ "$code" = 0 ] && cmp -s "$wanted" "$results/$1.txt"; then
    echo "same bits: $1, $(wc -l <"$wanted") rows ($((SECONDS - start)) s)"
  else
    echo "DIFFERENT: $1 (exit $code)"
    diff "$wanted" "$results/$1.txt" || true
    return 1
  fi
}
cross() { # cross NAME TARGET LEVEL ROWS EMULATOR…: the emulator is followed by the program
  local variable=${2^^} program="$CARGO_TARGET_DIR/$2/release/tumble_bits"
  [[ $2 != wasm32* ]] || program+=.wasm
  export RUSTC=$cross_rustc RUSTC_BOOTSTRAP=1 CARGO_PROFILE_RELEASE_OPT_LEVEL=$3 "CARGO_TARGET_${variable//-/_}_LINKER=$linker"
  build -Zbuild-std=core --release --features "$detail" --target="$2"
  run "$1" "$4" "${@:5}" "$program"
}
# One program: built in a folder of its own, and run.
job() {
  export CARGO_TARGET_DIR="$results/$1"
  local semihosting=(-nographic -monitor none -serial none -semihosting-config enable=on,target=native)
  case $1 in
    # Fused operations are there to be used, and must not be. std takes the machine's square root, the other features only add implementations.
    host-native)
      RUSTFLAGS=-Ctarget-cpu=native build --release --features "$detail,std,serde,mint,approx-05"
      run "$1" . "$CARGO_TARGET_DIR/release/tumble_bits"
      ;;
    aarch64) cross "$1" aarch64-unknown-none 2 . qemu-aarch64 ;;
    wasm32)
      # glam's `fast-math` of earlier versions is gone since 0.34, and `core-simd` needs an unstable compiler.
      detail+=,glam-libm,glam-scalar-math
      export CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS='-Clink-arg=--no-entry -Clink-arg=--export=run'
      cross "$1" wasm32-unknown-unknown 1 . node tests/bits/run.mjs
      ;;
    thumbv7em-hf)
      export CARGO_TARGET_THUMBV7EM_NONE_EABIHF_RUSTFLAGS="-Clink-arg=-T$PWD/tests/bits/cortex_m.ld"
      cross "$1" thumbv7em-none-eabihf 2 ^f32 qemu-system-arm -M mps2-an386 "${semihosting[@]}" -kernel
      ;;
    riscv32imac) cross "$1" riscv32imac-unknown-none-elf 2 'live page' qemu-riscv32 ;;
  esac
}
export -f build run cross job

# As many at a time as there are cores, since each keeps one busy: the longest first.
printf '%s\n' riscv32imac thumbv7em-hf host-native aarch64 wasm32 |
  xargs -P "$(nproc)" -I{} bash -euo pipefail -c 'job {}'

# Those that share rows have all of them between them, but for those that the battery leaves to processors with a unit for f64.
shared() { grep -vE '^f64 .*, driven' "$stored"; grep -E '^f64 (StrangSplitting|EnergyMomentum), driven' "$stored"; }
sort -u "$results/thumbv7em-hf.txt" "$results/riscv32imac.txt" | cmp - <(shared | sort) || { echo 'a row is run by neither of those that share them'; exit 1; }
