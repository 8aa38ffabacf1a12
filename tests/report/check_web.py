#!/usr/bin/env python3
"""Compares the page of a report with the result files and the static report, which it reads independently. Exit 77 if
the build has no page.

usage: check_web.py SAMPLE      SAMPLE: the folder that web_sample.py made
"""
import base64
import json
import pathlib
import re
import sys
import zlib

import h5py
import numpy as np

sample = pathlib.Path(sys.argv[1])
report = sample / "report"
if not (report / "index.html").exists():
    lines = (report / "report.md").read_text().splitlines()
    line = next((x for x in lines if x.startswith("The interactive page was left out")), None)
    if line is None:
        sys.exit("no index.html, and report.md does not say why")
    print("SKIPPED:", line)
    sys.exit(77)
html = (report / "index.html").read_text(encoding="utf-8")
embedded = lambda name: json.loads(zlib.decompress(base64.b64decode(re.search(rf' id="{name}">(.*?)</script>', html)[1])))  # noqa: E731
doc, motions = embedded("clothbench-data"), embedded("clothbench-motions")
blobs = {int(k): v for k, v in re.findall(r'<script type="text/plain" id="blob-(\d+)">([^<]*)</script>', html)}
files = {}
for path in sorted((sample / "runs").rglob("*.h5")):
    with h5py.File(path) as f:
        files.setdefault(tuple(f.attrs[k] for k in ("scene", "solver", "setting")), path)
same = lambda a, b: a is None and not np.isfinite(b) or a is not None and a == b  # noqa: E731

# The page loads nothing from elsewhere and has at most 20 MB.
assert len(html) < 20e6, len(html)
markup = re.sub(r"<(script|style)\b([^>]*)>.*?</\1>", r"<\1\2>", html, flags=re.S)
assert not re.search(r'<(?:script|link|img)[^>]+(?:src|href)="(?!data:)', markup), "the page asks for another file"

# Static text contains no results, which could belong to other runs; the head states trials and device of these runs.
static_text = re.sub(r'<(script|style|svg)\b.*?</\1>|<section id="overview">.*?</section>|<details>.*?</details>', "", html, flags=re.S)
assert not re.search(r"\d+ of \d+|\d\s?(ms|µs|%)(?! interval)|results/reference", static_text), "a result in static text"
title = re.search(r"<title>(.*?)</title>", html)[1]
assert "studies <b>contact, table3, truth-1, truth-4</b>" in html and re.search(rf"<h1>{re.escape(title.split(' · ')[0])}</h1>", html), title
assert "trials per run <b>1</b>" in html and "commit <b>" in html and "date <b>" in html
assert not re.search(r"\b(nan|inf)\b", html.split('id="clothbench-motions"')[0].split('id="clothbench-data"')[0].split("<body>")[1]), "not a number in prose"

# Tables equal those of report.md, run by run.
markdown = (report / "report.md").read_text(encoding="utf-8")
assert not re.search(r"\b(nan|inf)\b", markdown), "not a number in a table or a note"
tables = [t for s in doc["sections"] for t in s["tables"]]
static = {}
for block in re.split(r"^### ", markdown, flags=re.M)[1:]:
    lines = block.splitlines()
    lines_of_table = [x for x in lines if x.startswith("|") and not x.startswith("|--")]
    rows = [[c.strip().replace("\\|", "|") for c in re.split(r"(?<!\\)\|", x)[1:-1]] for x in lines_of_table]
    if rows:
        static.setdefault(lines[0], rows)
titles = [t["title"] for t in tables]
assert set(static) <= set(titles), set(static) - set(titles)
for t in tables:
    if t["title"] in static:
        assert [[(c if isinstance(c, str) else c[0]).strip().replace("\n", " ") for c in row] for row in t["rows"]] == static[t["title"]], t["title"]
assert any(r[0].startswith("published") for r in static["Table 3: speed and error"])

# Every number in the tables, as text and as value, is recomputed from the run's file.
STORED = {"crossings": ("crossings_max", 1), "contour, max / settled [mm]": ("contact_length_max_m", 1e3), "depth [mm]": ("depth_max_m", 1e3), "popping [mm]": ("pop_max_m", 1e3),
          "strain, max / end [%]": ("stretch_max", 100), "stretch [%]": ("stretch_max_last_second", 100), "free-fall error [g T²/2]": ("free_fall_error", 1), "load [ms]": ("load_s", 1e3)}
