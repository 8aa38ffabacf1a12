#!/usr/bin/env python3
"""The tables of the peers' studies, in Markdown.

    scripts/peers_tables.py FOLDER [--check] DOCUMENT…

Fills the DOCUMENTs between marks such as <!-- peers hang begin --> and <!-- peers hang end -->; --check only compares. FOLDER
holds what it reads, results/reference/h200 (or results/reference/peers, with the names in brackets):

hang (hang.csv): CPU time of a frame [ms] and greatest stretch of the last second [%], medians over the sheets of peers-hang,
with the lowest and the highest in brackets.

margins (margins.json): for each solver and scene of peers-margins the greatest length of the contour along which the cloth
passes through colliders [m], the greatest depth [mm] and the share of vertices that went through [%], by the distance [mm] at
which the solver holds the cloth.

contact (contact.csv): scenes of `study contact` that a solver passes, of those drawn, by kind; kinds that it does not support.
Where contact.csv has no `bullet-soft`, its row is that of the same scenes in contact-h200, beside FOLDER, and the distance at
which it holds the cloth is that of penetration.json.

stability (stability.csv): runs of `study stability --short` by grade, and the classes of those that failed.
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
    rows = [r for r in rows_of(source(folder, "hang")) if r["status"] == "ok"]
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
    rows = json.loads(source(folder, "margins").read_text(encoding="utf-8"))["runs"]
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


def contact(folder):
    rows = [r for r in rows_of(source(folder, "contact")) if r["speed_m_per_s"] == "all"]
    elsewhere = folder.parent / "contact-h200" / "contact-runs.csv"
    if "bullet-soft" not in {r["solver"] for r in rows} and (folder / "contact-runs.csv").exists() and elsewhere.exists():
        seeds = {r["scene"] for r in rows_of(folder / "contact-runs.csv")}
        held = [r["held_at_most_m"] for r in json.loads((folder / "penetration.json").read_text(encoding="utf-8"))["runs"]
                if label(r) == "bullet-soft" and r["held_at_most_m"] is not None]
        bullet = [r for r in rows_of(elsewhere) if r["solver"] == "bullet-soft" and r["scene"] in seeds]
        for kind in ["all", *distinct(r["kind"] for r in rows if r["kind"] != "all")]:
            drawn = [r for r in bullet if kind == "all" or r["scene"].split("-", 2)[2] == kind]
            rows.append({"solver": "bullet-soft (contact-h200)", "setting": "default", "kind": kind, "held_at_mm": f"{1e3 * max(held):g}",
                         "drawn": str(len(drawn)), "passed": str(sum(r["expect"] == "pass" for r in drawn)),
                         "unsupported": str(sum(r["status"] == "unsupported" for r in drawn))})
    kinds = distinct(r["kind"] for r in rows)
    out = []
    for name in sorted(distinct(label(r) for r in rows)):
        mine = {r["kind"]: r for r in rows if label(r) == name}
        held = next((r["held_at_mm"] for r in mine.values() if r["held_at_mm"]), "–")
        cell = lambda r: "–" if r["unsupported"] == r["drawn"] else f"{r['passed']}/{r['drawn']}"
        out.append([name, held, *(cell(mine[k]) if k in mine else "–" for k in kinds)])
    return markdown(["solver", "holds at [mm]", *kinds], out)


def stability(folder):
    rows = rows_of(source(folder, "stability"))
    grades = ("stable", "degraded", "failed")
    out = []
    for name in sorted(distinct(label(r) for r in rows)):
        mine = [r for r in rows if label(r) == name]
        unsupported = sum(r["status"] == "unsupported" for r in mine)
        why = [r["class"] for r in mine if r["grade"] == "failed"]
        classes = ", ".join(f"{c} {why.count(c)}" for c in sorted(set(why))) or "–"
        out.append([name, str(len(mine)), *(str(sum(r["grade"] == g for r in mine)) for g in grades), classes, str(unsupported)])
    return markdown(["solver", "runs", *grades, "classes of failed", "unsupported"], out)


# A table's file in results/reference/h200, and in results/reference/peers.
SOURCES = {"hang": ("peers-hang/runs.csv", "hang.csv"), "margins": ("peers-margins/penetration.json", "margins.json"),
           "contact": ("contact/contact-rates.csv", "contact.csv"), "stability": ("peers-stability/stability.csv", "stability.csv")}


def source(folder, name):
    return next((folder / f for f in SOURCES[name] if (folder / f).exists()), folder / SOURCES[name][0])


TABLES = {"hang": hang, "margins": margins, "contact": contact, "stability": stability}


def filled(text, folder):
    for name, make in TABLES.items():
        begin, end = f"<!-- peers {name} begin -->\n", f"<!-- peers {name} end -->"
        if begin in text and source(folder, name).exists():
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
