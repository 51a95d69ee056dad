"""Calls each example with arguments and files that a stranger might give: a help text, or one line that says what is wrong, and never a panic.

From anywhere:  python3 .ci/arguments.py FOLDER_OF_THE_PROGRAMS
"""

import gzip
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib

TOP = pathlib.Path(__file__).resolve().parent.parent
PROGRAMS = pathlib.Path(sys.argv[1]).resolve()
# Options whose value is a path: any text is valid.
PATHS = {"--out", "--data", "--readme-picture"}
NOT_VALUES = ["", "x", "nan", "1e400", b"\xff"]
# Numbers with which a program would not end in a lifetime, or only by exhausting the machine, has nothing to measure, or compares other tables;
# and a folder without a name.
BEYOND = {
    "coin": [["--duration", "1e19"], ["--step", "1e-300"], ["--points", "10000000000"], ["--all", "--duration", "1e19"]],
    "choose_accuracy": [
        ["--seconds", "1e19"], ["--points", "10000000000"], ["--stiffness", "1e19"], ["--slip-speed", "1e-300"],
        ["--error", "1e19"], ["--error", "0"],
    ],
    "known_outcomes": [["--percent", "10000000000"]],
    "tennis": [["--friction", "1e19"], ["--restitution", "1e19"]],
    "tosses": [
        ["--to", "10000000000000000000"], ["--to", "2000000", "--part", "1"], ["--threads", "10000000000"], ["--cost", "--to", "0"],
        ["--out", ""],
    ],
}
# Options that contradict each other, or without one that they need. The message names each of the last entry.
CLASHES = {
    "choose_accuracy": [
        (["--scene", "smooth", "--slip-speed", "0.01"], ["--slip-speed"]),
        (["--smooth", "--scene", "smooth"], ["--smooth"]),
    ],
    "coin": [
        (["--all", "--trial", "3"], ["--all", "--trial"]),
        (["--all", "--readme-picture", "x.svg"], ["--all", "--readme-picture"]),
    ],
    "heads_or_tails": [
        (["--quick", "--full"], ["--quick", "--full"]),
        (["--quick", "--write"], ["--quick", "--write"]),
        (["--full", "--write"], ["--full", "--write"]),
    ],
    "known_outcomes": [
        (["--check", "--write"], ["--check", "--write"]),
        (["--quick", "--percent", "50"], ["--quick", "--percent"]),
        (["--check", "--percent", "50"], ["--check", "--percent"]),
    ],
    "measured_tosses": [
        (["--synthetic", "--data", "x.csv"], ["--synthetic", "--data"]),
        (["--synthetic", "--write"], ["--synthetic", "--write"]),
        (["--quick", "--write"], ["--quick", "--write"]),
    ],
    "tosses": [
        (["--merge", "--cost"], ["--merge", "--cost"]),
        (["--toss", "3", "--efficiency"], ["--toss", "--efficiency"]),
        (["--write"], ["--write", "--cost"]),
        (["--write", "--label-error"], ["--write", "--cost"]),
    ],
}
COLUMNS = "toss,sample,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz\n"
TABLES = {
    "empty.csv": b"",
    "zeros.csv": bytes(1000),
    "heading.csv": COLUMNS.encode(),
    "other_heading.csv": b"a,b\n1,2\n",
    "no_number.csv": (COLUMNS + "1," * 14 + "x\n").encode(),
    "not_finite.csv": (COLUMNS + "1,0," + "nan," * 12 + "nan\n" + "1,1," + "nan," * 12 + "nan\n").encode(),
    "zero_quaternion.csv": (COLUMNS + "1,0," + "0," * 12 + "0\n").encode(),
    "gap.csv": (COLUMNS + "1,7," + "1," * 12 + "1\n").encode(),
    "short_row.csv": (COLUMNS + "1,1,0\n").encode(),
    "cut.csv.gz": gzip.compress(COLUMNS.encode() * 100)[:40],
    "not.csv.gz": b"\x1f\x8b" + bytes(50),
}
PARTS = {
    "empty": b"",
    "no JSON": b"\xff\xfe{",
    "another type": b"[1, 2]",
    "nothing in it": b"{}",
    "deep": b"[" * 100_000,
}
calls = 0


def call(name, arguments, folder):
    """Returns exit code, output and errors of a program that is called in a folder."""
    global calls
    calls += 1
    command = [PROGRAMS / name, *arguments]
    end = subprocess.run(command, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, timeout=120)
    output, errors = (text.decode(errors="replace") for text in (end.stdout, end.stderr))
    assert "panicked" not in errors and end.returncode in (0, 1, 2), f"{command}: {end.returncode}: {errors}"
    return end.returncode, output, errors


def refuses(name, arguments, folder, code, named=""):
    """A program says what is wrong, with the name of the file, and prints nothing else."""
    found, output, errors = call(name, arguments, folder)
    shown = f"{name} {arguments}: {found}: {output}{errors}"
    assert found == code and errors.startswith("error: ") and not output, shown
    assert (code != 2 or "--help" in errors) and named in errors, shown


