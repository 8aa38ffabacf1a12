#!/usr/bin/env python3
"""Checks the results of a stability study, from `clothbench --json study` and `clothbench report` of its folder.

usage: check_stability.py SUMMARY.json REPORT_FOLDER [SOLVER]

Every run ends in a row and no process died; SOLVER (xpbd) is finite, bounded and gains no energy in every case. A file, column or row that is missing fails, because it would have shown nothing.
"""
import csv
import json
import pathlib
import sys

NEVER = {"F0": "not finite or out of all bounds", "F1": "energy gained", "F2": "strain beyond the load"}
GRADES = {"0", "1", "2"}  # stable, degraded, failed


def faults_of(summary, runs, solver):
    crashed = json.loads(summary.read_text(encoding="utf-8"))["crashed"]
    if crashed != 0:
        yield f"{summary}: {crashed} processes crashed or hung; expected 0"
    with runs.open(newline="", encoding="utf-8") as f:
        rows = list(csv.DictReader(f))
    where = lambda r: f"{runs}: {r['scene']} {r['solver']} {r['setting']}"
    yield from (f"{where(r)}: planned, not run" for r in rows if r["status"] == "missing")
    ran = [r for r in rows if r["solver"] == solver and r["status"] not in ("unsupported", "missing")]
    if not ran:
        yield f"{runs}: no run of {solver}"
    for r in ran:
        if r["stability_grade"] not in GRADES:
            yield f"{where(r)}: status {r['status']} without a grade"
        if r["class"] in NEVER:
            yield f"{where(r)}: {r['class']}, {NEVER[r['class']]}"


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    solver = sys.argv[3] if len(sys.argv) == 4 else "xpbd"
    faults = list(faults_of(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2], "runs.csv"), solver))
    if faults:
        sys.exit("\n".join([*faults, f"stability: {solver} is to be finite and bounded in every case"]))
    print(f"stability: {solver} is finite and bounded in every case, and no process died")


if __name__ == "__main__":
    main()
