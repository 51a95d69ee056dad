# shellcheck shell=bash
# Debian's packages, for the checks that need some; sourced from the top folder. Checks that run at the same time take turns.

# debian_turn COMMAND…: runs a command while no other check uses the system's packages.
debian_turn() {
  (
    flock 9
    "$@"
  ) 9>"${TMPDIR:-/tmp}/debian_packages.lock"
}

# Where packages can be installed.
has_debian() { command -v apt-get >/dev/null && [ "$(id -u)" = 0 ]; }

# debian_install PACKAGE…: installs packages, and where that is impossible says which are missing.
debian_install() {
  has_debian || { echo "please install: $*"; return 1; }
  debian_turn apt-get update -qq &&
    DEBIAN_FRONTEND=noninteractive debian_turn apt-get install -qq -y --no-install-recommends "$@"
}
