#!/bin/bash
# Takes EnergyMomentum through many random steps, the eight trials of the coin report through an hour, and a free body through a thousand million steps, and writes the page of the guide.
#   bash .ci/long.sh 1 20          seeds 1 to 20 of the sweep, five million steps each
#   bash .ci/long.sh trials        one simulated hour of each trial, in both precisions
#   bash .ci/long.sh rigid         a body that tumbles freely, with two methods in both precisions
#   bash .ci/long.sh page          only writes the page again
# PROGRAM names the test program, if it is built.
# Each run appends its counts to tests/data/long_runs.csv. Its row `before` has the sums of earlier versions, with the number of bodies left where they were. A seed or a trial that is in it is not run again, so that a stopped command goes on.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
record=tests/data/long_runs.csv
rigid=tests/data/rigid_runs.csv
# Also where cargo builds in another folder.
mkdir -p target
export TUMBLE_SWEEP_RECORD="$PWD/target/long_runs_part.csv"

build() {
  cargo test -q --release --test limits --no-run --message-format=json \
    | sed -n 's/.*"name":"limits".*"executable":"\([^"]*\)".*/\1/p' | tail -1
}
# A run that is stopped leaves no counts behind. A broken promise makes the program fail and is a line of the record, so that the exit code says nothing:
# a run has ended if it has said how many tests have passed and failed.
keep() { # keep LOG
  if ! grep -q '^test result: ' "$1" || ! [ -s "$TUMBLE_SWEEP_RECORD" ]; then
    echo "the run was stopped, or has left no counts: $1"
    exit 1
  fi
  cat "$TUMBLE_SWEEP_RECORD" >>"$record"
  rm -f "$TUMBLE_SWEEP_RECORD"
}

case "${1-}" in
  page) ;;
  trials)
    if ! grep -q '"trial 8, f32"' "$record"; then
      program=${PROGRAM:-$(build)}
      rm -f "$TUMBLE_SWEEP_RECORD"
      TUMBLE_TRIAL_SECONDS=3600 "$program" long:: --test-threads=1 >target/long_runs_trials.log 2>&1 || true
      keep target/long_runs_trials.log
    fi ;;
  rigid)
    program=${PROGRAM:-$(build)}
    part="$PWD/target/rigid_runs_part.csv"
    rm -f "$part"
    TUMBLE_RIGID_STEPS=${STEPS-1000000000} TUMBLE_RIGID_RECORD="$part" "$program" long_rigid::
    { head -1 "$rigid"; sort "$part"; } >"$part.all" && mv "$part.all" "$rigid" && rm "$part" ;;
  [0-9]*)
    program=${PROGRAM:-$(build)}
    for seed in $(seq "$1" "${2-$1}"); do
      grep -q "^$seed," "$record" && continue
      rm -f "$TUMBLE_SWEEP_RECORD"
      PROPTEST_RNG_SEED=$seed TUMBLE_SWEEP_STEPS=${STEPS-2500000} \
        "$program" every_step solids driven:: --skip overflow --skip beyond --test-threads=1 -q >"target/long_runs_$seed.log" 2>&1 || true
      keep "target/long_runs_$seed.log"
      echo "seed $seed: $SECONDS s"
    done ;;
  *) echo "usage: bash .ci/long.sh FIRST_SEED [LAST_SEED] | trials | rigid | page" >&2; exit 2 ;;
esac
python3 .ci/long.py "$record" "$rigid" src/guide/long_runs.md
