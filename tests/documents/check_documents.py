#!/usr/bin/env python3
"""Checks that every relative link of a document leads to an existing file and, if the link names a heading, to that heading.

Prints one line per fault and exits with 1.
"""
import re
import sys
import urllib.parse

from documents import ROOT, documents, text_of


def anchor(heading):
    """GitHub's anchor of a heading."""
    text = re.sub(r"[`*]|\[([^\]]*)\]\([^)]*\)", lambda m: m[1] or "", heading).strip().lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def without_code(text):
    return re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)


def wrong_links(name):
    path = ROOT / name
    for target in re.findall(r"\]\(([^)\s]+)\)", without_code(text_of(name))):
        if re.match(r"[a-z]+:", target):
            continue
        place, _, fragment = target.partition("#")
        to = (path.parent / urllib.parse.unquote(place)).resolve() if place else path
        if not to.exists():
            yield f"{name}: link to {target}: no such file"
        elif fragment and to.suffix == ".md":
            headings = re.findall(r"^#+ (.*)", without_code(to.read_text(encoding="utf-8")), flags=re.M)
            if fragment not in map(anchor, headings):
                yield f"{name}: link to {target}: no such heading"


def main():
    names = documents()
    faults = [fault for name in names for fault in wrong_links(name)]
    if len(names) < 20:
        faults.append(f"{len(names)} documents found; expected at least 20")
    print("\n".join(faults) or f"{len(names)} documents: every link leads somewhere")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
