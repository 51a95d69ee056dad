#!/bin/bash
# Runs the battery of tests/bits on this machine in several builds, and on four other processors, and compares with tests/bits/hashes.txt.
# It takes some minutes and 1 GB of packages, so .ci/run leaves it out (tests/bits.rs compares this machine in `cargo test`). Run it
# after UPDATE=1 cargo test --test bits, and before a release. From the top folder:  .ci/targets.sh
#
# The language's own library is built for the other processors from Debian's source, which fits Debian's compiler alone; stable compilers
# do that only when told that they are none. The linker is rustup's. QEMU stands in for the processors, Node for a browser.
# To find the scene that differs:  SCENES=1 .ci/targets.sh  leaves a line for each scene in $CARGO_TARGET_DIR/bits/*.scenes
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}/bits"
results="$CARGO_TARGET_DIR" stored=tests/bits/hashes.txt detail="${SCENES:+scenes}"
mkdir -p "$results"

missing=()
need() { command -v "$1" >/dev/null || missing+=("$2"); } # need PROGRAM PACKAGE
need qemu-system-arm qemu-system-arm
need qemu-aarch64 qemu-user
need qemu-riscv32 qemu-user
need node nodejs
for package in rustc-web rust-web-src; do
  dpkg -s "$package" >/dev/null 2>&1 || missing+=("$package")
done
if [ ${#missing[@]} != 0 ]; then
  if ! command -v apt-get >/dev/null || [ "$(id -u)" != 0 ]; then
    echo "please install: ${missing[*]}"
    exit 1
  fi
  apt-get update -qq
  DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends "${missing[@]}" >"$results/apt.log" 2>&1 \
    || { cat "$results/apt.log"; exit 1; }
fi

differ=0
compare() { # compare NAME COMMAND…: runs the battery, and says in a line whether it has the stored bits
  local code=0 seconds=$SECONDS
  timeout 600 "${@:2}" >"$results/$1.scenes" || code=$?
  # A line for a scene is indented.
  grep -v '^ ' "$results/$1.scenes" >"$results/$1.txt" || true
  if [ "$code" = 0 ] && cmp -s "$stored" "$results/$1.txt"; then
    echo "same bits: $1 ($((SECONDS - seconds)) s)"
  else
    echo "DIFFERENT: $1 (exit $code)"
    diff "$stored" "$results/$1.txt" || true
    differ=1
  fi
}
battery() { cargo "$1" -q --locked --manifest-path tests/bits/Cargo.toml "${@:2}"; }

# This machine, with rustup's compiler. What the tree may switch on: tumble's features, and glam's as somebody else in it would; its `fast-math` of
# earlier versions is gone since 0.34, and `core-simd` needs an unstable compiler.
host() { # host NAME FOLDER OPTION…
  battery build "${@:3}"
  compare "$1" "$CARGO_TARGET_DIR/$2/tumble_bits"
}
host host-dev debug --features "$detail"
host host-release release --release --features "$detail"
host host-all-features release --release --features "$detail,std,serde,mint,approx-05"
for feature in std libm scalar-math; do
  host "host-glam-$feature" release --release --features "$detail,glam-$feature"
done
# Fused operations are there to be used, and must not be.
RUSTFLAGS=-Ctarget-cpu=native host host-native release --release --features "$detail"

# Other processors.
linker="$(rustup run stable rustc --print sysroot)/lib/rustlib/$(rustc -vV | sed -n 's/^host: //p')/bin/rust-lld"
[ -x "$linker" ] || { echo "no linker at $linker"; exit 1; }
RUSTC=$(dpkg -L rustc-web | awk '/bin\/rustc$/ && !seen { print; seen = 1 }') # to its end: a pipe that is closed early is an error here
export RUSTC RUSTC_BOOTSTRAP=1
for target in THUMBV7EM_NONE_EABIHF AARCH64_UNKNOWN_NONE RISCV32IMAC_UNKNOWN_NONE_ELF WASM32_UNKNOWN_UNKNOWN; do
  export "CARGO_TARGET_${target}_LINKER=$linker"
done
export CARGO_TARGET_THUMBV7EM_NONE_EABIHF_RUSTFLAGS="-Clink-arg=-T$PWD/tests/bits/cortex_m.ld"
other() { # other TARGET PROFILE OPTION…
  battery rustc -Zbuild-std=core --target "$1" --profile "$2" --features "$detail" "${@:3}"
}
semihosting="-nographic -monitor none -serial none -semihosting-config enable=on,target=native"

for profile in release dev; do
  folder=${profile/dev/debug}
  other aarch64-unknown-none "$profile" --bin tumble_bits
  compare "aarch64-$profile" qemu-aarch64 "$CARGO_TARGET_DIR/aarch64-unknown-none/$folder/tumble_bits"
done
other riscv32imac-unknown-none-elf release --bin tumble_bits
compare riscv32imac-release qemu-riscv32 "$CARGO_TARGET_DIR/riscv32imac-unknown-none-elf/release/tumble_bits"
other wasm32-unknown-unknown release --lib --crate-type cdylib
compare wasm32-release node tests/bits/run.mjs "$CARGO_TARGET_DIR/wasm32-unknown-unknown/release/tumble_bits.wasm"
other thumbv7em-none-eabihf release --bin tumble_bits
# shellcheck disable=SC2086 # several options
compare thumbv7em-hf-release qemu-system-arm -M mps2-an386 $semihosting -kernel "$CARGO_TARGET_DIR/thumbv7em-none-eabihf/release/tumble_bits"

exit "$differ"
