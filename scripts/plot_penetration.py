#!/usr/bin/env python3
"""Penetration over time, one figure a set-up, from a report's penetration-series.csv.

usage: plot_penetration.py PENETRATION-SERIES.csv
Writes penetration-<set-up> as SVG and PNG beside the CSV: a row of panels a scene, a line a solver; reads nothing but
that file.
"""
import csv
import math
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator  # noqa: E402

from plot_report import COLOURS, FAILED, FLOOR, SPARE, STYLE, gid, number, save  # noqa: E402

# Column of the CSV: what the axis says, factor to its unit.
QUANTITIES = {"contact_length_m": ("contour [mm]", 1e3), "tunnelled_fraction": ("tunnelled [%]", 100),
              "tunnelled_depth_m": ("tunnelled [mm]", 1e3), "depth_m": ("depth [mm]", 1e3),
              "stretch_max": ("strain [%]", 100)}
# What tells solvers apart, by set-up; a column that no cell has is left out.
SHOWN = {"rooms": ["contact_length_m", "tunnelled_fraction", "tunnelled_depth_m"], "hand": ["contact_length_m", "tunnelled_fraction", "depth_m"],
         "capsules": ["contact_length_m", "depth_m"], "shapes": ["contact_length_m", "depth_m"], "grip": ["stretch_max"],
         "wave": ["stretch_max"]}
DEEP, DEEP_MM = {"tunnelled_depth_m", "depth_m"}, 50  # from here on their axis is logarithmic above 1 mm
DASHES = ["-", (0, (5, 1.5)), (0, (2, 1.2)), (0, (5, 1.5, 1, 1.5)), (0, (1, 1))]
MORE_COLOURS = {"bullet-deformable": "#E69F00", "paper whole-room": "#CC79A7"}


def name_of(row):
    name = row["solver"] if row["setting"] in ("", "default") else f"{row['solver']} {row['setting']}"
    return name if row["repeat"] in ("", "1") else f"{name} ({row['repeat']})"


def tree(rows):
    """{set-up: {scene: {solver and setting: [row by time]}}}, in the order of the file. The control that nothing stops
    is left out: beside its fall the others would be lines at 0."""
    out = {}
    rows = list(rows)
    alone = all(r["solver"] == FLOOR for r in rows)
    for row in rows:
        if row["solver"] == FLOOR and not alone:
            continue
        out.setdefault(row["set_up"], {}).setdefault(row["scene"], {}).setdefault(name_of(row), []).append(row)
    return out


def styles(names):
    """A colour and a dash for each, the same in every figure: lines that lie on one another stay visible."""
    known = COLOURS | MORE_COLOURS
    spare = [c for c in SPARE if c not in MORE_COLOURS.values()]
    return {n: {"color": known[n] if n in known else spare.pop(0) if spare else "#777777",
                "linestyle": DASHES[k % len(DASHES)], "linewidth": 1.3} for k, n in enumerate(sorted(names))}


def draw(ax, cells, column, look):
    """One panel. Returns the solvers that have a line or a cross in it."""
    title, scale = QUANTITIES[column]
    drawn = set()
    # Whole lines below dashed ones, so that equal ones show both colours.
    for name, rows in sorted(cells.items(), key=lambda item: (look[item[0]]["linestyle"] != "-", item[0])):
        points = [(number(r["time_s"]), scale * number(r[column])) for r in rows]
        good = [(t, v) for t, v in points if math.isfinite(v)]
        if good:
            ax.plot(*zip(*good), **look[name], gid=gid("series", column, rows[0]["scene"], name))
            drawn.add(name)
        if rows[0]["status"] in FAILED:
            ax.plot([points[-1][0]], [0.04], "x", color=look[name]["color"], markersize=5, clip_on=False,
                    transform=ax.get_xaxis_transform(), gid=gid("failed", column, rows[0]["scene"], name))
            drawn.add(name)
    ax.set_ylabel(title)
    ax.set_xlim(left=0)
    if column in DEEP and any(max(line.get_ydata()) > DEEP_MM for line in ax.lines):
        # What fell through goes on falling: metres beside millimetres. Linear up to the 1 mm that scenes allow.
        ax.set_yscale("symlog", linthresh=1)
        ax.set_ylim(bottom=-0.15)
        ax.yaxis.set_major_locator(FixedLocator([0, 1, 10, 100, 1000, 10000, 100000]))
        ax.yaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
        ax.minorticks_off()
        ax.grid(True, linewidth=0.4, alpha=0.5)
        return drawn
    top = ax.get_ylim()[1] if ax.lines else 0
    top = top if top > 1e-3 else 1  # nothing but zeros
    ax.set_ylim(-0.04 * top, top)  # a line at 0 must be told from the axis
    ax.yaxis.set_major_locator(MaxNLocator(4))
    ax.grid(True, linewidth=0.4, alpha=0.5)
    return drawn


def figure(kind, scenes, look, path):
    def has(column):
        return any(math.isfinite(number(r[column])) for cells in scenes.values() for rows in cells.values() for r in rows)

    columns = [c for c in SHOWN.get(kind, list(QUANTITIES)) if has(c)]
    if not columns:
        fig, ax = plt.subplots(figsize=(3.5, 1.2))
        ax.set_axis_off()
        ax.text(0.5, 0.5, "No cell of this set-up was measured.", ha="center", va="center")
        save(fig, path)
        return
    # Scenes with one column share a row of panels.
    across = len(columns) if len(columns) > 1 else min(3, len(scenes))
    down = len(scenes) if len(columns) > 1 else math.ceil(len(scenes) / across)
    fig, panels = plt.subplots(down, across, figsize=(2.45 * across + 0.2, 1.5 * down + 0.5), squeeze=False, layout="constrained")
    spots = list(panels.flat)
    drawn = set()
    for k, (scene, cells) in enumerate(scenes.items()):
        for c, column in enumerate(columns):
            ax = spots[k * len(columns) + c]
            drawn |= draw(ax, cells, column, look)
            if c == 0:
                ax.set_title(scene, loc="left", fontsize=8, fontweight="bold")
    for ax in spots[len(scenes) * len(columns):]:
        ax.set_axis_off()
    for ax in spots[max(0, len(scenes) * len(columns) - across):len(scenes) * len(columns)]:
        ax.set_xlabel("time [s]")
    entries = [Line2D([], [], **look[n], label=n) for n in sorted(drawn)]
    failed = {n for cells in scenes.values() for n, rows in cells.items() if rows[0]["status"] in FAILED}
    if failed:
        entries.append(Line2D([], [], color="0.2", marker="x", markersize=5, linestyle="none", label="failed"))
    if entries:  # below the figure; saving makes room for it
        fig.legend(handles=entries, loc="upper center", bbox_to_anchor=(0.5, 0), ncols=min(5, len(entries)), frameon=False, handlelength=3)
    save(fig, path)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    source = pathlib.Path(sys.argv[1])
    with source.open(newline="", encoding="utf-8") as f:
        by_kind = tree(csv.DictReader(f))
    look = styles({n for scenes in by_kind.values() for cells in scenes.values() for n in cells})
    with plt.rc_context(STYLE):
        for kind, scenes in by_kind.items():
            figure(kind, scenes, look, source.parent / f"penetration-{kind}")


if __name__ == "__main__":
    main()