def usage(name, folder):
    help_text = call(name, ["--help"], folder)
    assert help_text[0] == 0 and not help_text[2], f"{name} --help: {help_text}"
    assert f"Usage: cargo run --release --example {name} -- " in help_text[1], f"{name} --help: {help_text}"
    assert call(name, ["-h"], folder) == help_text, f"{name} -h"
    return help_text[1]


def command_line(name, folder):
    options = re.findall(r"^ .*?(--[a-z0-9-]+) (?:<[^>]+>|[A-Z][A-Z/]*)(?=[\s\]])", usage(name, folder), re.M)
    assert "--out" in options, f"{name}: its help has no --out"
    for arguments in ["--there-is-no-such-option"], ["stray"], [b"\xff"]:
        refuses(name, arguments, folder, 2)
    for option in options:
        before = ["--page"] if name == "accuracy" else []
        refuses(name, [*before, option], folder, 2)
        for value in NOT_VALUES if option not in PATHS else []:
            refuses(name, [*before, option, value], folder, 2)


def beyond(name, folder):
    """A number without end is refused before the work, with the option and its bound."""
    for arguments in BEYOND.get(name, []):
        refuses(name, arguments, folder, 2)
        errors = call(name, arguments, folder)[2]
        option = arguments[-2].lstrip("-")
        assert option in errors and " must be " in errors and ", got " in errors, f"{name} {arguments}: {errors}"


def clashes(name, folder):
    """An option that would have no effect is refused, with the names of both."""
    for arguments, named in CLASHES.get(name, []):
        refuses(name, arguments, folder, 2)
        errors = call(name, arguments, folder)[2]
        assert all(option in errors for option in named), f"{name} {arguments}: {errors}"


def closed_pipe(name, arguments, folder):
    """Nobody reads what a program prints: no panic."""
    global calls
    calls += 1
    reading, writing = os.pipe()
    os.close(reading)
    end = subprocess.run([PROGRAMS / name, *arguments], cwd=folder, stdout=writing, stderr=subprocess.PIPE, timeout=120)
    os.close(writing)
    assert b"panicked" not in end.stderr and end.returncode in (0, 1), f"{name} {arguments}: {end.returncode}: {end.stderr}"
    return end.returncode


def no_folder(name, folder):
    """A folder that cannot be made is an error. That it is found before the work is not tested: a fast program could do both."""
    (folder / "file").write_text("")
    before = {"accuracy": ["--page"], "measured_tosses": ["--synthetic"]}.get(name, [])
    refuses(name, [*before, "--out", folder / "file" / "out"], folder, 1)


def broken_files(folder):
    for name, content in TABLES.items():
        (folder / name).write_bytes(content)
        refuses("measured_tosses", ["--quick", "--data", name], folder, 1, name)
    refuses("measured_tosses", ["--data", "missing.csv"], folder, 1, "missing.csv")
    refuses("measured_tosses", ["--data", "."], folder, 1, "cannot read .: ")
    for content in PARTS.values():
        (folder / "parts").mkdir(exist_ok=True)
        (folder / "parts" / "1.part.json").write_bytes(content)
        refuses("tosses", ["--merge", "--out", "parts"], folder, 1, "parts/1.part.json")
        # Tosses that are played do not need the broken file: it is renamed, and the output names it.
        code, output, errors = call("tosses", ["--to", "10", "--out", "parts"], folder)
        assert code == 0 and "1.part.json.broken" in output, f"tosses over {content[:20]}: {code}: {output}{errors}"
    refuses("tosses", ["--merge", "--out", "missing"], folder, 1, "missing")
    # A folder has the name of a file that is to be written.
    for task, file in ([], "result.json"), (["--toss", "3"], "path.csv"), (["--toss", "3"], "play.html"):
        out = f"taken_{file}"
        (folder / out / file).mkdir(parents=True)
        code, _, errors = call("tosses", [*task, "--to", "10", "--out", out], folder)
        assert code == 1 and f"cannot write {out}/{file}: " in errors, f"tosses {task}: {code}: {errors}"


manifest = tomllib.loads((TOP / "examples/Cargo.toml").read_text())
names = [example["name"] for example in manifest["example"]]
for name in names:
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        command_line(name, folder)
        beyond(name, folder)
        clashes(name, folder)
        closed_pipe(name, ["--help"], folder)
        no_folder(name, folder)
        assert [path.name for path in folder.iterdir()] == ["file"], f"{name} has written files"
with tempfile.TemporaryDirectory() as temporary:
    broken_files(pathlib.Path(temporary))
    # The run goes on to its page.
    assert closed_pipe("slide_to_roll", ["--quick", "--out", "page"], temporary) == 0
    assert (pathlib.Path(temporary) / "page/slide_to_roll/slide_to_roll.html").exists()
print(f"{len(names)} examples: {calls} calls with wrong arguments and broken files, each with its message")
