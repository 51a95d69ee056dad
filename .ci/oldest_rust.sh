#!/bin/bash
# Builds the library with the oldest compiler that Cargo.toml promises: for this machine with every set of features that matters,
# and for a Cortex-M4F, which has neither an operating system nor an allocator.
# rustup's compiler of that version is taken if it is there (with its component rust-src), else Debian's.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
. .ci/debian.sh
target_dir="${CARGO_TARGET_DIR:-$PWD/target}"
version=$(sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
unpacked="$target_dir/rustc-$version"

# Debian's package of that version would push out a newer one, so it is unpacked, not installed: compiler, library, and the library's source.
unpack_debian_rustc() {
  local llvm partial="$unpacked.partial" package
  rm -rf "$partial" "$unpacked"
  mkdir -p "$partial"
  apt-get update -qq
  # To its end: a pipe that is closed early is an error here.
  llvm=$(apt-cache depends "libstd-rust-web-$version" | awk 'match($0, /libllvm[0-9]+/) && !seen { print substr($0, RSTART, RLENGTH); seen = 1 }')
  DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends "$llvm" >"$partial/log" 2>&1 || { cat "$partial/log"; return 1; }
  (cd "$partial" && apt-get download -qq -o APT::Sandbox::User=root \
    "rustc-web=$version*" "libstd-rust-web-$version" "libstd-rust-web-dev=$version*" "rust-web-src=$version*")
  for package in "$partial"/*.deb; do
    dpkg-deb --fsys-tarfile "$package" | tar -x -C "$partial" --wildcards --no-wildcards-match-slash \
      --exclude='./usr/src/*/'{src,compiler,tests} --exclude=./usr/share
    rm "$package"
  done
  printf '#!/bin/sh\nLD_LIBRARY_PATH="%s" exec "%s" "$@"\n' "$unpacked/usr/lib/x86_64-linux-gnu" "$unpacked/usr/bin/rustc" >"$partial/rustc"
  chmod +x "$partial/rustc"
  mv "$partial" "$unpacked"
}

if rustup toolchain list 2>/dev/null | grep -q "^$version-"; then
  RUSTC=$(rustup which --toolchain "$version" rustc)
else
  RUSTC="$unpacked/rustc"
  if [ ! -x "$RUSTC" ]; then
    if ! has_debian; then
      echo "no Rust $version: rustup toolchain install $version --profile minimal --component rust-src"
      exit 1
    fi
    debian_turn unpack_debian_rustc
  fi
fi
export RUSTC
"$RUSTC" --version | grep -F "rustc $version." || { echo "wanted Rust $version, got $("$RUSTC" --version)"; exit 1; }

export CARGO_TARGET_DIR="$target_dir/oldest"
for features in --no-default-features --features=std --all-features; do
  echo "library, $features"
  cargo build -q --locked -p tumble --lib "$features" --config 'profile.dev.package."*".opt-level=0'
done

# The language's own library is built along, since no such target is shipped; stable compilers do that only when told that they are none.
# Compiled and not optimised, which takes minutes: .ci/no_std.sh and .ci/embedded.sh look at what the linker leaves.
echo "tests/no_std for thumbv7em-none-eabihf"
export CARGO_PROFILE_RELEASE_LTO=off CARGO_PROFILE_RELEASE_OPT_LEVEL=0 CARGO_PROFILE_RELEASE_CODEGEN_UNITS=16
RUSTC_BOOTSTRAP=1 cargo build -q --release --locked -Zbuild-std=core --target thumbv7em-none-eabihf --manifest-path tests/no_std/Cargo.toml
