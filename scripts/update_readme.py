#!/usr/bin/env python3
"""Puts tables of a committed reference report into README.md, between the markers of each part the report has. Of sweeps over speeds
the README shows where each solver leaks first; their rows are in the report. No other row is left out: what must not be printed
is "–" there as in the report, with the reason. With --check nothing is written, and it fails if the README is not so already.

usage: update_readme.py [--check] results/reference/<folder>
"""
import pathlib
import re
import sys

# Part of the README: titles of the tables it shows, figure below them (file, words), table it must have and one it must not.
PARTS = {
    "table3": (("Table 3", "Frames per second, uncapped", "GPU time", "Free-fall error"), ("fig4.png", "Frames per second by resolution"), "Table 3", None),
    "penetration": (("Speed of the first leak", "A strip pulled", "Penetration:", "Cloth on meshes", "A hand", "Hands hold", "Cloth on plain shapes", "SubMesh"),
                    ("penetration-rooms.png", "Penetration over time"), "SubMesh", None),
    "sweeps": (("Speed of the first leak",), ("penetration-capsules.png", "A hand of capsules sweeps through the cloth, at 0.1 to 20 m/s"), "Speed of the first leak", "SubMesh"),
    "table4": (("Table 4",), None, "SubMesh", None),
}


SWEPT = re.compile(r"^\| (?:[\w-]+-at-[\dp]+|[\w-]+-turned|(?:desk|open|capsule|self)[\w-]*mps) \|.*\n", re.M)


def main():
    check = sys.argv[1:2] == ["--check"]
    if len(sys.argv) != 2 + check:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[-1])
    report = (folder / "report.md").read_text(encoding="utf-8")
    head, *tables = re.split(r"^### ", report, flags=re.M)
    device = next((line for line in head.splitlines() if line.startswith("GPU ")), "no GPU")
    readme = pathlib.Path(__file__).resolve().parent.parent / "README.md"
    before = text = readme.read_text(encoding="utf-8")
    done = []
    for part, (wanted, figure, needed, other) in PARTS.items():
        if not any(t.startswith(needed) for t in tables) or other and any(t.startswith(other) for t in tables):
            continue
        lines = [f"Measured: {device} ([whole report]({folder.as_posix()}/report.md))."]
        for table in (t for t in tables if t.startswith(wanted)):
            table = SWEPT.sub("", table)
            # The sweeps' one table stands under a sentence of the README, not under a second heading of the same name.
            lines.append(table.split("\n", 1)[1].strip() if part == "sweeps" else "### " + table.strip())
        if figure and (folder / figure[0]).exists():
            lines.append(f"![{figure[1]}]({folder.as_posix()}/{figure[0]})")
        new = "\n\n".join(lines)
        text, count = re.subn(rf"(<!-- {part} begin -->\n).*?(<!-- {part} end -->)", lambda m: m[1] + new + "\n" + m[2], text, flags=re.S)
        if count != 1:
            sys.exit(f"README.md: expected one pair of {part} markers")
        done.append(part)
    if not done:
        sys.exit(f"{folder}/report.md: none of the tables that the README shows")
    if check and text != before:
        sys.exit(f"README.md: {', '.join(done)}: not as scripts/update_readme.py {folder} makes it")
    if not check:
        readme.write_text(text, encoding="utf-8")
    print("README.md: " + ", ".join(done))


if __name__ == "__main__":
    main()
