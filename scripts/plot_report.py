#!/usr/bin/env python3
"""Figures of the frame-rate study from a report's cells.csv.

usage: plot_report.py CELLS.csv PAPER-TABLE3.json
Writes fig4 (frames per second by resolution) and fig5 (bandwidth by resolution) as SVG and PNG beside the CSV.
"""
import csv
import json
import math
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

# Okabe & Ito's palette, readable with every common colour blindness.
COLOURS = {"paper": "#D55E00", "paper readback=blocking": "#E69F00", "xpbd": "#0072B2", "bullet-soft": "#009E73",
           "ballistic": "#000000"}
SPARE = ["#CC79A7", "#56B4E9", "#F0E442"]
MARKERS = {"single": "o", "double-duplicated": "s", "double": "^"}
LINES = {"single": "-", "double-duplicated": "--", "double": ":"}
STYLE = {"font.size": 8, "axes.labelsize": 9, "legend.fontsize": 7, "figure.dpi": 100, "svg.fonttype": "none",
         "axes.spines.top": False, "axes.spines.right": False}


def number(text):
    try:
        return float(text)
    except ValueError:
        return math.nan


def series(rows):
    """{(solver and setting, sides): [row by resolution]} of the cells that ended well."""
    out = {}
    for row in rows:
        if row["status"] != "ok":
            continue
        name = row["solver"] if row["setting"] == "default" else f"{row['solver']} {row['setting']}"
        out.setdefault((name, row["sides"]), []).append(row)
    for cells in out.values():
        cells.sort(key=lambda r: int(r["resolution"]))
    return dict(sorted(out.items()))


def colour(name, spare):
    if name not in COLOURS:
        COLOURS[name] = spare.pop(0) if spare else "#777777"
    return COLOURS[name]


def finish(fig, ax, ylabel, sizes, path, legend_title=None):
    ax.set_xscale("log", base=2)
    ax.set_yscale("log")
    ax.set_xticks(sizes, [f"{n}²" for n in sizes])
    ax.set_xlabel("cloth resolution [vertices]")
    ax.set_ylabel(ylabel)
    ax.grid(True, which="major", linewidth=0.4, alpha=0.5)
    ax.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, title=legend_title)
    for suffix in ("svg", "png"):
        fig.savefig(path.with_suffix("." + suffix), bbox_inches="tight", dpi=200)
    plt.close(fig)


def fps_figure(rows, published, path):
    fig, ax = plt.subplots(figsize=(4.6, 3.2))
    spare, sizes = list(SPARE), sorted({int(r["resolution"]) for r in rows})
    for column in published["columns"]:
        ax.plot(published["resolution"], column["fps"], color="0.6", linewidth=0.8, marker=MARKERS.get(column.get("sides"), "x"),
                markersize=3.5, label="published: " + column["name"], zorder=1)
    ax.axhline(published["display_cap_hz"], color="0.3", linewidth=0.6, linestyle=(0, (1, 3)))
    for (name, sides), cells in series(rows).items():
        x = [int(r["resolution"]) for r in cells]
        y = [number(r["fps_median"]) for r in cells]
        spread = [number(r["fps_median"]) * number(r["fps_spread"]) for r in cells]
        line = ax.errorbar(x, y, yerr=spread, color=colour(name, spare), marker=MARKERS.get(sides, "D"), linestyle=LINES.get(sides, "-."),
                           markersize=4, linewidth=1.1, capsize=2, elinewidth=0.8, markerfacecolor="white", label=f"{name}, {sides}", zorder=2)
        line[0].set_gid(f"fps {name} {sides}")
    finish(fig, ax, "frames per second, uncapped", sizes, path)


def bandwidth_figure(rows, path):
    fig, ax = plt.subplots(figsize=(4.6, 3.2))
    spare, sizes = list(SPARE), sorted({int(r["resolution"]) for r in rows})
    drawn = 0
    for (name, sides), cells in series(rows).items():
        x = [int(r["resolution"]) for r in cells]
        for key, fill, what in (("bandwidth_read_peak_B_per_s", "white", "read"), ("bandwidth_write_peak_B_per_s", None, "write")):
            y = [1e-9 * number(r[key]) for r in cells]
            if not any(math.isfinite(v) for v in y):
                continue  # a CPU solver: no bytes are counted
            c = colour(name, spare)
            line = ax.plot(x, y, color=c, marker=MARKERS.get(sides, "D"), linestyle=LINES.get(sides, "-."), markersize=4, linewidth=1.0,
                           markerfacecolor=fill or c, label=f"{name}, {sides}, {what}")
            line[0].set_gid(f"bandwidth {name} {sides} {what}")
            drawn += 1
    if drawn:
        finish(fig, ax, "counted bandwidth, peak of 5 s windows [GB/s]", sizes, path)
    else:
        ax.text(0.5, 0.5, "no GPU solver among the cells", ha="center", va="center", transform=ax.transAxes)
        ax.set_axis_off()
        for suffix in ("svg", "png"):
            fig.savefig(path.with_suffix("." + suffix), dpi=200)
        plt.close(fig)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    source = pathlib.Path(sys.argv[1])
    with source.open(newline="", encoding="utf-8") as f:
        rows = [r for r in csv.DictReader(f) if int(r["resolution"]) > 0]
    with open(sys.argv[2], encoding="utf-8") as f:
        published = json.load(f)
    with plt.rc_context(STYLE):
        fps_figure(rows, published, source.parent / "fig4")
        bandwidth_figure(rows, source.parent / "fig5")


if __name__ == "__main__":
    main()
