#!/usr/bin/env python3
"""Work-precision diagrams from a report's work-precision.csv.

usage: plot_work_precision.py WORK-PRECISION.csv
Writes work-precision-<scene>.svg and .png beside the CSV: error against wall time (frames pipelined where a solver can), both logarithmic. All points thin, the
front of each solver (nothing faster and more accurate) thick; the same front over the device's own clock dashed; cells
without an error as crosses in the upper margin; the floors, shaded below the higher one: there solvers are not told apart.
Solvers whose stiffness is no parameter, where the scene depends on it, pale and dotted: they are not ranked.
"""
import csv
import math
import pathlib
import sys
import textwrap

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402
from matplotlib.patches import Patch  # noqa: E402

# Okabe & Ito's palette, readable with every common colour blindness; as in plot_report.py.
COLOURS = {"paper": "#D55E00", "xpbd": "#0072B2", "bullet-soft": "#009E73", "bullet-deformable": "#CC79A7",
           "reference": "#000000"}
SPARE = ["#E69F00", "#56B4E9", "#F0E442"]
MARKERS = {"paper": "s", "xpbd": "o", "bullet-soft": "^", "bullet-deformable": "v", "reference": "D"}
STYLE = {"font.size": 8, "axes.labelsize": 9, "legend.fontsize": 7.5, "svg.fonttype": "none",
         "svg.hashsalt": "clothbench", "axes.spines.top": False, "axes.spines.right": False, "axes.axisbelow": True}
REAL_TIME = 1000  # ms per simulated second
UNSUPPORTED = {"unsupported", "missing"}
NOT_RUN = "over_budget"  # of more work than the solver's time on the scene allowed


def number(text):
    try:
        value = float(text)
    except (TypeError, ValueError):
        return math.nan
    return value if math.isfinite(value) else math.nan  # "inf" has no place on an axis


def colours(names):
    spare = list(SPARE)
    return {n: COLOURS[n] if n in COLOURS else spare.pop(0) if spare else "#777777" for n in names}


def drawn(row):
    return row["status"] == "ok" and number(row["error"]) > 0 and number(row["wall_ms_per_s"]) > 0


def front(points):
    """Those of (time, error) with nothing faster and more accurate, by time."""
    out = []
    for t, e in sorted(points):
        if not out or e < out[-1][1]:
            out.append((t, e))
    return out


