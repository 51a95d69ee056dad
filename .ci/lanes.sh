#!/bin/bash
# Instructions a step of a state: eight states one after the other, and together in lanes. They are counted by callgrind for two builds, and compared with benches/lanes.txt.
#   bash .ci/lanes.sh             compares; fails where a count is more than 3 % above what is stored by the same compiler; of another one it says NOT CHECKED
#   bash .ci/lanes.sh --update    stores what it counts, with the times of a step (ns), and writes the table of src/guide/modelling.md
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
stored=benches/lanes.txt
few=96 many=608 tolerance=3
builds='x86-64 x86-64-v3'
target=$(realpath -m "${CARGO_TARGET_DIR:-target}/lanes")

command -v valgrind >/dev/null || { echo 'lanes: valgrind is needed: apt-get install valgrind' >&2; exit 1; }
# A copy of the source without the crates that only other tests and benches use: for another processor all would be built anew.
copy() {
  local toml="$target/source/Cargo.toml"
  rm -rf "$target/source" && mkdir -p "$target/source"
  git ls-files -z | xargs -0 cp --parents -t "$target/source"
  perl -0777 -pi -e 's/(\n\[dev-dependencies\]\n).*?(?=tumble = )/$1/s; s/^(default-members|members) = .*/$1 = ["."]/mg' "$toml"
  if cmp -s Cargo.toml "$toml"; then echo 'lanes: Cargo.toml has other lines than those that are left out of the copy' >&2; return 1; fi
}
build() { # build PROCESSOR: the program
  local flags="-C target-cpu=$1" folder="$target/$1" source="$target/source"
  # The compiler's own choice, with which all crates that the program needs have been built for other checks.
  if [ "$1" = x86-64 ]; then flags='' folder=$(dirname "$target") source=$PWD; fi
  (cd "$source" && RUSTFLAGS="$flags" cargo bench --quiet --bench lanes --no-run --message-format=json --target-dir "$folder") |
    sed -n 's/.*"name":"lanes".*"executable":"\([^"]*\)".*/\1/p'
}
count() { # count PROGRAM INTEGRATOR SCENE HOW STEPS: instructions of the whole program; nothing if it fails
  local said
  said=$(valgrind --tool=callgrind --callgrind-out-file=/dev/null "$@" 2>&1) || { echo "$said" >&2; return 1; }
  sed -n 's/.*Collected : \([0-9]*\).*/\1/p' <<<"$said"
}
per_step() { # per_step PROGRAM INTEGRATOR SCENE HOW: instructions of a step of a state
  local fewer more each
  read -r fewer more < <(paste -d ' ' <(count "$@" "$few") <(count "$@" "$many")) || true
  each=$(((${more:-0} - ${fewer:-0}) / (8 * (many - few))))
  if [ "$each" -le 0 ]; then
    echo "lanes: ${*:2}, $1: a count must increase with the steps, got '$fewer' for $few and '$more' for $many" >&2
    return 1
  fi
  echo "$each"
}
rows() {
  for integrator in SymplecticEuler StrangSplitting Rk4 Nystrom; do
    for scene in rolling flight; do echo "$integrator $scene"; done
  done
  for scene in 12 half tumbling flat own; do echo "StrangSplitting $scene"; done
}
name() {
  case $1 in
    rolling) echo 'eight coins of 120 points roll, and 3 to 6 points touch' ;;
    flight) echo 'eight coins in flight' ;;
    12) echo 'the coins have 12 points, which close and open in turn' ;;
    half) echo 'four of the coins roll, four are in flight' ;;
    tumbling) echo 'four of the coins roll, four tumble' ;;
    flat) echo 'seven of the coins roll, one lies flat on 120 points' ;;
    own) echo 'eight coins roll on your own ground and friction law, tested in every step' ;;
  esac
}

copy
declare -A program
for processor in $builds; do program[$processor]=$(build "$processor"); done

counts() { # counts [--update]: a line for each row and build; with the times, the least of 30 runs
  while read -r integrator scene; do
    for processor in $builds; do
      local run=("${program[$processor]}" "$integrator" "$scene") times='' alone together
      [ "${1-}" != --update ] || times=$("${run[@]}" time 1000) || exit 1
      alone=$(per_step "${run[@]}" one) || exit 1
      together=$(per_step "${run[@]}" many) || exit 1
      printf '%-16s %-9s %-10s %6d %6d %s\n' "$integrator" "$scene" "$processor" "$alone" "$together" "$times"
    done
  done < <(rows)
}
counted=$(rustc --version; counts "$@")

# The table of guide::modelling, from the stored counts.
page=src/guide/modelling.md
table() {
  echo '| states | integrator | `x86-64`: instructions, alone and in lanes | speed | `x86-64-v3`: instructions | speed |'
  echo '|---|---|---|---|---|---|'
  while read -r integrator scene; do
    awk -v integrator="$integrator" -v scene="$scene" -v name="$(name "$scene")" '
      $1 == integrator && $2 == scene { one[$3] = $4; many[$3] = $5; speed[$3] = $6 / $7 }
      function cell(build) { return sprintf("%d, %d | %.1f", one[build], many[build], speed[build]) }
      END { printf "| %s | `%s` | %s | %s |\n", name, integrator, cell("x86-64"), cell("x86-64-v3") }' "$stored"
  done < <(rows)
}
with_table() { # The page with the table in the place of the old one.
  awk -v table="$(table)" '/^<!-- lanes: begin/ { print; print ""; print table; print ""; inside = 1 } /^<!-- lanes: end/ { inside = 0 } !inside && !/^<!-- lanes: begin/' "$page"
}

if [ "${1-}" = --update ]; then
  printf '%s\n' "$counted" >"$stored"
  with_table >"$page.new" && mv "$page.new" "$page"
  cat "$stored"
  exit
fi
diff <(with_table) "$page" || { echo "$page has other counts than $stored:  .ci/lanes.sh --update"; exit 1; }
same=1
if [ "$(head -n 1 "$stored")" != "$(rustc --version)" ]; then
  same=0
  echo "NOT CHECKED: lanes: stored for $(head -n 1 "$stored"), counted with $(rustc --version): only shown. To store these:  .ci/lanes.sh --update"
fi
paste -d ' ' <(tail -n +2 <<<"$counted") <(tail -n +2 "$stored") | awk -v tolerance="$tolerance" -v same="$same" '
  ($1 != $6 || $2 != $7 || $3 != $8) { print "not the set that is stored. To store it:  .ci/lanes.sh --update"; wrong = 1; exit }
  {
    alone = 100 * ($4 - $9) / $9
    lanes = 100 * ($5 - $10) / $10
    worse = alone > lanes ? alone : lanes
    better = alone < lanes ? alone : lanes
    verdict = worse > tolerance ? "SLOWER" : better < -tolerance ? "faster" : ""
    printf "%-16s %-9s %-10s %6d alone, %+5.1f %%, %6d in lanes, %+5.1f %% %s\n", $1, $2, $3, $4, alone, $5, lanes, verdict
    if (worse > tolerance) slower++
  }
  END { exit wrong || (same && slower > 0) }'
