#!/usr/bin/env python3
"""Writes the short Table 3 of README.md from the published reports: frames per second, GPU time and stretch by resolution.

usage: update_readme.py [--check]     --check: write nothing; fail if the README would change
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
REFERENCE = ROOT / "results/reference/gpu"
SPEED = REFERENCE / "table3/report.md"
STRETCH = REFERENCE / "hang/report.md"
# Rows of the reports: solver and sides, as printed there.
SOLVERS = [("bullet-soft", "single"), ("paper", "single"), ("paper", "double-duplicated"), ("xpbd", "single")]
PUBLISHED = ["published: Unity Cloth", "published: PBD single-sided", "published: PBD double-sided"]


def table(report, title):
    """Rows of the table whose heading begins with `title`: {(solver, sides): {resolution: run}}."""
    for part in re.split(r"^### ", report.read_text(encoding="utf-8"), flags=re.M)[1:]:
        if part.startswith(title):
            rows = [[c.strip() for c in line.strip("| ").split("|")] for line in part.splitlines() if line.startswith("|")]
            return rows[0][2:], {(r[0], r[1]): dict(zip(rows[0][2:], r[2:])) for r in rows[2:]}
    sys.exit(f"{report}: no table \"{title}\"")


def short_table():
    resolutions, capped = table(SPEED, "Table 3")
    _, free = table(SPEED, "Frames per second, uncapped")
    _, gpu = table(SPEED, "GPU time a frame [ms]")
    _, stretch = table(STRETCH, "Stretch of structural edges in the last second, mean / greatest [%] (hang)")

    def row(name, what, run):
        return f"| {name} | {what} | " + " | ".join(run(r) for r in resolutions) + " |"

    lines = [row("solver", "", str), "|---|---|" + "--:|" * len(resolutions)]
    for name in PUBLISHED:
        runs = next(runs for (solver, _), runs in capped.items() if solver == name)
        lines.append(row(name, "FPS, capped at 72", runs.get))
    for solver, sides in SOLVERS:
        name = f"`{solver}`" + (", doubled layer" if sides == "double-duplicated" else "")
        key = (solver, sides)
        lines.append(row(name, "FPS, capped at 72", capped[key].get))
        lines.append(row("", "FPS, uncapped", lambda r: free[key][r].split(" ±")[0]))
        if any(c != "–" for c in gpu[key].values()):
            lines.append(row("", "GPU time [ms]", gpu[key].get))
        hung = stretch.get(key, {})
        if hung:
            lines.append(row("", "mean stretch when hung [%]", lambda r: hung.get(r, "–").split(" /")[0]))
    head = SPEED.read_text(encoding="utf-8")
    device = next(line for line in head.splitlines() if line.startswith("GPU "))
    place, stretched = (f.parent.relative_to(ROOT).as_posix() for f in (SPEED, STRETCH))
    return "\n".join([
        f"Measured: {device} ([all tables]({place}/report.md), [stretch]({stretched}/report.md)).", "", *lines, "",
        "Published: Quest 3, with rendering, rounded to whole frames. Ours: without rendering, median of the trials. `bullet-soft` "
        "is not in the study of hanging sheets."])


def main():
    arguments = sys.argv[1:]
    if arguments not in ([], ["--check"]):
        sys.exit(__doc__)
    readme = ROOT / "README.md"
    before = readme.read_text(encoding="utf-8")
    new = short_table()
    text, count = re.subn(r"(<!-- table3 begin -->\n).*?(<!-- table3 end -->)", lambda m: m[1] + new + "\n" + m[2], before, flags=re.S)
    if count != 1:
        sys.exit("README.md: expected one pair of table3 markers")
    if not arguments:
        readme.write_text(text, encoding="utf-8")
    elif text != before:
        sys.exit("README.md: not as scripts/update_readme.py makes it")


if __name__ == "__main__":
    main()
