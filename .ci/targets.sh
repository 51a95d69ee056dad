#!/bin/bash
# Runs the battery of tests/bits on this machine in several builds, and on four other processors, and compares with tests/bits/hashes.txt.
# From the top folder:  .ci/targets.sh
# To find the scene that differs:  SCENES=1 .ci/targets.sh  leaves a line for each scene in $CARGO_TARGET_DIR/bits/*.scenes
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
. .ci/cross.sh
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}/bits"
results="$CARGO_TARGET_DIR" stored=tests/bits/hashes.txt detail="${SCENES:+scenes}"
mkdir -p "$results"
cross_tools "$results"

differ=0
compare() { # compare NAME COMMAND…: runs the battery, and says in a line whether it has the stored bits; fails if not
  local code=0 seconds=$SECONDS
  timeout 1500 "${@:2}" >"$results/$1.scenes" || code=$?
  # A line for a scene is indented.
  grep -v '^ ' "$results/$1.scenes" >"$results/$1.txt" || true
  if [ "$code" = 0 ] && cmp -s "$stored" "$results/$1.txt"; then
    echo "same bits: $1 ($((SECONDS - seconds)) s)"
  else
    echo "DIFFERENT: $1 (exit $code)"
    diff "$stored" "$results/$1.txt" || true
    return 1
  fi
}
build() { cargo build -q --locked --manifest-path tests/bits/Cargo.toml --bin tumble_bits "$@"; }

# This machine, with rustup's compiler, in both profiles and with all that the tree may switch on:
# without tumble's features (here in the dev profile, on the other processors in the release profile),
# with all of them (std, glam's too, takes the machine's square root, the others only add
# implementations), and with glam's other features as somebody else in the tree would set them. glam's `fast-math` of earlier versions is gone since 0.34, and `core-simd`
# needs an unstable compiler.
# Each build is one large crate, which keeps one core busy: so two are built side by side, in folders of their own.
host() { # host NAME FOLDER OPTION…
  (
    export CARGO_TARGET_DIR="$results/$1"
    build "${@:3}"
    compare "$1" "$CARGO_TARGET_DIR/$2/tumble_bits"
  )
}
runs=()
finish() { # waits for all that have been started
  local run
  for run in "${runs[@]}"; do wait "$run" || differ=1; done
  runs=()
}
host host-dev debug --features "$detail" & runs+=($!)
# Fused operations are there to be used, and must not be.
RUSTFLAGS=-Ctarget-cpu=native host host-native release --release --features "$detail" & runs+=($!)
finish
for set in std,serde,mint,approx-05,glam-scalar-math glam-libm; do
  host "host-release-$set" release --release --features "$detail,$set" & runs+=($!)
done
finish

# Other processors.
RUSTC=$(cross_compiler) linker=$(cross_linker)
export RUSTC RUSTC_BOOTSTRAP=1
for target in THUMBV7EM_NONE_EABIHF AARCH64_UNKNOWN_NONE RISCV32IMAC_UNKNOWN_NONE_ELF WASM32_UNKNOWN_UNKNOWN; do
  export "CARGO_TARGET_${target}_LINKER=$linker"
done
export CARGO_TARGET_THUMBV7EM_NONE_EABIHF_RUSTFLAGS="-Clink-arg=-T$PWD/tests/bits/cortex_m.ld"
export CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS="-Clink-arg=--no-entry -Clink-arg=--export=run"
program() { echo "$CARGO_TARGET_DIR/$1/release/tumble_bits"; }
semihosting="-nographic -monitor none -serial none -semihosting-config enable=on,target=native"

build -Zbuild-std=core --release --features "$detail" \
  --target={aarch64-unknown-none,riscv32imac-unknown-none-elf,wasm32-unknown-unknown,thumbv7em-none-eabihf}

# An emulator uses one core and takes minutes, so they run side by side.
# shellcheck disable=SC2086 # several options
compare thumbv7em-hf-release qemu-system-arm -M mps2-an386 $semihosting -kernel "$(program thumbv7em-none-eabihf)" & runs+=($!)
compare riscv32imac-release qemu-riscv32 "$(program riscv32imac-unknown-none-elf)" & runs+=($!)
compare aarch64-release qemu-aarch64 "$(program aarch64-unknown-none)" & runs+=($!)
compare wasm32-release node tests/bits/run.mjs "$(program wasm32-unknown-unknown).wasm" & runs+=($!)
finish

exit "$differ"
