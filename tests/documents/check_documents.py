#!/usr/bin/env python3
"""Checks the documents: the README is short, no document is long, every relative link leads to a file and to a heading of it.

Prints one line a fault and exits with 1.
"""
import re
import sys
import urllib.parse
from pathlib import Path

from documents import GENERATED, ROOT, documents

MOST_README_LINES, MOST_README_BYTES = 180, 14_000
MOST_BYTES = 16_000
# Known, and to become shorter: a file leaves this list when it fits, and none is added.
TOO_LONG = set()


def anchor(heading):
    """GitHub's anchor of a heading."""
    text = re.sub(r"[`*]|\[([^\]]*)\]\([^)]*\)", lambda m: m[1] or "", heading).strip().lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def without_code(text):
    return re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)


def wrong_links(path, text):
    for target in re.findall(r"\]\(([^)\s]+)\)", without_code(text)):
        if re.match(r"[a-z]+:", target):
            continue
        place, _, fragment = target.partition("#")
        to = (path.parent / urllib.parse.unquote(place)).resolve() if place else path
        if not to.exists():
            yield f"{path.relative_to(ROOT)}: link to {target}: no such file"
            continue
        if fragment and to.suffix == ".md":
            headings = re.findall(r"^#+ (.*)", without_code(to.read_text(encoding="utf-8")), flags=re.M)
            if fragment not in map(anchor, headings):
                yield f"{path.relative_to(ROOT)}: link to {target}: no such heading"


def main():
    faults = []
    checked = 0
    for name in documents():
        path = ROOT / name
        text = path.read_text(encoding="utf-8")
        checked += 1
        # A published report is the text of one, without all of its figures.
        if not GENERATED.match(name):
            faults += wrong_links(path, text)
        size = len(text.encode())
        if name == "README.md" and not (len(text.splitlines()) <= MOST_README_LINES and size <= MOST_README_BYTES):
            faults.append(f"README.md: {len(text.splitlines())} lines, {size} bytes; at most {MOST_README_LINES} and {MOST_README_BYTES}")
        if GENERATED.match(name):
            continue
        if size > MOST_BYTES and name not in TOO_LONG:
            faults.append(f"{name}: {size} bytes; at most {MOST_BYTES}")
        if size <= MOST_BYTES and name in TOO_LONG:
            faults.append(f"{name} fits now: take it off TOO_LONG in {Path(__file__).name}")
    if checked < 20:
        faults.append(f"{checked} documents found; there are more")
    print("\n".join(faults) if faults else f"{checked} documents: sizes and links as they should be")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
