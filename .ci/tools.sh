#!/bin/bash
# Installs the tools of the other checks where Debian's packages can be installed, and otherwise says which are missing.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
. .ci/debian.sh

missing=()
need() { command -v "$1" >/dev/null || missing+=("$2"); } # need PROGRAM PACKAGE
need cc gcc
need c++ g++
need ld binutils
need nm binutils
need python3 python3
need valgrind valgrind
[ ${#missing[@]} = 0 ] || debian_install "${missing[@]}"

for component in fmt clippy; do
  cargo "$component" --version || rustup component add "${component/fmt/rustfmt}"
done
cargo hack --version 2>/dev/null || cargo install -q --locked cargo-hack
# Without optimisation it is built three times as fast.
cargo public-api --version 2>/dev/null || cargo install -q --locked --debug cargo-public-api
rustc --version
