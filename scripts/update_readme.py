#!/usr/bin/env python3
"""Puts the tables of a committed reference report into README.md, between its two table3 markers.

usage: update_readme.py results/reference/<folder>
"""
import pathlib
import re
import sys

WANTED = ("Table 3", "Frames per second, uncapped", "GPU time", "Free-fall error")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    report = (folder / "report.md").read_text(encoding="utf-8")
    head, *tables = re.split(r"^### ", report, flags=re.M)
    device = next(line for line in head.splitlines() if line.startswith("GPU "))
    chosen = ["### " + t.strip() for t in tables if t.startswith(WANTED)]
    text = "\n\n".join([f"Measured: {device} ([whole report]({folder.as_posix()}/report.md)).", *chosen,
                        f"![Frames per second by resolution]({folder.as_posix()}/fig4.png)"])
    readme = pathlib.Path(__file__).resolve().parent.parent / "README.md"
    old = readme.read_text(encoding="utf-8")
    new, count = re.subn(r"(<!-- table3 begin -->\n).*?(<!-- table3 end -->)", lambda m: m[1] + text + "\n" + m[2], old, flags=re.S)
    if count != 1:
        sys.exit("README.md: expected one pair of table3 markers")
    readme.write_text(new, encoding="utf-8")


if __name__ == "__main__":
    main()
