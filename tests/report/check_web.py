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
import table_values

sample, report = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[1], "report")
if not (report / "index.html").exists():
    line = re.search("^The interactive page was left out.*", (report / "report.md").read_text(), flags=re.M)
    print("SKIPPED:", line[0] if line else "no index.html, and report.md does not say why")
    sys.exit(77 if line else 1)
html = (report / "index.html").read_text(encoding="utf-8")
embedded = lambda name: json.loads(zlib.decompress(base64.b64decode(re.search(rf' id="{name}">(.*?)</script>', html)[1])))  # noqa: E731
doc, motions = embedded("clothbench-data"), embedded("clothbench-motions")
blobs = {int(k): v for k, v in re.findall(r'<script type="text/plain" id="blob-(\d+)">([^<]*)</script>', html)}

# The page loads nothing from elsewhere and has at most 20 MB.
assert len(html) < 20e6, len(html)
markup = re.sub(r"<(script|style)\b([^>]*)>.*?</\1>", r"<\1\2>", html, flags=re.S)
assert not re.search(r'<(?:script|link|img)[^>]+(?:src|href)="(?!data:)', markup), "the page asks for another file"

# Wrong statements that pages once made. Results in static text could belong to other runs.
static_text = re.sub(r'<(script|style|svg)\b.*?</\1>|<section id="overview">.*?</section>|<details>.*?</details>', "", html, flags=re.S)
prose, title = html.split('id="clothbench-motions"')[0].split('id="clothbench-data"')[0].split("<body>")[1], re.search(r"<title>(.*?) · clothbench</title>", html)[1]
for what, text, pattern, wanted in (
    ("a result in static text", static_text, r"\d+ of \d+|\d\s?(ms|µs|%)(?! interval)|results/reference", False), ("not a number in prose", prose, r"\b(nan|inf)\b", False), ("the trials of these runs", html, "trials per run <b>1</b>", True),
    ("commit and date", html, "commit <b>.*date <b>", True), ("a title with device and studies", title, r"^Cloth solvers on .*: 8 studies: contact, contact-gpu, more …$", True), ("the title as a heading", html, f"<h1>{re.escape(title)}</h1>", True),
    ("all studies", html, "studies <b>contact, contact-gpu, more, table3, truth-1, truth-1-gpu, truth-4, truth-4-gpu</b>", True)):
    assert bool(re.search(pattern, text)) == wanted, (what, wanted, title)
for tile in doc["tiles"]:
    for e in tile["entries"]:
        assert re.search(r"\d[kM]?–[\d.]+|too few frames for an interval", e["about"]) and re.search(r"\d trial|one run per scene", e["about"]), (tile["title"], e)
for t in (t for s in doc["sections"] for t in s["tables"]):
    rows = [dict(zip(t["rows"][0], row)) for row in t["rows"][1:]]
    assert len(re.findall(r"\.(?=\s|$)", t["note"].split("\n")[0])) <= 2, f"{t['title']}: a caption of more than two sentences"
    for row in rows if t["explains"] else []:  # a bound has its sign, and its unit is the value's
        found, expected = (table_values.text_of(row[k]) for k in ("found", "expected"))
        bound = re.fullmatch(r"at (?:least|most) -?[\d.e+-]+( \S+)?", expected)
        assert expected in ("–", "ok") or bound and (found == "–" or found.endswith(bound[1] or found[-1])), row
    for row, k in zip(rows, t["again"]):  # a wide interval is marked, and its run not ranked
        p50, low, high = (doc["runs"][k[0]].get("wall") or [1, 1, 1])[:3]
        if row.get("clock") == "wall" and low is not None and high - low > 0.2001 * p50:
            assert "~" in table_values.text_of(row["frame p50 [ms]"]) and table_values.text_of(row.get("rank", "–")) == "–", row

# Tables equal those of report.md, run by run.
markdown = (report / "report.md").read_text(encoding="utf-8")
assert not re.search(r"\b(nan|inf)\b", markdown), "not a number in a table or a note"
tables, static = [t for s in doc["sections"] for t in s["tables"]], {}
for block in re.split(r"^### ", markdown, flags=re.M)[1:]:
    static[block.splitlines()[0]] = [[c.strip().replace("\\|", "|") for c in re.split(r"(?<!\\)\|", x)[1:-1]] for x in block.splitlines() if re.match(r"\|(?!--)", x)]
