#!/usr/bin/env python3
"""The tables of the peers' studies, in Markdown.

    scripts/peers_tables.py FOLDER [--check] DOCUMENT…

Fills the DOCUMENTs between marks such as <!-- peers hang begin --> and <!-- peers hang end -->; --check only compares. FOLDER
holds the reports of the peers' studies, as results/reference/gpu does:

hang: CPU time of a frame [ms] and greatest stretch of the last second [%], medians over the sheets of peers-hang,
with the lowest and the highest in brackets.

margins: for each solver and scene of peers-margins the greatest length of the contour along which the cloth
passes through colliders [m], the greatest depth [mm] and the share of vertices that went through [%], by the distance [mm] at
which the solver holds the cloth.
"""
import argparse
import csv
import json
import pathlib
import statistics
import sys


def number(text):
    return float(text) if text not in ("", None) else float("nan")


def rows_of(path):
    with open(path, encoding="utf-8", newline="") as f:
        return list(csv.DictReader(f))


def label(row):
    return row["solver"] if row["setting"] in ("", "default") else f"{row['solver']} {row['setting']}"


def distinct(values):
    return list(dict.fromkeys(values))


def markdown(head, rows):
    lines = [head, *rows]
    text = ["| " + " | ".join(row) + " |" for row in lines]
    return "\n".join([text[0], "|---|" + "--:|" * (len(head) - 1), *text[1:]])


def spread(values):
    texts = [f"{v:.0f}" if v >= 100 else f"{v:.2g}" for v in (statistics.median(values), min(values), max(values))]
    return texts[0] if len(values) == 1 else f"{texts[0]} ({texts[1]}–{texts[2]})"


def hang(folder):
    rows = [r for r in rows_of(folder / SOURCES["hang"]) if r["status"] == "ok"]
    sizes = sorted({int(r["grid_x"]) for r in rows})
    leading = lambda setting: float(setting.split()[0]) if setting[:1].isdigit() else 0  # "300 Hz" before "1200 Hz"
    order = sorted(distinct((r["solver"], r["setting"]) for r in rows), key=lambda k: (k[0], leading(k[1])))
    out = []
    for solver, setting in order:
        cells = [label({"solver": solver, "setting": setting})]
        for n in sizes:
            mine = [r for r in rows if (r["solver"], r["setting"]) == (solver, setting) and int(r["grid_x"]) == n]
            times = [1e3 * number(r["frame_cpu_median_s"]) for r in mine]
            stretch = [100 * number(r["stretch_max_last_second"]) for r in mine]
            cells += [spread(v) if v and not any(x != x for x in v) else "–" for v in (times, stretch)]
        out.append(cells)
    return markdown(["solver"] + [f"{n}²: {what}" for n in sizes for what in ("ms", "stretch %")], out)


def margins(folder):
    rows = json.loads((folder / SOURCES["margins"]).read_text(encoding="utf-8"))["runs"]
    scenes = distinct(r["scene"] for r in rows)
    out = []
    for name in sorted(distinct(label(r) for r in rows)):
        mine = {r["scene"]: r for r in rows if label(r) == name}
        held = sorted({round(1e3 * r["held_at_most_m"], 3) for r in mine.values() if r["held_at_most_m"] is not None})
        cells = [name, ", ".join(f"{h:g}" for h in held) + " mm"]
        for scene in scenes:
            r = mine.get(scene)
            if r is None or r["status"] != "ok":
                cells.append("–" if r is None else r["status"])
                continue
            values = ((r["contact_length_max_m"], 1, " m"), (r["depth_max_m"], 1e3, " mm"), (r["tunnelled_fraction_max"], 100, " %"))
            cells.append(", ".join("–" if v is None else f"{factor * v:.2g}{unit}" for v, factor, unit in values))
        out.append(cells)
    return markdown(["solver", "holds at", *scenes], out)


# What each table is made of, below FOLDER.
SOURCES = {"hang": "peers-hang/runs.csv", "margins": "peers-margins/penetration.json"}
TABLES = {"hang": hang, "margins": margins}


def filled(text, folder):
    for name, make in TABLES.items():
        begin, end = f"<!-- peers {name} begin -->\n", f"<!-- peers {name} end -->"
        if begin in text and (folder / SOURCES[name]).exists():
            before, rest = text.split(begin, 1)
            text = before + begin + "\n" + make(folder) + "\n\n" + end + rest.split(end, 1)[1]
    return text


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("folder", type=pathlib.Path)
    arguments.add_argument("document", nargs="+", type=pathlib.Path)
    arguments.add_argument("--check", action="store_true", help="write nothing; exit 1 if a document would change")
    a = arguments.parse_args()
    stale = []
    for document in a.document:
        before = document.read_text(encoding="utf-8")
        after = filled(before, a.folder)
        if after == before:
            continue
        stale.append(str(document))
        if not a.check:
            document.write_text(after, encoding="utf-8")
    if a.check and stale:
        sys.exit(f"not what {a.folder} has: {', '.join(stale)} (scripts/peers_tables.py {a.folder} {' '.join(stale)})")


if __name__ == "__main__":
    main()
