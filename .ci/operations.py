"""Counts the instructions that two programs execute in a step, by kind, and compares them.

    operations.py WITH WITHOUT STEPS MORE_STEPS < ROWS

A row names an integrator, a phase and a scene, the arguments of both programs; the number of steps
follows as the last argument. A step is the difference of two runs with different numbers of steps.
Callgrind counts how often each instruction is executed, objdump says what it is.

Printed are all instructions, and those that the compiler does not add or leave out at will:
conditional jumps, divisions and square roots. Fails where one of these kinds is more frequent with
the first program by more than 0.02 in a step, or where all instructions together are more by both
0.5 % and 8 in a step. The rest is moves between registers, and arithmetic in one lane or in two.
"""

import collections
import os
import re
import subprocess
import sys
import tempfile

KINDS = {
    "conditional jumps": re.compile(r"j(?!mp)"),
    "divisions": re.compile(r"v?(div|idiv|sqrt)"),
}
# Below it, a difference comes from the start of the program.
LEAST = 0.02
# Percent of all instructions. Below it they differ by 0 %, to a whole number.
TOLERANCE = 0.5
# Instructions. So few moves between registers are the compiler's, however cheap the step is.
MOVES = 8


def opcodes(program):
    """The opcode at each address of a program."""
    text = subprocess.run(
        ["objdump", "-d", "--no-show-raw-insn", program], capture_output=True, text=True, check=True
    ).stdout
    found = re.finditer(r"^\s*([0-9a-f]+):\s+(\S+)", text, re.MULTILINE)
    return {int(match[1], 16): match[2] for match in found}


def executed(program, opcode_at, arguments):
    """How often each opcode of the program itself is executed, libraries left out."""
    with tempfile.TemporaryDirectory() as folder:
        counts = os.path.join(folder, "counts")
        callgrind = ["valgrind", "--tool=callgrind", "--dump-instr=yes", f"--callgrind-out-file={counts}"]
        subprocess.run([*callgrind, program, *arguments], capture_output=True, check=True)
        with open(counts) as lines:
            return counted(lines, program, opcode_at)


def counted(lines, program, opcode_at):
    """Reads the costs of callgrind's format: `ADDRESS LINE COUNT`, addresses also as differences.

    Sums them by what `opcode_at` has for an address.
    """
    total, objects = collections.Counter(), {}
    address, is_callee, is_own = 0, False, False
    for line in lines:
        if name := re.match(r"(c?ob)=\((\d+)\)(?: (.*))?$", line):
            objects.setdefault(name[2], name[3])
            if name[1] == "ob":
                is_own = objects[name[2]] == program
        elif line.startswith("calls="):
            is_callee = True
        elif cost := re.match(r"(0x[0-9a-f]+|[+-]\d+|\*) \S+ (\d+)", line):
            place = cost[1]
            if place != "*":
                address = int(place, 16) if place.startswith("0x") else address + int(place)
            # The line after `calls=` has the cost of what is called, which is counted there.
            if is_own and not is_callee:
                total[opcode_at.get(address, "?")] += int(cost[2])
            is_callee = False
    return total


def step(program, opcode_at, scene, few, many):
    """The instructions of one step: all, and by kind."""
    fewer, more = (executed(program, opcode_at, [*scene, str(steps)]) for steps in (few, many))
    more.subtract(fewer)
    steps = many - few
    kinds = [sum(n for name, n in more.items() if kind.match(name)) / steps for kind in KINDS.values()]
    return [sum(more.values()) / steps, *kinds]


def main():
    programs, (few, many) = sys.argv[1:3], map(int, sys.argv[3:5])
    tables = [opcodes(program) for program in programs]
    dearer = 0
    for row in sys.stdin:
        scene = row.split()
        first, second = (
            step(program, table, scene, few, many) for program, table in zip(programs, tables)
        )
        change = 100 * (first[0] - second[0]) / second[0]
        kinds = [
            f"{name} {a:.2f} and {b:.2f}" for name, a, b in zip(KINDS, first[1:], second[1:])
        ]
        print(
            f"{scene[0]:16} {scene[1]:9} {scene[2]:>5} {first[0]:7.0f} with the parts,"
            f" {second[0]:7.0f} without, {change:+5.1f} %; {'; '.join(kinds)}",
            flush=True,
        )
        asks = any(a > b + LEAST for a, b in zip(first[1:], second[1:]))
        dearer += asks or (change > TOLERANCE and first[0] - second[0] > MOVES)
    print(f"{dearer} rows pay for parts that the scene does not name")
    sys.exit(dearer > 0)


if __name__ == "__main__":
    main()
