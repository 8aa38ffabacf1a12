#!/usr/bin/env python3
"""How much a hung sheet stretches against what a frame costs, from a report's cells.csv of `study hang`.

usage: plot_hang.py CELLS.csv [SCENE...]     default: hang-32 hang-64 hang-128 hang-256
Writes hang-stretch.svg and .png beside the CSV: greatest and mean stretch of the last second against GPU time a frame, both logarithmic, a panel a
scene, settings of a solver joined by time. Reads nothing but the file.
"""
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

# Okabe & Ito's palette, readable with every common colour blindness; as in plot_work_precision.py.
STYLES = {"xpbd": ("#0072B2", "o"), "paper": ("#D55E00", "s")}
STYLE = {"font.size": 8, "axes.labelsize": 9, "legend.fontsize": 7.5, "svg.fonttype": "none", "svg.hashsalt": "clothbench",
         "axes.spines.top": False, "axes.spines.right": False, "axes.axisbelow": True}
AIM = 10  # % of greatest stretch


def label(solver, setting):
    if solver == "paper":
        setting = setting.replace("default", "5")
    return setting.replace("iterations=", "").replace("substeps=20", "20 substeps")


def points(rows, scene, solver):
    out = []
    for r in rows:
        if r["scene"] == scene and r["solver"] == solver and r["status"] == "ok" and r["sides"] == "single":
            try:
                out.append((1e3 * float(r["frame_device_median_s"]), 100 * float(r["stretch_max_last_second"]),
                            100 * float(r["stretch_mean_last_second"]), r["setting"]))
            except ValueError:
                pass  # no time on a CPU
    return sorted(p for p in out if "contact" not in p[3])


def main():
    path = pathlib.Path(sys.argv[1])
    scenes = sys.argv[2:] or ["hang-32", "hang-64", "hang-128", "hang-256"]
    with open(path, newline="") as f:
        rows = list(csv.DictReader(f))
    plt.rcParams.update(STYLE)
    figure, axes = plt.subplots(1, len(scenes), figsize=(2.4 * len(scenes), 3), sharey=True, sharex=True, squeeze=False)
    for axis, scene in zip(axes[0], scenes):
        for solver, (colour, marker) in STYLES.items():
            p = points(rows, scene, solver)
            # `paper` by iterations; its one run by substeps stands alone.
            line = [q for q in p if "substeps" not in q[3]]
            for k, (style, name) in enumerate([("-", "greatest"), (":", "mean")], 1):
                axis.plot([q[0] for q in line], [q[k] for q in line], style, color=colour, marker=marker, ms=4, lw=1, label=f"{solver}, {name}")
                axis.plot([q[0] for q in p if q not in line], [q[k] for q in p if q not in line], color=colour, marker=marker, ms=4, ls="",
                          mfc="none")
            for q in p:
                axis.annotate(label(solver, q[3]), (q[0], q[1]), textcoords="offset points", xytext=(3, -9 if "substeps" in q[3] else 4), fontsize=6, color=colour)
        axis.axhline(AIM, color="#777777", lw=0.8, ls="--")
        axis.set(xscale="log", yscale="log", title=scene, xlabel="GPU time a frame [ms]")
        axis.set_xlim(0.01, 300)
        axis.grid(True, lw=0.3, color="#cccccc")
    axes[0][0].set_ylabel("stretch, last second of five [%]")
    figure.legend(*axes[0][0].get_legend_handles_labels(), frameon=False, loc="upper center", ncol=4)
    figure.tight_layout(rect=(0, 0, 1, 0.93))
    for kind in ("svg", "png"):
        figure.savefig(path.parent / f"hang-stretch.{kind}", dpi=200)


if __name__ == "__main__":
    main()
