#!/usr/bin/env python3
"""Stability maps and the robustness table from a report's stability.json and stability.csv.

usage: plot_stability.py STABILITY.json STABILITY.csv
Writes stability-<map>.svg and .png beside the JSON, a panel a solver: every probe by its outcome class, in colour and in
symbol; the boundary with the range of its seeds; theoretical lines. And stability-cases.svg and .png: runs of every case that
were stable, degraded and failed, by solver. A file that has nothing to draw gives no figure.
"""
import csv
import json
import math
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402

from plot_report import STYLE, gid, save  # noqa: E402

# Okabe & Ito's palette; every class has its own symbol too, so that nothing hangs on the colour.
CLASSES = {"ok": ("#009E73", "o", "stable"), "F0": ("#000000", "X", "F0 not finite"), "F1": ("#D55E00", "^", "F1 speed"),
           "F2": ("#CC79A7", "v", "F2 energy gain"), "F3": ("#E69F00", "s", "F3 strain"), "F4": ("#56B4E9", "D", "F4 geometry"),
           "F5": ("#0072B2", "P", "F5 contact"), "F6": ("#F0E442", "h", "F6 unrest"), "F7": ("#777777", "<", "F7 stagnation"),
           "F8": ("#444444", "*", "F8 budget, crash or device")}
GRADES = [("stable", "#009E73", ""), ("degraded", "#E69F00", "//"), ("failed", "#D55E00", "xx")]
LINES = ["--", ":", "-."]


def kind(probe):
    if probe["grade"] == 0:
        return "ok"
    return probe["class"] if probe["class"] in CLASSES else "F8"


def name_of(solver):
    return solver["solver"] if solver["setting"] == "default" else f"{solver['solver']} {solver['setting']}"


def label_of(axis):
    return axis["label"] + (f" [{axis['unit']}]" if axis["unit"] else "")


def boundary(solver):
    """(y, least and greatest middle of the turn) of every row that turns."""
    out = []
    for row in solver["rows"]:
        turns = [math.sqrt(s["last_good"] * s["first_bad"]) for s in row["seeds"] if s["first_bad"] is not None and s["last_good"] > 0]
        if turns:
            out.append((row["y"], min(turns), max(turns)))
    return out


def panel(ax, m, solver):
    seen = set()
    for probe in solver["probes"]:
        if probe["seed"] != 0:
            continue
        k = kind(probe)
        colour, symbol, _ = CLASSES[k]
        seen.add(k)
        ax.plot([probe["x"]], [probe["y"]], symbol, color=colour, markersize=5.5, markeredgecolor="0.15", markeredgewidth=0.4, linestyle="none",
                gid=gid("probe", m["name"], name_of(solver), k, f"{probe['x']:.4g}", f"{probe['y']:.4g}"))
    turns = boundary(solver)
    if turns:
        ax.plot([math.sqrt(a * b) for _, a, b in turns], [y for y, _, _ in turns], "-", color="0.1", linewidth=1.2, zorder=1,
                gid=gid("boundary", m["name"], name_of(solver)))
        for y, a, b in turns:
            if b > a:
                ax.plot([a, b], [y, y], "-", color="0.1", linewidth=3, alpha=0.4, zorder=1)
    for k, line in enumerate(m["theory"]):
        if line["points"]:
            xs, ys = zip(*line["points"])
            ax.plot(xs, ys, LINES[k % len(LINES)], color="#0072B2", linewidth=1.2, zorder=0.5, gid=gid("theory", m["name"], line["name"]))
    ax.set_xscale("log")
    ax.set_yscale("log")
    largest = "none" if not solver["largest"] else ("≥ " if solver["open"] else "") + f"{solver['largest']:.3g} {m['x']['unit']}"
    ax.set_title(f"{name_of(solver)}: {'unsupported' if solver['unsupported'] else largest}", fontsize=8, loc="left")
    ax.grid(True, which="major", linewidth=0.4, alpha=0.5)
    return seen


