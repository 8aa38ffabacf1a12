#!/usr/bin/env python3
"""A small report of CPU solvers for the tests of the page.

usage: web_sample.py CLOTHBENCH OUT     writes OUT/runs/<several> and OUT/report
"""
import json
import pathlib
import shutil
import subprocess
import sys

command, out = sys.argv[1], pathlib.Path(sys.argv[2])
shutil.rmtree(out, ignore_errors=True)
solvers = ["--solver", "bullet-soft", "ballistic"]


def clothbench(*arguments):
    result = subprocess.run([command, *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if result.returncode:
        sys.exit(f"clothbench {' '.join(arguments)}: exit {result.returncode}\n{result.stdout[-2000:]}")


runs = out / "runs"
runs.mkdir(parents=True)
clothbench("study", "table3", "--quick", "--trials", "1", *solvers, "--out", str(runs / "table3"), "--allow-no-device")
contact = ["contact/" + name for name in ("sphere", "box", "plane", "open-sheet")]
paper = ["paper/" + name for name in ("desk-corner-low", "capsule-sweep", "hand-push", "two-hand-stretch-2mps")]
clothbench("run", *contact, *paper, *solvers, "--set", "cloth.grid=[17,13]", "--set", "time.duration_s=0.75",
           "--out", str(runs / "contact"))
for steps in "1", "4":
    clothbench("run", "validation/free-fall", "--solver", "bullet-soft", "--set", f"solver.substeps={steps}",
               "--out", str(runs / f"truth-{steps}"))
# Maps as a stability study leaves them, small enough for a test: every class, a row whose seeds differ, a theory, and a solver
# that cannot run it.
classes = ["ok"] + [f"F{k}" for k in range(9)]
probes = [{"x": 10.0 ** (k - 3), "y": y, "seed": seed, "status": "ok", "class": c, "grade": 0 if c == "ok" else 2, "frame": k, "message": "<b>"}
          for k, c in enumerate(classes) for y in (1.0, 8.0) for seed in (0, 1)]
rows = [{"y": 1.0, "seeds": [{"last_good": 1e-3, "first_bad": 2e-3}, {"last_good": 2e-3, "first_bad": 4e-3}]},
        {"y": 8.0, "seeds": [{"last_good": 0, "first_bad": 1e-3}]}]
runs_it = {"setting": "default", "unsupported": False, "probes": probes, "rows": rows, "largest": 1e-3, "open": False, "message": ""}
cannot = {**runs_it, "solver": "reference", "unsupported": True, "probes": [], "rows": [], "largest": None, "open": True}
maps = [{"name": name, "title": f"Map {name}", "headline": "largest stable step", "x": {"label": "step", "unit": "s"},
         "y": {"label": "ratio", "unit": ""}, "theory": [{"name": "explicit-limit", "label": "explicit", "points": [[1e-3, 1], [1e-2, 8]]}],
         "solvers": solvers_of}
        for name, solvers_of in (("one", [{**runs_it, "solver": "xpbd"}, {**runs_it, "solver": "paper"}, cannot]), ("two", [cannot]))]
(runs / "table3" / "stability.json").write_text(json.dumps({"format": "clothbench-stability", "format_version": 1, "maps": maps}))
clothbench("report", *map(str, sorted(runs.iterdir())), "-o", str(out / "report"))
