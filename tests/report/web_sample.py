#!/usr/bin/env python3
"""A small report of CPU solvers for the tests of the page.

usage: web_sample.py CLOTHBENCH OUT     writes OUT/runs/<several> and OUT/report
"""
import os
import pathlib
import shutil
import subprocess
import sys

command, out = sys.argv[1], pathlib.Path(sys.argv[2])
shutil.rmtree(out, ignore_errors=True)
os.environ["CLOTHBENCH_JOBS"] = "1"  # other tests run at the same time; the times are not used as measurements
solvers = ["--solver", "bullet-soft", "ballistic"]


def clothbench(*arguments):
    result = subprocess.run([command, *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if result.returncode:
        sys.exit(f"clothbench {' '.join(arguments)}: exit {result.returncode}\n{result.stdout[-2000:]}")


runs = out / "runs"
runs.mkdir(parents=True)
clothbench("study", "table3", "--quick", "--trials", "1", *solvers, "--out", str(runs / "table3"))
contact = ["contact/" + name for name in ("sphere", "box", "plane", "open-sheet")]
paper = ["paper/" + name for name in ("desk-corner-low", "capsule-sweep", "hand-push", "two-hand-stretch-2mps")]
clothbench("run", *contact, *paper, *solvers, "--set", "cloth.grid=[17,13]", "--set", "time.duration_s=0.75",
           "--out", str(runs / "contact"))
for steps in "1", "4":
    clothbench("run", "validation/free-fall", "--solver", "bullet-soft", "--set", f"solver.substeps={steps}",
               "--out", str(runs / f"truth-{steps}"))
clothbench("report", *map(str, sorted(runs.iterdir())), "-o", str(out / "report"))
