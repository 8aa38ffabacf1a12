"""Draws the figures of a made-up penetration-series.csv and counts what is in them.

usage: check_penetration_figures.py PLOT_PENETRATION.py
"""
import csv
import math
import pathlib
import re
import subprocess
import sys
import tempfile

METRICS = ["contact_length_m", "tunnelled_fraction", "tunnelled_depth_m", "depth_m", "depth_vertex_m", "stretch_max"]
COLUMNS = ["set_up", "scene", "solver", "setting", "sides", "repeat", "status", "failed_frame", "time_s", *METRICS]


def rows(kind, scene, solver, setting="default", status="ok", frames=40, **amplitude):
    for k in range(frames):
        t = k / 72
        row = {"set_up": kind, "scene": scene, "solver": solver, "setting": setting, "sides": "double", "repeat": 1, "status": status,
               "failed_frame": "" if status == "ok" else frames, "time_s": f"{t:.6g}"}
        for metric, a in amplitude.items():
            row[metric] = f"{a * max(0.0, math.sin(6 * t)):.6g}"
        yield row


def sample():
    out = []
    for scene in ("desk-flat-low", "desk-corner-low"):
        for k, (solver, setting) in enumerate([("paper", "default"), ("paper", "whole-room"), ("xpbd", "default"), ("bullet-soft", "default"),
                                               ("bullet-deformable", "default")]):
            out += rows("rooms", scene, solver, setting, contact_length_m=0.1 * k, tunnelled_fraction=0.05 * k, tunnelled_depth_m=0.004 * k)
    out += rows("capsules", "sweep", "xpbd", contact_length_m=0.3, depth_m=0.002)
    out += rows("capsules", "sweep", "paper", status="not_finite", frames=9, contact_length_m=0.3, depth_m=0.05)
    for scene in ("stretch-0p5", "stretch-2", "stretch-10", "stretch-20"):
        out += rows("grip", scene, "xpbd", stretch_max=0.2)
    out += rows("hand", "push", "bullet-soft")
    out += rows("hand", "push", "ballistic", contact_length_m=9)
    return out


def draw(script, folder, table):
    folder.mkdir()
    source = folder / "penetration-series.csv"
    with source.open("w", newline="", encoding="utf-8") as f:
        out = csv.DictWriter(f, COLUMNS)
        out.writeheader()
        out.writerows(table)
    subprocess.run([sys.executable, "-W", "error", script, str(source)], check=True)
    return {p.stem: p.read_text(encoding="utf-8") for p in sorted(folder.glob("*.svg"))}


def ids(svg, start):
    return sorted(re.findall(rf'id="({start}-[^"]*)"', svg))


def main():
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        svg = draw(sys.argv[1], folder / "all", sample())
        assert sorted(svg) == ["penetration-capsules", "penetration-grip", "penetration-hand", "penetration-rooms"], sorted(svg)
        for stem in svg:
            png = (folder / "all" / f"{stem}.png").read_bytes()
            assert png[:8] == b"\x89PNG\r\n\x1a\n" and len(png) > 2000, f"{stem}.png is no picture"
        rooms = svg["penetration-rooms"]
        assert len(ids(rooms, "series")) == 2 * 3 * 5, ids(rooms, "series")
        assert len(ids(rooms, "series-tunnelled-fraction")) == 2 * 5
        assert not ids(rooms, "failed")
        assert "paper whole-room" in rooms and "desk-corner-low" in rooms
        assert len(ids(svg["penetration-capsules"], "failed")) == 2, "who failed is marked in every panel"
        assert len(ids(svg["penetration-grip"], "series-stretch-max")) == 4
        assert "No cell" in svg["penetration-hand"] and not ids(svg["penetration-hand"], "series")
        assert draw(sys.argv[1], folder / "again", sample()) == svg, "the same cells give another file"
        assert draw(sys.argv[1], folder / "none", []) == {}
        control = draw(sys.argv[1], folder / "control", rows("hand", "push", "ballistic", contact_length_m=9))
        assert len(ids(control["penetration-hand"], "series")) == 1, "alone, it is shown"


if __name__ == "__main__":
    main()
