"""Draws maps and cases made by hand and looks for what must be in the figures."""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile


def main():
    script = sys.argv[1]
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        classes = ["ok", "F0", "F1", "F2", "F3", "F4", "F5", "F6", "F7", "F8"]
        probes = [{"x": 10.0 ** k, "y": 1.0, "seed": 0, "status": "ok", "class": c, "grade": 0 if c == "ok" else 1 if c in ("F3", "F6") else 2,
                   "frame": k, "message": ""} for k, c in enumerate(classes)]
        solver = {"solver": "xpbd", "setting": "8x4", "unsupported": False, "probes": probes, "largest": 1.0, "open": False,
                  "rows": [{"y": 1.0, "seeds": [{"last_good": 1.0, "first_bad": 1.1}, {"last_good": 2.0, "first_bad": 2.2}]},
                           {"y": 10.0, "seeds": [{"last_good": 0, "first_bad": 1}]}]}
        absent = {**solver, "solver": "reference", "setting": "default", "unsupported": True, "probes": [], "rows": [], "largest": None, "open": True}
        m = {"name": "one", "title": "One map", "headline": "largest of all", "x": {"label": "step", "unit": "s"}, "y": {"label": "ratio", "unit": ""},
             "theory": [{"name": "explicit-limit", "label": "explicit", "points": [[1, 1], [2, 10]]}], "solvers": [solver, absent]}
        (folder / "stability.json").write_text(json.dumps({"maps": [m]}))
        with (folder / "stability.csv").open("w", newline="") as f:
            out = csv.DictWriter(f, ["case", "solver", "setting", "grade"])
            out.writeheader()
            for grade in ("stable", "degraded", "failed", ""):
                out.writerow({"case": "S01", "solver": "xpbd", "setting": "default", "grade": grade})
        subprocess.run([sys.executable, script, folder / "stability.json", folder / "stability.csv"], check=True)
        for name in ("stability-one", "stability-cases"):
            assert (folder / f"{name}.png").stat().st_size > 5000, name
        text = (folder / "stability-one.svg").read_text()
        for c in classes:
            assert f"probe-one-xpbd-8x4-{c}-" in text, f"class {c} is not drawn"
        for part in ("boundary-one", "theory-one-explicit-limit", "F5 contact", "stable", "explicit"):
            assert part in text, part
        cases = (folder / "stability-cases.svg").read_text()
        for grade in ("stable", "degraded", "failed"):
            assert f"case-xpbd-S01-{grade}" in cases, grade
        (folder / "stability.json").write_text(json.dumps({"maps": []}))
        (folder / "stability.csv").write_text("case,solver,setting,grade\n")
        subprocess.run([sys.executable, script, folder / "stability.json", folder / "stability.csv"], check=True)


main()
