#!/usr/bin/env python3
"""The arithmetic that the formulas of a step need, beside the instructions that are executed.

    .ci/floors.py             counts, and compares with benches/floors.txt and the page
    .ci/floors.py --update    stores what it counts, and writes the tables of src/guide/modelling.md

The operations of the formulas are those of `benches/floors`, which takes each step of the library
again and compares both ends. They depend on no compiler and must be the stored ones. The executed
instructions are counted by callgrind, as a difference of two runs with different numbers of steps,
and read by objdump. Each is of one kind, and by addr2line of one stage. With the compiler that the
file names, a count may differ from the stored one by 3 % of all instructions of its row. With
another one the executed instructions are `NOT CHECKED`.
"""

import collections
import concurrent.futures
import hashlib
import json
import os
import re
import subprocess
import sys
import tempfile

import operations

FEW, MANY = 100, 600
TOLERANCE = 0.03
STORED, PAGE = "benches/floors.txt", "src/guide/modelling.md"
METHODS = ["ForwardEuler", "SymplecticEuler", "StrangSplitting", "Rk4", "Nystrom", "EnergyMomentum"]
SCENES = {
    ("flight", "120"): "in flight",
    ("upright", "120"): "it rolls, 3 to 6 of 120 points touch",
    ("tumbling", "120"): "it tumbles, 5 to 7 of 120 points touch",
    ("upright", "12"): "it rolls on 12 points",
    ("upright", "1200"): "it rolls on 1200 points",
}
ROWS = [(method, phase, "120") for method in METHODS for phase in ("flight", "upright", "tumbling")]
ROWS += [
    (method, "upright", points)
    for method in ("SymplecticEuler", "Rk4", "EnergyMomentum")
    for points in ("12", "1200")
]
# Kinds of instructions, the first that matches. All others move numbers that are no addresses.
PACKED = re.compile(r"(add|sub|mul|div|sqrt|min|max|cmp\w*)p[sd]$")
KINDS = {
    "arithmetic": re.compile(r"(add|sub|mul|div|sqrt|min|max|u?comi|cmp\w*)[sp][sd]$"),
    "moves": re.compile(r"mov|unpck|shuf|pshuf|and\w*p[sd]$|x?orp[sd]$|pxor|pand|por|push|pop|rep"),
    "branches": re.compile(r"j|call|ret"),
    "integers": re.compile(r""),
}
# Stages by the source files and functions that an instruction was inlined from, the first that
# matches any of them.
STAGES = {
    "energies": r"/src/(energy|integrator/(energy_limit|flight_rounding)|contact/spring_energy)\.rs"
    r"|/energy_momentum\.rs .*check_energy",
    "search": r"/src/(body(/\w+)?|contact/range)\.rs|/energy_momentum\.rs .*(gather|near_plane)"
    r"|/contacts\.rs .*(gather|thin_out|evenly_spaced|includes|clear)",
    "forces": r"/src/(contact|ground|friction)/|/src/(ground|friction)\.rs|/contact_path\.rs"
    r"|/energy_momentum/(touch|answer|dual|lever)\.rs|/nystrom/crossing\.rs|/newton\.rs .*Sum<|/contacts\.rs .*respond",
    "matrix": r"/energy_momentum/(stiffness|level)\.rs|/integrator/linear\.rs",
    "rotation": r"/src/(rotation|inertia|free_rotation/\w+)\.rs",
    "tests": r"/state\.rs .*(::eq|not_finite)|/end_velocity\.rs .*(of_step|is_resolved)"
    r"|/newton\.rs .*(::norm|Scale<|::is_|::has_|loads_agree|size_of_motion|remember|choose_unknowns)",
    "method": r"/src/integrator/(?!energy_momentum\.rs)|/energy_momentum\.rs .*::(fly|whole)",
    "rest": r"",
}
# In the order of a step.
SHOWN = ["search", "forces", "matrix", "rotation", "method", "tests", "energies", "rest"]
FORMULAS = ["formulas", "sums", "products", "divisions", "roots", "comparisons"]
WORK = ["iterations", "evaluations"]
EXECUTED = ["operations", *KINDS, "all"]
OF_STAGES = [f"{stage}{suffix}" for stage in STAGES for suffix in ("", "-arithmetic")]
COLUMNS = FORMULAS + WORK + EXECUTED + OF_STAGES


