# shellcheck shell=bash
# What the checks for other processors share; sourced from the top folder. Installs what is missing where Debian's packages can be installed.
#
# The language's own library is built for each processor from Debian's source, which fits Debian's compiler alone; stable compilers do that only when
# told that they are none. The linker is rustup's. QEMU stands in for the processors, Node for a browser.
. .ci/debian.sh

# cross_tools WORK: installs compiler, emulators and Node; a log of it goes to the folder WORK.
cross_tools() {
  local missing=()
  need() { command -v "$1" >/dev/null || missing+=("$2"); } # need PROGRAM PACKAGE
  need qemu-system-arm qemu-system-arm
  need qemu-aarch64 qemu-user
  need qemu-riscv32 qemu-user
  need node nodejs
  cross_install "$1" "${missing[@]}"
}

# cross_install WORK PACKAGE…: installs Debian's packages, and the compiler that every target needs.
cross_install() {
  local missing=("${@:2}") package
  for package in rustc-web rust-web-src; do
    dpkg -s "$package" >/dev/null 2>&1 || missing+=("$package")
  done
  [ ${#missing[@]} != 0 ] || return 0
  debian_install "${missing[@]}" >"$1/apt.log" 2>&1 || { cat "$1/apt.log"; return 1; }
}

# The linker, and Debian's compiler with what lets it build the language's library.
cross_linker() {
  local linker
  linker="$(rustup run stable rustc --print sysroot)/lib/rustlib/$(rustc -vV | sed -n 's/^host: //p')/bin/rust-lld"
  [ -x "$linker" ] || { echo "no linker at $linker" >&2; return 1; }
  echo "$linker"
}
cross_compiler() {
  dpkg -L rustc-web | awk '/bin\/rustc$/ && !seen { print; seen = 1 }' # to its end: a pipe that is closed early is an error here
}
