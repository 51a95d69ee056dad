#!/bin/bash
# Builds examples/embedded for three processors and looks at the images: nothing that panics, no double precision in a program of single precision, no
# more code and stack than stored here. Runs them on an emulated Cortex-M4F, Cortex-M3 and RISC-V and compares the lines with this machine's.
# Prints the table of code, memory and instructions of examples/embedded/README.md. From the top folder:
#   .ci/embedded.sh            fails if the page has another table of the same compiler; of another one it says NOT CHECKED
#   .ci/embedded.sh --write    writes it into the page, and takes a million steps on the emulated Cortex-M4F
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
. .ci/cross.sh
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}/firmware"
work="$CARGO_TARGET_DIR/work"
mkdir -p "$work"
cross_tools "$work"
command -v qemu-system-riscv32 >/dev/null || cross_install "$work" qemu-system-misc

# Bytes of code and constants, and of stack, that a program may take on the Cortex-M4F, and the profile of the build.
programs=(
  'symplectic_euler_f32 22016 4096 release'
  'symplectic_euler_f64 49664 6144 release'
  'energy_momentum_f32 99328 4608 release'
  'compact_energy_momentum_f32 99328 6208 release'
  'compact_energy_momentum_f32 72704 6400 small'
  'energy_momentum_f64 158720 8192 release'
)
profile=release
build() { cargo build -q --profile $profile --locked --manifest-path examples/embedded/Cargo.toml "$@"; }
# The lines that they print here are the same however they are linked.
CARGO_PROFILE_RELEASE_LTO=off build --bins
linker=$(cross_linker) RUSTC=$(cross_compiler)
export RUSTC RUSTC_BOOTSTRAP=1
for target in THUMBV7EM_NONE_EABIHF THUMBV6M_NONE_EABI RISCV32IMAC_UNKNOWN_NONE_ELF; do
  export "CARGO_TARGET_${target}_LINKER=$linker"
done
m4f=thumbv7em-none-eabihf m0=thumbv6m-none-eabi riscv=riscv32imac-unknown-none-elf
# The million steps run on the Cortex-M4F alone.
bins=()
for line in "${programs[@]}"; do [[ $line == *small ]] || bins+=(--bin "${line%% *}"); done
build -Zbuild-std=core --bins --target=$m4f
build -Zbuild-std=core "${bins[@]}" --target={$m0,$riscv}
profile=small
build -Zbuild-std=core --bin compact_energy_momentum_f32 --target={$m4f,$m0,$riscv}
profile=release

fail() { echo "$*"; exit 1; }
image() { echo "$CARGO_TARGET_DIR/$1/$profile/$2"; } # image TARGET PROGRAM
# A symbol is in an image only where something calls it: the linker leaves out the rest.
panics() { nm "$1" | grep -E 'panic|unwrap_failed|expect_failed|slice_.*fail|rust_begin_unwind' || true; }
# Widening alone is let pass: it carries a parameter that is refused, when a scene is composed, into the error's f64.
doubles() { nm "$1" | grep -E '__aeabi_(d|cd)|__aeabi_[a-z0-9]*2d|__[a-z0-9]*df[a-z0-9]*' | grep -vE '__aeabi_u?[fi]2d|extendsfdf2|floatun' || true; }

# Numbers in the text of a program: 'number TEXT FILE'.
number() { sed -n "s/^$1 *//p" "$2"; }
emulate() { # emulate TARGET PROGRAM
  local board
  case $1 in
    "$m4f") board=(arm -M mps2-an386) ;;
    "$m0") board=(arm -M mps2-an385) ;; # a Cortex-M3: it runs the code of a Cortex-M0
    "$riscv") board=(riscv32 -M virt -bios none) ;;
  esac
  timeout 300 "qemu-system-${board[0]}" "${board[@]:1}" -nographic -monitor none -serial none \
    -semihosting-config enable=on,target=native -icount shift=0 -kernel "$(image "$1" "$2")" </dev/null
}
code_size() { size -A "$1" | awk '$1 == ".text" || $1 == ".rodata" || $1 == ".data" || $1 == ".vector_table" { sum += $2 } END { print sum }'; }
row() { # row PROGRAM TARGET PROCESSOR: a row of the table, from what the program printed there
  local ran="$work/$2"
  local name="\`$1\`"
  [ $profile = release ] || name+=", \`--profile $profile\`"
  echo "| $name | $3 | $(code_size "$(image "$2" "$1")") B | $(number 'bytes of static memory' "$ran") B | $(number 'bytes of stack' "$ran") B |" \
    "$(number 'clocks a step in flight' "$ran") | $(number 'clocks a step in contact' "$ran") | $(number 'clocks, longest step' "$ran") |"
}

