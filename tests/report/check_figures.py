"""Draws the figures of a small cells.csv and counts what is in them.

usage: check_figures.py PLOT_REPORT.py PAPER-TABLE3.json
"""
import csv
import pathlib
import re
import subprocess
import sys
import tempfile

COLUMNS = ["family", "paper_table", "solver", "setting", "sides", "repeat", "resolution", "grid_x", "grid_y", "status",
           "gpu", "gpu_is_software", "fps_median", "fps_spread", "bandwidth_read_peak_B_per_s", "bandwidth_write_peak_B_per_s",
           "bandwidth_window_s"]


def row(solver, n, sides="single", status="ok", on_gpu=True, family="gravity", **more):
    ok = status == "ok"
    values = {"family": family, "paper_table": "3" if family == "gravity" else "", "solver": solver,
              "setting": "default", "sides": sides, "repeat": 1, "resolution": f"{n}²", "grid_x": n, "grid_y": n, "status": status,
              "gpu": "Fake GPU" if on_gpu else "CPU", "gpu_is_software": "true" if on_gpu else "false",
              "fps_median": 1e4 / max(n, 1) if ok else "", "fps_spread": 0.1 if ok else "",
              "bandwidth_read_peak_B_per_s": 1e7 * n if ok and on_gpu else "",
              "bandwidth_write_peak_B_per_s": 4e6 * n if ok and on_gpu else "", "bandwidth_window_s": 0.5 if ok else ""}
    return values | more


def draw(command, folder, rows, check=True):
    folder.mkdir()
    with (folder / "cells.csv").open("w", newline="", encoding="utf-8") as f:
        out = csv.DictWriter(f, COLUMNS)
        out.writeheader()
        out.writerows(rows)
    subprocess.run([sys.executable, command[0], str(folder / "cells.csv"), command[1]], check=check)
    for name in ("fig4", "fig5"):
        png = (folder / f"{name}.png").read_bytes()
        assert png[:8] == b"\x89PNG\r\n\x1a\n" and len(png) > 2000, f"{name}.png is no picture"
    return {name: (folder / f"{name}.svg").read_text(encoding="utf-8") for name in ("fig4", "fig5")}


def ids(svg, start):
    return sorted(re.findall(rf'id="({start}-[^"]*)"', svg))


def main():
    command = sys.argv[1:3]
    rows = [row(s, n, sides) for s in ("paper", "xpbd") for n in (8, 16, 32) for sides in ("single", "double")]
    rows += [row("bullet-soft", n, on_gpu=False) for n in (8, 16, 32)]
    rows += [row("ballistic", n, on_gpu=False, fps_median=1e6) for n in (8, 16, 32)]
    rows += [row("other", 8, status="diverged"), row("other", 16, status="unsupported")]
    rows += [row("elsewhere", 8, family="hang"), row("mesh", 0)]
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        svg = draw(command, folder / "all", rows)
        assert ids(svg["fig4"], "fps") == ["fps-bullet-soft-single", "fps-paper-double", "fps-paper-single",
                                           "fps-xpbd-double", "fps-xpbd-single"], ids(svg["fig4"], "fps")
        assert len(ids(svg["fig4"], "published")) == 3
        assert ids(svg["fig4"], "failed") == ["failed-other-single"], "failed cells are marked, unsupported ones not"
        assert "software, not for speed claims" in re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", svg["fig4"]))
        found = ids(svg["fig5"], "bandwidth")
        assert len(found) == 8 and not any("bullet" in i or "ballistic" in i for i in found), found
        assert "bullet-soft" in svg["fig5"], "who is absent is said"

        assert ids(svg["fig5"], "failed") == ["failed-read-other-single", "failed-write-other-single"]

        again = draw(command, folder / "again", rows)
        assert again == svg, "the same cells give another file"

        cpu = draw(command, folder / "cpu", [r for r in rows if r["gpu"] == "CPU"])
        assert ids(cpu["fig5"], "bandwidth") == [] and len(ids(cpu["fig4"], "fps")) == 1
        floor = draw(command, folder / "floor", [r for r in rows if r["solver"] == "ballistic"])
        assert ids(floor["fig4"], "fps") == ["fps-ballistic-single"], "alone, it is shown"
        hang = draw(command, folder / "hang", [r for r in rows if r["family"] == "hang"])
        assert ids(hang["fig4"], "published") == [], "published values belong to Table 3 alone"
        failed = draw(command, folder / "failed", [r for r in rows if r["solver"] == "other"])
        assert len(ids(failed["fig4"], "failed")) == 1
        draw(command, folder / "none", [])


if __name__ == "__main__":
    main()