TIMES = {"frame p50 [ms]": (0.5, 1e3), "p95 / p99 / worst [ms]": (0.95, 1e3), "missed 72 / 90 Hz [%]": (None, 1)}  # quantile; text over value
nearest = lambda x, q: x[max(int(np.ceil(q * len(x))), 1) - 1]  # noqa: E731
text_of = lambda c: c if isinstance(c, str) else c[0]  # noqa: E731


def run_of(t, cells, row, name):
    """The run behind a cell: with the column's solver or resolution; otherwise, in tables of resolutions, the run with the largest mesh."""
    of_solver = [r for r in doc["runs"] if t["title"].startswith("Verdict") and (r["scene"], r["label"]) == (text_of(cells[0]), name)]
    line = [r for r in doc["runs"] if all(r.get(k) == row.get(k) for k in ("label", "sides", "family"))]
    return (of_solver + [r for r in line if r.get("resolution") == name] + [max(line, key=lambda r: r["width"]) if "128²" in t["rows"][0] else row])[0]


compared = {}
for t, cells, row in ((t, cells, doc["runs"][k]) for t in tables for cells, k in zip(t["rows"][1:], t["runs"]) if not t["title"].startswith("Error against")):
    head = t["rows"][0]
    clock = {"wall": "wall", "CPU": "cpu"}.get(cells[head.index("clock")]) if "clock" in head else "wall"
    for name, cell in zip(head, cells):
        r, (text, value, _) = run_of(t, cells, row, name), cell if isinstance(cell, list) else (cell, None, "")
        if r.get("published") or text == "–" or name in TIMES and not clock:
            continue
        with h5py.File(files[r["scene"], r["solver"], r["setting"]]) as f:
            a, frames = dict(f["summary"].attrs), np.sort(f[f"timing/frame_{clock}_s"][:].ravel()) if name in TIMES else None
        q, ratio = TIMES.get(name, (None, 1))
        if name == r["label"] and "/" not in text and text != "ignored":
            assert text == {0: "fail", 1: "pass"}.get(min(v for k, v in a.items() if k.startswith("expect.")), "not measured"), (name, cells)
        elif value is not None and name in (*STORED, *TIMES, "found", r.get("resolution")):
            key, scale = STORED.get(name) or ("fps_median" if name == r.get("resolution") else text_of(cells[2]), 1)
            ratio = {"%": 100, "mm": 1e3}.get(text.split()[-1], 1) if name == "found" else ratio
            wanted = nearest(frames, q) if q else 100 * np.mean(frames > 1 / 72) if name in TIMES else scale * a[key]
            number = re.match(r"([\d.]+(?:e[+-]\d+)?)(k?)", text) or ["", value * ratio, ""]  # "<0.001"
            np.testing.assert_allclose([value, float(number[1]) * (1e3 if number[2] else 1) / ratio], wanted, rtol=0.05, err_msg=f"{t['title']}: {name} of {cells[:2]}")
            np.testing.assert_allclose(value, wanted, rtol=1e-5, err_msg=f"{t['title']}: {name} of {cells[:2]}")
        else:
            continue
        compared[t["title"]] = compared.get(t["title"], 0) + 1
assert sum(compared.values()) > 150 and len(compared) >= 6, compared