def draw(scene, rows, path):
    fig, ax = plt.subplots(figsize=(5.2, 3.6))
    ax.set_xscale("log")
    ax.set_yscale("log")
    palette = colours(sorted({r["solver"] for r in rows}))
    entries, absent = [], []
    for name, colour in palette.items():
        mine = [r for r in rows if r["solver"] == name]
        good = [r for r in mine if drawn(r)]
        if all(r["status"] in UNSUPPORTED for r in mine):
            absent.append(name)
            continue
        marker = MARKERS.get(name, "P")
        ax.plot([number(r["wall_ms_per_s"]) for r in good], [number(r["error"]) for r in good], marker, color=colour,
                markersize=3, markerfacecolor="none", markeredgewidth=0.5, alpha=0.6, gid=f"points-{name}")
        unranked = any(r.get("not_ranked") for r in mine)
        line = front([(number(r["wall_ms_per_s"]), number(r["error"])) for r in good])
        ax.plot(*zip(*line) if line else ([], []), marker, linestyle=":" if unranked else "-", color=colour, linewidth=1.8, markersize=4,
                alpha=0.35 if unranked else 1.0, gid=f"front-{name}")
        device = front([(number(r["device_ms_per_s"]), number(r["error"])) for r in good if number(r["device_ms_per_s"]) > 0])
        if device:
            ax.plot(*zip(*device), linestyle="--", color=colour, linewidth=1.0, gid=f"device-{name}")
        bad = [r for r in mine if not drawn(r) and r["status"] not in UNSUPPORTED | {NOT_RUN}]
        skipped = sum(r["status"] == NOT_RUN for r in mine)
        times = [number(r["wall_ms_per_s"]) for r in bad]
        if bad:  # a cell that never got to be timed stands at the right edge
            known = [t for t in times if t > 0]
            ax.plot(known, [1.0] * len(known), "x", color=colour, markersize=4, transform=ax.get_xaxis_transform(),
                    clip_on=False, gid=f"failed-{name}")
            if len(known) < len(bad):
                ax.plot([1.0], [1.0], "x", color=colour, markersize=4, transform=ax.transAxes, clip_on=False,
                        gid=f"failed-untimed-{name}")
        label = name + (f" ({len(bad)} of {len(mine)} failed)" if bad else "") + (f" ({skipped} of {len(mine)} not run)" if skipped else "") + (" – not ranked" if unranked else "")
        entries.append(Line2D([], [], color=colour, marker=marker, linestyle=":" if unranked else "-", linewidth=1.8, markersize=4, label=label))
    first = rows[0]
    for key, style, label in (("space_error", ":", "error of the mesh"), ("floor", "-.", "3 × reference's uncertainty")):
        value = number(first[key])
        low, high = ax.get_ylim()
        if value > 0 and value > 1e-3 * low:
            ax.axhline(value, color="0.4", linewidth=0.9, linestyle=style, zorder=0, gid=key)
            entries.append(Line2D([], [], color="0.4", linewidth=0.9, linestyle=style, label=f"{label} {value:.1e}"))
        elif value > 0:
            entries.append(Line2D([], [], linestyle="none", label=f"{label} {value:.1e}: below"))
    floors = [number(first[key]) for key in ("space_error", "floor") if number(first[key]) > 0]
    if floors and max(floors) > ax.get_ylim()[0]:
        low, high = ax.get_ylim()
        ax.set_ylim(low, max(high, 1.2 * max(floors)))  # the shade must not add a margin of its own
        ax.axhspan(low, max(floors), color="0.92", zorder=-1, linewidth=0, gid="not-told-apart")
        entries.append(Patch(color="0.92", label=f"not told apart: ≤ {max(floors):.1e}"))
    ax.axvline(REAL_TIME, color="0.7", linewidth=0.9, zorder=0, gid="real-time")
    entries.append(Line2D([], [], color="0.7", linewidth=0.9, label="real time"))
    if any(number(r["device_ms_per_s"]) > 0 for r in rows):
        entries.append(Line2D([], [], color="0.3", linewidth=1.0, linestyle="--", label="GPU's own clock (dashed)"))
    ax.grid(True, which="major", linewidth=0.4, alpha=0.5)
    ax.set_xlabel("wall time, frames pipelined where a solver can [ms per simulated second]", fontsize=8)
    ax.set_ylabel(f"error\n({first['ranking']})", fontsize=8)
    gpus = sorted({r["gpu"] + (" (software: no speed claims)" if r["gpu_is_software"] == "true" else "") for r in rows
                   if r["on_gpu"] == "true"})
    title = scene + (f" – REFUSED: {first['refused']}" if first["refused"] else "")
    ax.set_title(title, fontsize=8, loc="left", pad=10)
    note = "; ".join(gpus + ([f"unsupported: {', '.join(absent)}"] if absent else []))
    ax.legend(handles=entries, loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False, borderaxespad=0)
    ax.text(0, -0.2, textwrap.fill(note, 100), transform=ax.transAxes, fontsize=6.5, color="0.35", va="top")
    fig.savefig(path.with_suffix(".svg"), bbox_inches="tight", metadata={"Date": None})
    fig.savefig(path.with_suffix(".png"), bbox_inches="tight", dpi=160)
    plt.close(fig)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    source = pathlib.Path(sys.argv[1])
    scenes = {}
    with source.open(newline="", encoding="utf-8") as f:
        for row in csv.DictReader(f):
            scenes.setdefault(row["scene"], []).append(row)
    with plt.rc_context(STYLE):
        for scene, rows in scenes.items():
            draw(scene, rows, source.parent / f"work-precision-{scene}")


if __name__ == "__main__":
    main()
