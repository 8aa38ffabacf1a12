#!/usr/bin/env python3
"""Figures of the frame-rate study from a report's cells.csv.

usage: plot_report.py CELLS.csv PAPER-TABLE3.json
Writes fig4 (frames per second by resolution) and fig5 (bandwidth by resolution) as SVG and PNG beside the CSV. Shown is
the scene of the paper's Table 3, or the first scene where there is none; reads nothing but the two files.
"""
import csv
import json
import math
import pathlib
import re
import sys
import textwrap

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402
from matplotlib.ticker import FuncFormatter, NullLocator  # noqa: E402

# Okabe & Ito's palette, readable with every common colour blindness.
COLOURS = {"paper": "#D55E00", "paper readback=blocking": "#CC79A7", "xpbd": "#0072B2", "bullet-soft": "#009E73",
           "ballistic": "#000000"}
SPARE = ["#E69F00", "#56B4E9", "#F0E442"]
FLOOR = "ballistic"  # not a cloth solver: what the harness itself costs
SIDES = ["single", "double-duplicated", "double"]
MARKERS = {"single": "o", "double-duplicated": "s", "double": "^"}
LINES = {"single": "-", "double-duplicated": "--", "double": ":"}
FAILED = {"not_finite", "diverged", "device_lost", "timed_out", "error"}
STYLE = {"font.size": 8, "axes.labelsize": 9, "legend.fontsize": 7.5, "svg.fonttype": "none",
         # Fixed, so that the same cells give the same file.
         "svg.hashsalt": "clothbench", "axes.spines.top": False, "axes.spines.right": False,
         "axes.axisbelow": True, "legend.handlelength": 2.4}


def number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return math.nan


def width(row):
    """Vertices along one side; of a grid that is no square, the side of the square with as many."""
    return math.sqrt(int(row["grid_x"]) * int(row["grid_y"]))


def series(rows):
    """{(solver and setting, sides): [row by resolution]}"""
    out = {}
    for row in rows:
        name = row["solver"] if row["setting"] in ("", "default") else f"{row['solver']} {row['setting']}"
        if row["repeat"] not in ("", "1"):
            name += f" ({row['repeat']})"
        out.setdefault((name, row["sides"]), []).append(row)
    for cells in out.values():
        cells.sort(key=width)
    return dict(sorted(out.items()))


def colours(names):
    """One colour a solver and setting, the same in every figure."""
    spare = list(SPARE)
    return {n: COLOURS[n] if n in COLOURS else spare.pop(0) if spare else "#777777" for n in names}


def gid(*words):
    return "-".join(re.sub(r"[^A-Za-z0-9]+", "-", w).strip("-") for w in words)


def style(colour, sides):
    return {"color": colour, "marker": MARKERS.get(sides, "D"), "linestyle": LINES.get(sides, "-."), "markersize": 4,
            "linewidth": 1.1, "markerfacecolor": "white"}


def mark_failed(ax, cells, colour, words):
    """Crosses on the lower edge: a cell that failed has no value and must still be seen. True if there are any."""
    x = [width(r) for r in cells if r["status"] in FAILED]
    if x:
        ax.plot(x, [0.03] * len(x), "x", color=colour, markersize=5, transform=ax.get_xaxis_transform(), clip_on=False,
                gid=gid("failed", *words))
    return bool(x)


def room_for_failed(ax):
    """Keeps values off the lower edge, where the crosses are. Returns the entry for the legend."""
    low, high = ax.get_ylim()
    ax.set_ylim(low * (low / high) ** 0.08, high)
    return Line2D([], [], color="0.2", marker="x", markersize=5, linestyle="none", label="failed")


def axes(ax, rows):
    ax.set_xscale("log", base=2)
    ax.set_yscale("log")
    ticks = {width(r): r["resolution"] for r in rows}
    ax.set_xticks(list(ticks), list(ticks.values()))
    ax.xaxis.set_minor_locator(NullLocator())
    ax.yaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:,.0f}" if v >= 1 else f"{v:g}"))
    if not ax.lines or ax.get_ylim()[1] < 100 * ax.get_ylim()[0]:  # under two decades: name more than powers of ten
        ax.yaxis.set_minor_formatter(FuncFormatter(lambda v, _: f"{v:g}" if f"{v:.0e}"[0] in "25" else ""))
        ax.tick_params(axis="y", which="minor", labelsize=7)
    ax.grid(True, which="major", linewidth=0.4, alpha=0.5)


def legend(fig, ax, drawn, palette, extra, text):
    """Below the axes: colour says the solver, marker and dash the sides (fewer entries than one a line); then `text` in
    small print."""
    shown = {s for _, s in drawn}
    entries = [Line2D([], [], color=palette[n], linewidth=2, label=n) for n in sorted({name for name, _ in drawn})]
    order = [s for s in SIDES if s in shown] + sorted(shown - set(SIDES))
    entries += [Line2D([], [], label=s or "–", **style("0.2", s)) for s in order]
    inch = 1 / (ax.get_position().height * fig.get_figheight())  # in heights of the axes
    box = ax.legend(handles=entries + list(extra), loc="upper center", bbox_to_anchor=(0.44, -0.55 * inch), ncol=2,
                    frameon=False, borderaxespad=0, columnspacing=1.2)
    fig.canvas.draw()
    below = box.get_window_extent().transformed(ax.transAxes.inverted())
    ax.text(below.x0, below.y0 - 0.06 * inch, textwrap.fill(text, 78), transform=ax.transAxes, fontsize=6.5, color="0.35",
            va="top")


def where(rows):
    """The device, for a figure that is seen without its report."""
    gpus = sorted({r["gpu"] for r in rows if r["gpu"] not in ("", "CPU")})
    if not gpus:
        return ""
    software = any(r["gpu_is_software"] == "true" for r in rows)
    return ", ".join(gpus) + ("; software, not for speed claims" if software else "")