page=examples/embedded/README.md table="$work/table"
{
  echo "| program | processor | code and constants | static memory | stack | instructions a step: flight | contact | at most |"
  echo "|---|---|---|---|---|---|---|---|"
} | tee "$table"
for line in "${programs[@]}"; do
  read -r program code_limit stack_limit profile <<<"$line"
  if [[ $program == *_f32 ]]; then
    found=$(doubles "$(image $m4f "$program")")
    [ -z "$found" ] || fail "$program computes in double precision: $found"
  fi
  "$CARGO_TARGET_DIR/release/$program" >"$work/host"
  [ "$(grep -c . "$work/host")" = 13 ] || fail "$program prints $(grep -c . "$work/host") lines here"
  for target in $m4f $m0 $riscv; do
    found=$(panics "$(image $target "$program")")
    [ -z "$found" ] || fail "$program for $target can panic: $found"
    emulate $target "$program" >"$work/$target"
    head -n 13 "$work/$target" | diff "$work/host" - || fail "$program has other bits for $target"
  done
  { row "$program" $m4f 'Cortex-M4F' && row "$program" $riscv 'RV32IMAC'; } | tee -a "$table"
  code=$(code_size "$(image $m4f "$program")") stack=$(number 'bytes of stack' "$work/$m4f")
  [ "$code" -le "$code_limit" ] || fail "$program: more than $code_limit bytes of code"
  [ "$stack" -le "$stack_limit" ] || fail "$program: more than $stack_limit bytes of stack"
done
profile=release
echo "the same bits on this machine, as ARMv7E-M with floating-point unit, as ARMv6-M, and as RV32IMAC"

between_marks() { sed -n "/<!-- $1: begin/,/<!-- $1: end/p" "$page" | grep "^$2"; } # between_marks NAME START_OF_LINES
write() { # write NAME START_OF_LINES FILE
  sed -i -e "/<!-- $1: begin/,/<!-- $1: end/{/^$2/d}" -e "/<!-- $1: begin/{n;r $3
}" "$page"
}
# The folder of a build decides the order of its functions, and so the padding between them: some bytes of code. All other numbers are the same everywhere.
same_table() { # same_table STORED NOW
  awk -F'|' -v padding=32 '
    function others() { return $2 $3 $5 $6 $7 $8 $9 }
    NR == FNR { code[FNR] = $4; stored[FNR] = others(); next }
    { more = $4 - code[FNR]; if (more > padding || -more > padding || others() != stored[FNR]) differs = 1 }
    END { exit differs || NR != 2 * FNR }' "$1" "$2"
}
compiler="Compiler: $("$RUSTC" --version)."
if [ "${1:-}" = --write ]; then
  write cost '|' "$table"
  echo "$compiler" >"$work/compiler"
  write compiler Compiler "$work/compiler"
elif ! between_marks compiler Compiler | grep -qxF "$compiler"; then
  echo "NOT CHECKED: firmware: the table of $page is of another compiler than this one, $compiler"
elif ! same_table <(between_marks cost '|') "$table"; then
  diff <(between_marks cost '|') "$table" || true
  fail "firmware: $page has another table (< stored, > now); .ci/embedded.sh --write stores this one"
fi

# A million steps take the emulator a minute, and this machine two seconds.
found=$(panics "$(image $m4f many_tosses_f32)")$(doubles "$(image $m4f many_tosses_f32)")
[ -z "$found" ] || fail "many_tosses_f32 can panic or computes in double precision: $found"
"$CARGO_TARGET_DIR/release/many_tosses_f32" >"$work/host"
if [ "${1:-}" = --write ]; then
  emulate $m4f many_tosses_f32 >"$work/$m4f"
  cmp "$work/host" <(grep -vE '^(clocks|bytes)' "$work/$m4f") || fail "a million steps have other bits for $m4f"
  awk '/^steps/ { start = NR } { lines[NR] = $0 } END { for (i = start; i <= NR; i++) print "    " lines[i] }' "$work/$m4f" >"$work/lines"
  write tosses ' ' "$work/lines"
else
  cmp <(tail -n 5 "$work/host") <(between_marks tosses ' ' | head -n 5 | sed 's/^    //') || fail "a million steps have other bits than in $page"
fi

# The checks themselves are checked.
build -Zbuild-std=core --bin symplectic_euler_f32 --features control --target=$m4f
elf=$(image $m4f symplectic_euler_f32)
[ -n "$(panics "$elf")" ] || fail "the control panics by design, and this check did not see it"
[ -n "$(doubles "$elf")" ] || fail "the control computes in f64 by design, and this check did not see it"