assert {*static} == {t["title"] for t in tables}, {*static} ^ {t["title"] for t in tables}
for t in tables:
    assert [[table_values.text_of(c).strip().replace("\n", " ") for c in row] for row in t["rows"]] == static[t["title"]], t["title"]
for c in (c for t in tables if t["title"].startswith("Verdict") for row in t["rows"][1:] for c in row if c[2:3] == ["dim"] and c[0] != "ignored"):
    assert len(c) == 5 and c[4], f"a cell without a reason: {c}"
assert static["Table 3: speed and error"][-1][0].startswith("published") and static["Machines of the runs"][0][0] == "runs"

# Tables and rows of figures equal what the run's file says.
files = {tuple(h5py.File(path).attrs[k] for k in ("scene", "solver", "setting")): path for path in (sample / "runs").rglob("*.h5")}
for r in doc["runs"]:
    r["largest"] = r.get("width") == max((q["width"] for q in doc["runs"] if q.get("family", "") == r.get("family") and not q["published"]), default=None)
runs = [table_values.Run(files[r["scene"], r["solver"], r["setting"]] if "file" in r else None, r) for r in doc["runs"]]
compared, rows = table_values.compare_tables(doc, runs), table_values.compare_rows([r for r in runs if r.path])
assert sum(compared.values()) > 1000 and rows > 500, (compared, rows)

# Motions: within half a step of the stored positions, with the numbers that the viewer shows.
moved = series = 0
words = lambda index, size: np.frombuffer(zlib.decompress(base64.b64decode(blobs[index], validate=True)), f"<u{size}")  # noqa: E731
for c in motions["runs"]:
    r = doc["runs"][c["run"]]
    with h5py.File(files[r["scene"], r["solver"], r["setting"]]) as f:
        stored, times = f["trajectory/position"][:].astype(float), f["trajectory/time_s"][:]
        for name, values in c["metrics"].items():
            np.testing.assert_allclose(np.array(values, float), f["metrics"][name][:][c["frames"]], rtol=1e-5)
            series += 1
    assert c["frames_stored"] == len(stored) and c["grid"][0] * c["grid"][1] == stored.shape[1]
    np.testing.assert_array_equal(c["time_s"], times[c["frames"]])
    x = words(c["blob"], 2).reshape(len(c["frames"]), -1).astype(np.int64)
    for k in range(len(x)):  # from residuals to positions, each from those before
        x[k] = (np.cumsum(x[0]) if k == 0 else x[1] + x[0] if k == 1 else x[k] + 2 * x[k - 1] - x[k - 2]) % 65536
    x = x.reshape(len(x), 3, -1).transpose(0, 2, 1)
    error = np.abs(c["low_m"] + x * c["step_m"] - stored[c["frames"]]).max()
    assert error <= 0.5001 * c["step_m"], (r["scene"], error, c["step_m"])
    assert c["step_m"] <= np.ptp(stored.reshape(-1, 3), axis=0).max() / 65000
    moved += np.ptp(x, axis=0).max() > 0
assert moved == len(motions["runs"]) >= 14 and series >= 30, (moved, series)

# Colliders: every shape occurs, and an array of each kind can be decoded.
shapes = {g["attributes"].get("shape", g["path"]): g for groups in reversed(motions["colliders"]) for g in reversed(groups)}
assert {"sphere", "box", "plane", "mesh", "capsules", "colliders/grips"} <= set(shapes), set(shapes)
with h5py.File(files["capsule-sweep", "bullet-soft", "default"]) as f:
    a = shapes["capsules"]["arrays"]["capsules"]
    np.testing.assert_array_equal(words(a["blob"], 4).view("<f4").reshape(a["shape"]), f["colliders/0/capsules"][:].astype("f4"))
with h5py.File(files["open-sheet", "bullet-soft", "default"]) as f:
    run = next(c for c in motions["runs"] if doc["runs"][c["run"]]["scene"] == "open-sheet")
    a = next(g for g in motions["colliders"][run["colliders"]] if g["path"] == "colliders/0")["arrays"]["triangles"]
    np.testing.assert_array_equal(words(a["blob"], 4).reshape(a["shape"]), f["colliders/0/triangles"][:])
    np.testing.assert_array_equal(shapes["sphere"]["attributes"]["radius_m"], 0.15)
print(f"{len(tables)} tables, {compared}, {rows} values of figures, {series} series, {moved} motions, {len(html) / 1e6:.1f} MB")