def draw_map(m, path):
    solvers = [s for s in m["solvers"] if s["probes"]]
    if not solvers:
        return
    across = min(3, len(solvers))
    down = math.ceil(len(solvers) / across)
    fig, panels = plt.subplots(down, across, figsize=(2.5 * across + 0.3, 2.0 * down + 0.6), squeeze=False, sharex=True, sharey=True,
                               layout="constrained")
    spots = list(panels.flat)
    seen = set()
    for ax, solver in zip(spots, solvers):
        seen |= panel(ax, m, solver)
    xs = [p["x"] for s in solvers for p in s["probes"]]
    ys = [p["y"] for s in solvers for p in s["probes"]]
    spots[0].set_xlim(min(xs) / 1.6, max(xs) * 1.6)  # a theory far outside is not drawn
    spots[0].set_ylim(min(ys) / 1.8, max(ys) * 1.8)
    for ax in spots[len(solvers):]:
        ax.set_axis_off()
    fig.supxlabel(label_of(m["x"]), fontsize=9)
    fig.supylabel(label_of(m["y"]), fontsize=9)
    fig.suptitle(f"{m['title']}: {m['headline']}", fontsize=8.5, x=0.01, ha="left")
    entries = [Line2D([], [], color=CLASSES[k][0], marker=CLASSES[k][1], linestyle="none", markersize=5.5, markeredgecolor="0.15",
                      markeredgewidth=0.4, label=CLASSES[k][2]) for k in CLASSES if k in seen]
    entries.append(Line2D([], [], color="0.1", linewidth=1.2, label="boundary"))
    for k, line in enumerate(m["theory"]):
        entries.append(Line2D([], [], color="#0072B2", linestyle=LINES[k % len(LINES)], linewidth=1.2, label=line["label"]))
    fig.legend(handles=entries, loc="upper center", bbox_to_anchor=(0.5, 0), ncols=min(4, len(entries)), frameon=False)
    save(fig, path)


def draw_cases(rows, path):
    rows = [r for r in rows if r["grade"]]
    if not rows:
        return
    cases = sorted({r["case"] for r in rows})
    names = list(dict.fromkeys(r["solver"] if r["setting"] in ("", "default") else f"{r['solver']} {r['setting']}" for r in rows))
    fig, panels = plt.subplots(1, len(names), figsize=(1.3 * len(names) + 0.8, 0.17 * len(cases) + 1.0), squeeze=False, sharey=True, layout="constrained")
    for ax, name in zip(panels.flat, names):
        mine = [r for r in rows if (r["solver"] if r["setting"] in ("", "default") else f"{r['solver']} {r['setting']}") == name]
        for k, case in enumerate(cases):
            of_case = [r["grade"] for r in mine if r["case"] == case]
            left = 0.0
            for grade, colour, hatch in GRADES:
                share = of_case.count(grade) / len(of_case) if of_case else 0
                if share > 0:
                    ax.barh(k, share, left=left, color=colour, hatch=hatch, edgecolor="white", linewidth=0.3, height=0.8, gid=gid("case", name, case, grade))
                left += share
        ax.set_title(name, fontsize=7)
        ax.set_xlim(0, 1)
        ax.set_xticks([0, 1], ["0", "all"])
        ax.set_yticks(range(len(cases)), cases)
        ax.set_ylim(len(cases) - 0.4, -0.6)
    entries = [plt.Rectangle((0, 0), 1, 1, facecolor=c, hatch=h, edgecolor="white", label=g) for g, c, h in GRADES]
    fig.legend(handles=entries, loc="upper center", bbox_to_anchor=(0.5, 0), ncols=3, frameon=False)
    save(fig, path)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    source = pathlib.Path(sys.argv[1])
    maps = json.loads(source.read_text(encoding="utf-8"))["maps"]
    with pathlib.Path(sys.argv[2]).open(newline="", encoding="utf-8") as f:
        rows = list(csv.DictReader(f))
    with plt.rc_context(STYLE):
        for m in maps:
            draw_map(m, source.parent / f"stability-{m['name']}")
        draw_cases(rows, source.parent / "stability-cases")


if __name__ == "__main__":
    main()