class Itself:
    """In the place of a table of opcodes: counts by address."""

    @staticmethod
    def get(address, _):
        return address


def built(bench):
    """The program of a bench, with the lines of the source in the code of the library."""
    command = ["cargo", "bench", "--quiet", "--bench", bench, "--no-run", "--message-format=json"]
    command += ["--config", "profile.bench.package.tumble.debug=1"]
    text = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
    messages = [json.loads(line) for line in text.splitlines()]
    found = [m["executable"] for m in messages if m.get("target", {}).get("name") == bench]
    return [program for program in found if program][-1]


def counts_of(program, arguments):
    """How often each address of the program is executed, and all instructions, libraries too."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "counts")
        callgrind = ["valgrind", "--tool=callgrind", "--dump-instr=yes"]
        command = [*callgrind, f"--callgrind-out-file={out}", program, *arguments]
        subprocess.run(command, capture_output=True, check=True)
        with open(out) as file:
            lines = file.readlines()
    own = operations.counted(lines, program, Itself)
    everything = next(int(line.split()[1]) for line in lines if line.startswith("summary:"))
    hand_over(program, arguments, everything)
    return own, everything


def hand_over(program, arguments, everything):
    """Stores a count for .ci/instructions, which needs some of the same program.

    The name is the hash of the program, so that a count is never that of another one.
    """
    target = os.environ.get("CARGO_TARGET_DIR", "target")
    with open(program, "rb") as file:
        name = hashlib.sha256(file.read()).hexdigest()
    folder = os.path.join(target, "instructions", name)
    os.makedirs(folder, exist_ok=True)
    path = os.path.join(folder, "-".join(arguments))
    with open(f"{path}.new", "w") as file:
        file.write(f"{everything}\n")
    os.replace(f"{path}.new", path)


def chains(program, addresses):
    """Files and functions that each address comes from, with those it was inlined into."""
    text = subprocess.run(
        ["addr2line", "-e", program, "-i", "-f", "-a", "-C"],
        input="\n".join(map(hex, addresses)),
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    found = {}
    for block in re.split(r"^(?=0x)", text, flags=re.MULTILINE):
        lines = block.split("\n")
        if lines[0]:
            pairs = zip(lines[1::2], lines[2::2])
            frames = [f"{place.split(':')[0]} {name}" for name, place in pairs]
            found[int(lines[0], 16)] = "\n".join(frames)
    return found


def first_match(patterns, text, match):
    return next(name for name, pattern in patterns.items() if match(pattern, text))


def profile(program, row):
    """How often each address is executed in MANY - FEW steps, and all instructions of them."""
    # Side by side: a count does not depend on what else runs.
    with concurrent.futures.ThreadPoolExecutor() as pool:
        runs = pool.map(lambda steps: counts_of(program, [*row, str(steps)]), (FEW, MANY))
        (fewer, less), (own, everything) = runs
    own.subtract(fewer)
    return {address: count for address, count in own.items() if count}, everything - less


def executed(own, everything, opcode_at, where):
    """The executed instructions of a step: by kind, and by stage."""
    sums = collections.Counter()
    for address, count in own.items():
        opcode = opcode_at.get(address, "?")
        kind = first_match(KINDS, opcode, re.match)
        stage = first_match(STAGES, where[address], re.search)
        sums[kind] += count
        sums[stage] += count
        if kind == "arithmetic":
            sums[f"{stage}-arithmetic"] += count
            sums["operations"] += 2 * count if PACKED.match(opcode) else count
    # A library of the system copies memory.
    copies = everything - sum(own.values())
    sums["all"] = everything
    sums["moves"] += copies
    sums["rest"] += copies
    return {name: round(sums[name] / (MANY - FEW)) for name in EXECUTED + OF_STAGES}


def counted():
    """All rows, counted now."""
    formulas, program = built("floors"), built("instructions")
    opcode_at = operations.opcodes(program)
    profiles = {row: profile(program, row) for row in ROWS}
    # Once for all rows: reading the lines of the source takes longer than finding an address.
    where = chains(program, sorted({address for own, _ in profiles.values() for address in own}))
    table = {}
    for row in ROWS:
        arguments = [formulas, *row, str(FEW), str(MANY)]
        text = subprocess.run(arguments, stdout=subprocess.PIPE, text=True, check=True).stdout
        table[row] = dict(zip(FORMULAS + WORK, map(number, text.split())))
        table[row].update(executed(*profiles[row], opcode_at, where))
    return table


def number(text):
    return float(text) if "." in text else int(text)


def compiler():
    return subprocess.run(["rustc", "--version"], capture_output=True, text=True).stdout.strip()


def stored():
    with open(STORED) as file:
        version, header, *lines = file.read().splitlines()
    assert header.split()[3:] == COLUMNS, f"{STORED} has other columns: .ci/floors.py --update"
    cells = [line.split() for line in lines]
    return version, {tuple(c[:3]): dict(zip(COLUMNS, map(number, c[3:]))) for c in cells}


def store(table):
    rows = [("method", "phase", "points", *COLUMNS)]
    rows += [(*row, *(str(counts[name]) for name in COLUMNS)) for row, counts in table.items()]
    widths = [max(map(len, column)) for column in zip(*rows)]
    lines = ["  ".join(f"{cell:<{w}}" for cell, w in zip(row, widths)).rstrip() for row in rows]
    with open(STORED, "w") as file:
        file.write("\n".join([compiler(), *lines, ""]))


def by_kind(table):
    """The table of the formulas, and of the executed instructions by kind."""
    yield "| method | the coin | evaluations | formulas | operations | arithmetic | moves"
    yield " | addresses | branches | all | ratio |\n|" + "---|" * 11 + "\n"
    for (method, *scene), counts in table.items():
        cells = [counts[name] for name in ("formulas", "operations", *EXECUTED[1:3])]
        cells.insert(0, f"{counts['evaluations']:.1f}")
        cells += [counts[name] for name in ("integers", "branches", "all")]
        ratio = counts["all"] / counts["formulas"]
        yield f"| `{method}` | {SCENES[tuple(scene)]} | {' | '.join(map(str, cells))}"
        yield f" | {ratio:.1f} |\n"


def by_stage(table):
    """The table of the executed instructions by stage, and of the arithmetic among them."""
    yield f"| method | the coin | {' | '.join(SHOWN)} |\n"
    yield "|" + "---|" * 10 + "\n"
    for (method, *scene), counts in table.items():
        cells = [f"{counts[stage]}, {counts[f'{stage}-arithmetic']}" for stage in SHOWN]
        yield f"| `{method}` | {SCENES[tuple(scene)]} | {' | '.join(cells)} |\n"


def with_tables(table):
    """The page with both tables in the place of the old ones."""
    with open(PAGE) as file:
        page = file.read()
    for name, lines in (("floors", by_kind(table)), ("stages", by_stage(table))):
        pattern = rf"(<!-- {name}: begin[^\n]*\n).*?(<!-- {name}: end)"
        text = "".join(lines)
        page, count = re.subn(pattern, lambda m: f"{m[1]}\n{text}\n{m[2]}", page, flags=re.DOTALL)
        assert count == 1, f"{PAGE} has no marks for {name}"
    return page


def compare(table):
    """Returns what has changed since the counts were stored."""
    version, before = stored()
    if list(before) != list(table):
        return ["not the set that is stored"]
    same = version == compiler()
    if not same:
        print(f"NOT CHECKED: floors: executed instructions are stored for {version}, and not compared")
    changed = []
    for row, now in table.items():
        then = before[row]
        for name in COLUMNS:
            is_exact = name in FORMULAS + WORK
            allowed = 0 if is_exact else TOLERANCE * then["all"]
            is_compared = same or is_exact
            if is_compared and abs(now[name] - then[name]) > allowed:
                changed.append(f"{' '.join(row)}: {name} {then[name]}, now {now[name]}")
        print(f"{' '.join(row):32} {now['formulas']:6} by the formulas, {now['all']:6} executed")
    return changed


def main():
    os.chdir(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    if sys.argv[1:] == ["--update"]:
        table = counted()
        store(table)
        page = with_tables(table)
        with open(PAGE, "w") as file:
            file.write(page)
        return
    with open(PAGE) as file:
        if file.read() != with_tables(stored()[1]):
            sys.exit(f"{PAGE} has other counts than {STORED}:  .ci/floors.py --update")
    changed = compare(counted())
    if changed:
        print(*changed, "To store these:  .ci/floors.py --update", sep="\n")
        sys.exit(1)


main()
