"""Reads each file under a folder as what its name says it is: a table, a picture, a drawing, a page that needs nothing else."""

import csv
import math
import pathlib
import re
import sys
import xml.etree.ElementTree as xml


def table(path):
    with path.open(newline="") as file:
        header, *rows = csv.reader(file)
    assert len(rows) >= 10, f"only {len(rows)} rows"
    for number, row in enumerate(rows, 2):
        assert len(row) == len(header), f"line {number}: {len(row)} cells under {len(header)} headings"
        for cell in row:
            assert not is_number(cell) or math.isfinite(float(cell)), f"line {number}: {cell}"
    return f"{len(rows)} rows of {len(header)}"


def is_number(cell):
    try:
        float(cell)
    except ValueError:
        return False
    return True


def picture(path):
    data = path.read_bytes()
    assert data.startswith(b"\x89PNG\r\n\x1a\n") and data[12:16] == b"IHDR", "not a PNG"
    assert data[-8:-4] == b"IEND", "cut short"
    width, height = (int.from_bytes(data[i : i + 4], "big") for i in (16, 20))
    assert width >= 300 and height >= 200, f"{width} x {height} is too small to read"
    return f"{width} x {height}"


def drawing(path):
    root = xml.parse(path).getroot()
    assert root.tag == "{http://www.w3.org/2000/svg}svg", f"root is {root.tag}"
    shapes = sum(1 for _ in root.iter()) - 1
    assert shapes >= 10, f"only {shapes} elements"
    return f"{shapes} elements"


def page(path):
    text = path.read_text(encoding="utf-8")
    assert re.match(r"\s*<!doctype html>", text, re.IGNORECASE), "no doctype"
    assert "</html>" in text, "cut short"
    for reference in re.findall(r"""(?:\bsrc|\bhref|\baction)\s*=\s*["']?([^"'\s>]+)|url\(\s*["']?([^"')]+)|@import\s+["']?([^"';]+)""", text):
        target = "".join(reference)
        beside = path.parent / target.split("#")[0]
        assert target.startswith(("#", "data:")) or beside.exists(), f"refers to {target}"
    for call in ("fetch(", "XMLHttpRequest", "WebSocket(", "importScripts("):
        assert call not in text, f"calls {call}"
    return f"{len(text)} characters"


READERS = {".csv": table, ".png": picture, ".svg": drawing, ".html": page}


def main(folder):
    seen = set()
    for path in sorted(p for p in pathlib.Path(folder).rglob("*") if p.is_file()):
        reader = READERS.get(path.suffix)
        if reader is None:
            continue
        try:
            found = reader(path)
        except Exception as error:
            sys.exit(f"{path.name}: {error}")
        print(f"{path.relative_to(folder)}: {found}")
        seen.add(path.suffix)
    if missing := READERS.keys() - seen:
        sys.exit(f"the example wrote no {', '.join(sorted(missing))}")


main(sys.argv[1])