def save(fig, path):
    fig.savefig(path.with_suffix(".svg"), bbox_inches="tight", metadata={"Date": None})
    fig.savefig(path.with_suffix(".png"), bbox_inches="tight", dpi=200)
    plt.close(fig)


def nothing(path, text):
    fig, ax = plt.subplots(figsize=(3.5, 2.0))
    ax.text(0.5, 0.5, text, ha="center", va="center", transform=ax.transAxes)
    ax.set_axis_off()
    save(fig, path)


def fps_figure(rows, published, is_paper, path):
    fig, ax = plt.subplots(figsize=(3.5, 3.2))
    all_series = series(rows)
    palette = colours(sorted({name for name, _ in all_series}))
    extra, cap = [], published["display_cap_hz"]
    if is_paper:
        for column in published["columns"]:
            line, = ax.plot(published["resolution"], column["fps"], color="0.55", linewidth=0.8, zorder=1,
                            marker=MARKERS.get(column.get("sides"), "x"), markersize=5, markerfacecolor="0.75",
                            label="published: " + column["name"], gid=gid("published", column["name"]))
            extra.append(line)
    dotted = (0, (1, 2))
    extra.append(ax.axhline(cap, color="0.3", linewidth=0.8, linestyle=dotted, zorder=0, label=f"{cap} Hz display"))
    drawn, hidden, any_failed = set(), [], False
    for (name, sides), cells in all_series.items():
        if mark_failed(ax, cells, palette[name], (name, sides)):
            drawn.add((name, sides))
            any_failed = True
        good = [r for r in cells if r["status"] == "ok" and math.isfinite(number(r.get("fps_median")))]
        if not good:
            continue
        y = [number(r["fps_median"]) for r in good]
        if name == FLOOR and any(n != FLOOR for n, _ in all_series):
            hidden += y  # decades above every solver: it would press them into one band
            continue
        spread = [v * number(r.get("fps_spread")) for v, r in zip(y, good)]
        bar = ax.errorbar([width(r) for r in good], y, yerr=[s if math.isfinite(s) else 0 for s in spread], capsize=2,
                          elinewidth=0.8, zorder=2, **style(palette[name], sides))
        bar[0].set_gid(gid("fps", name, sides))
        drawn.add((name, sides))
    axes(ax, rows)
    if any_failed:
        extra.append(room_for_failed(ax))
    ax.set_xlabel("cloth resolution [vertices]")
    ax.set_ylabel("frames per second, uncapped")
    text = f"Above the axis: {FLOOR}, {min(hidden):,.0f} to {max(hidden):,.0f}. " if hidden else ""
    legend(fig, ax, drawn, palette, extra, text + where(rows))
    save(fig, path)


def bandwidth_figure(rows, path):
    all_series = series(rows)
    palette = colours(sorted({name for name, _ in all_series}))
    counted = [r for r in rows if r["status"] == "ok" and math.isfinite(number(r.get("bandwidth_read_peak_B_per_s")))]
    if not counted:
        nothing(path, "No GPU solver among the cells:\nno bytes are known.")
        return
    # One panel each for read and write: together the lines would hide each other.
    fig, panels = plt.subplots(2, 1, figsize=(3.5, 4.6), sharex=True, sharey=True, gridspec_kw={"hspace": 0.1})
    drawn, absent, any_failed = set(), set(), False
    for ax, what in zip(panels, ("read", "write")):
        for (name, sides), cells in all_series.items():
            on_gpu = [r for r in cells if r["gpu"] != "CPU"]
            if mark_failed(ax, on_gpu, palette[name], (what, name, sides)):
                drawn.add((name, sides))
                any_failed = True
            good = [r for r in on_gpu if r in counted]
            if not good:
                absent.update(r["solver"] for r in cells if r["status"] == "ok")
                continue
            ax.plot([width(r) for r in good], [1e-9 * number(r[f"bandwidth_{what}_peak_B_per_s"]) for r in good],
                    gid=gid("bandwidth", what, name, sides), **style(palette[name], sides))
            drawn.add((name, sides))
        axes(ax, rows)
        ax.set_ylabel(f"{what} [GB/s]")
    panels[1].set_xlabel("cloth resolution [vertices]")
    windows = sorted(w for w in (number(r.get("bandwidth_window_s")) for r in counted) if math.isfinite(w))
    text = "Shaders' loads and stores, computed, over wall time, peak"
    text += f" over windows of {windows[0]:.2g} to {windows[-1]:.2g} s. " if windows else ". "
    if absent:
        text += "Not known: " + ", ".join(sorted(absent)) + ". "
    extra = [room_for_failed(panels[0])] if any_failed else []
    legend(fig, panels[1], drawn, palette, extra, text + where(rows))
    save(fig, path)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    source = pathlib.Path(sys.argv[1])
    with source.open(newline="", encoding="utf-8") as f:
        rows = [r for r in csv.DictReader(f) if number(r["grid_x"]) > 0 and number(r["grid_y"]) > 0]
    with open(sys.argv[2], encoding="utf-8") as f:
        published = json.load(f)
    first = next((r for r in rows if r["paper_table"] == "3"), rows[0] if rows else None)
    if first is None:
        for name in ("fig4", "fig5"):
            nothing(source.parent / name, "No cell with a cloth grid.")
        return
    rows = [r for r in rows if r["family"] == first["family"]]
    with plt.rc_context(STYLE):
        fps_figure(rows, published, first["paper_table"] == "3", source.parent / "fig4")
        bandwidth_figure(rows, source.parent / "fig5")


if __name__ == "__main__":
    main()
