#!/usr/bin/env python3
"""Page of the crate in a registry, made from the README: no picture or link of the repository, which would break there.

.ci/registry_page.py            fails if the stored page differs from the README
.ci/registry_page.py --update   writes it
"""

import pathlib
import re
import sys

README = pathlib.Path("README.md")
PAGE = pathlib.Path("assets/registry.md")
# What only a clone has, with the words that stand in its place elsewhere.
CLONE = re.compile(r"<!-- clone only; elsewhere: (.*?) -->\n.*?<!-- clone only, to here -->\n", re.DOTALL)
MARKER = re.compile(r"<!-- .*?(?:begin|end).*? -->\n\n?")
# A row of a table that leads to a program or a page of the repository.
ROW = re.compile(r"^\|.*\]\((?:examples/|CONTRIBUTING).*\n", re.MULTILINE)
LINK = re.compile(r"\[([^\]]*)\]\((?!https?://|#)([^)]*)\)")


def in_documentation(link):
    """A relative link as one into the documentation, which has the guide, or as its text alone."""
    text, target = link.groups()
    guide = re.fullmatch(r"src/guide/(.*)\.md", target)
    return f"[{text}](https://docs.rs/tumble/latest/tumble/guide/{guide[1]}/)" if guide else text


def page(readme):
    text = CLONE.sub(lambda part: f"{part[1]}\n\n", readme)
    text = LINK.sub(in_documentation, ROW.sub("", MARKER.sub("", text)))
    return re.sub(r"\n{3,}", "\n\n", text)


def main():
    wanted = page(README.read_text())
    broken = re.findall(r"!\[[^\]]*\]\((?!https?://)[^)]*\)", wanted) + LINK.findall(wanted)
    if broken:
        sys.exit(f"{PAGE} would have what a registry cannot show: {broken}")
    if sys.argv[1:] == ["--update"]:
        PAGE.write_text(wanted)
    elif sys.argv[1:]:
        sys.exit(__doc__)
    elif not PAGE.exists() or PAGE.read_text() != wanted:
        sys.exit(f"{PAGE} is not the README's: run .ci/registry_page.py --update")


main()