# Rows of the figures.
KEYS = {"fps_median", "free_fall_error", "bandwidth_read_peak_B_per_s", "stretch_max_last_second"}
points = errors = quantiles = 0
for r in doc["runs"]:
    if r.get("published"):
        continue
    with h5py.File(files[r["scene"], r["solver"], r["setting"]]) as f:
        a = f["summary"].attrs
        assert r["status"] == f["outcome"].attrs["status"]
        for name in KEYS & set(r):
            assert same(r[name], a.get(name, np.nan)), (r["scene"], r["solver"], name)
            points += r[name] is not None
        if "wall" in r:
            frames = np.sort(f["timing/frame_wall_s"][:].ravel())
            frames = frames[np.isfinite(frames)]
            rank = lambda q: frames[max(int(np.ceil(q * len(frames))), 1) - 1]  # noqa: E731
            for told, q in zip([r["wall"][0], *r["wall"][3:]], [0.5, 0.95, 0.99, 1]):
                np.testing.assert_allclose(told, rank(q), rtol=1e-5)
                quantiles += 1
            low, high = r["wall"][1:3]
            assert low is None or frames[0] <= low <= r["wall"][0] * 1.00001 <= high * 1.0001 <= frames[-1] * 1.0002, r["wall"]
        if r["part"] == "accuracy":
            rate = json.loads(json.loads(f["header_json"][0])["scenario_json"])["time"]["frame_rate_hz"]
            assert r["error"] == a["truth_error"]
            assert abs(r["wall_ms_per_s"] / (1e3 * rate * a["frame_wall_median_s"]) - 1) < 1e-12
            errors += 1
assert points >= 12 and errors == 2 and quantiles >= 40, f"only {points} rates, {errors} errors and {quantiles} times were compared"


def words(index, size):
    return np.frombuffer(zlib.decompress(base64.b64decode(blobs[index], validate=True)), f"<u{size}")


# Motions: within half a step of the stored positions, with the numbers that the viewer shows.
moved = series = 0
for c in motions["runs"]:
    r = doc["runs"][c["run"]]
    with h5py.File(files[r["scene"], r["solver"], r["setting"]]) as f:
        stored = f["trajectory/position"][:].astype(float)
        times = f["trajectory/time_s"][:]
        for name, values in c["metrics"].items():
            told = np.array([np.nan if v is None else v for v in values])
            np.testing.assert_allclose(told, f["metrics"][name][:][c["frames"]], rtol=1e-5)
            series += 1
    assert c["frames_stored"] == len(stored) and c["grid"][0] * c["grid"][1] == stored.shape[1]
    np.testing.assert_array_equal(c["time_s"], times[c["frames"]])
    residual = words(c["blob"], 2).reshape(len(c["frames"]), -1).astype(np.int64)
    x = np.zeros_like(residual)
    for k in range(len(x)):
        predicted = 0 if k == 0 else x[0] if k == 1 else 2 * x[k - 1] - x[k - 2]
        x[k] = (np.cumsum(residual[0]) if k == 0 else predicted + residual[k]) % 65536
    x = x.reshape(len(x), 3, -1).transpose(0, 2, 1)
    error = np.abs(c["low_m"] + x * c["step_m"] - stored[c["frames"]]).max()
    assert error <= 0.5001 * c["step_m"], (r["scene"], error, c["step_m"])
    assert c["step_m"] <= np.ptp(stored.reshape(-1, 3), axis=0).max() / 65000
    moved += np.ptp(x, axis=0).max() > 0
assert moved == len(motions["runs"]) >= 14 and series >= 30, (moved, series)

# Colliders: every shape occurs, and an array of each kind can be decoded.
shapes = {}
for groups in motions["colliders"]:
    for g in groups:
        shapes.setdefault(g["attributes"].get("shape", g["path"]), g)
assert {"sphere", "box", "plane", "mesh", "capsules", "colliders/grips"} <= set(shapes), set(shapes)
with h5py.File(files["capsule-sweep", "bullet-soft", "default"]) as f:
    a = shapes["capsules"]["arrays"]["capsules"]
    told = words(a["blob"], 4).view("<f4").reshape(a["shape"])
    np.testing.assert_array_equal(told, f["colliders/0/capsules"][:].astype("f4"))
with h5py.File(files["open-sheet", "bullet-soft", "default"]) as f:
    run = next(c for c in motions["runs"] if doc["runs"][c["run"]]["scene"] == "open-sheet")
    sheet = next(g for g in motions["colliders"][run["colliders"]] if g["path"] == "colliders/0")
    a = sheet["arrays"]["triangles"]
    np.testing.assert_array_equal(words(a["blob"], 4).reshape(a["shape"]), f["colliders/0/triangles"][:])
    np.testing.assert_array_equal(shapes["sphere"]["attributes"]["radius_m"], 0.15)
print(f"{len(tables)} tables, {compared}, {points} rates, {quantiles} times, {series} series, {moved} motions, {len(html) / 1e6:.1f} MB")
