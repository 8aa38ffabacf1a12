#!/usr/bin/env python3
"""Checks the results of a stability study, from `clothbench --json study` and `clothbench report` of its folder.

usage: check_stability.py SUMMARY.json REPORT_FOLDER [SOLVER]

Every run ends in a row and no process died; SOLVER (xpbd) is finite, bounded and gains no energy in every case. A file, column or row that is not there fails: it would have shown nothing.
"""
import csv
import json
import pathlib
import sys

CELLS = ("scene", "solver", "setting", "status", "stability_grade", "class")
NEVER = {"F0": "not finite", "F1": "speed out of all bounds", "F2": "energy gained"}
GRADES = {"0", "1", "2"}  # stable, degraded, failed


def table(path, columns, faults):
    if not path.is_file():
        faults.append(f"{path}: no such file")
        return []
    with path.open(newline="", encoding="utf-8") as f:
        reader = csv.DictReader(f)
        lacking = [c for c in columns if c not in (reader.fieldnames or [])]
        rows = list(reader)
    if lacking:
        faults.append(f"{path}: no column {', '.join(lacking)}")
        return []
    if not rows:
        faults.append(f"{path}: no rows")
    return rows


def check_summary(path, faults):
    try:
        crashed = json.loads(path.read_text(encoding="utf-8"))["crashed"]
    except (OSError, ValueError, KeyError, TypeError) as e:
        faults.append(f"{path}: expected the study's summary with \"crashed\": {e!r}")
        return
    if type(crashed) is not int or crashed != 0:
        faults.append(f"{path}: {crashed} processes crashed or hung; expected 0")


def check_runs(path, solver, faults):
    rows = table(path, CELLS, faults)
    mine = [r for r in rows if r["solver"] == solver]
    if rows and not any(r["status"] not in ("unsupported", "missing") for r in mine):
        faults.append(f"{path}: no run of {solver}")
    faults += [f"{path}: {r['scene']} {r['solver']} {r['setting']}: planned, not run" for r in rows if r["status"] == "missing"]
    for r in mine:
        where = f"{path}: {r['scene']} {solver} {r['setting']}"
        if r["status"] in ("unsupported", "missing"):
            continue
        if r["stability_grade"] not in GRADES:
            faults.append(f"{where}: status {r['status']} without a grade")
        if r["class"] in NEVER:
            faults.append(f"{where}: {r['class']}, {NEVER[r['class']]}")


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    solver = sys.argv[3] if len(sys.argv) == 4 else "xpbd"
    report, faults = pathlib.Path(sys.argv[2]), []
    check_summary(pathlib.Path(sys.argv[1]), faults)
    check_runs(report / "runs.csv", solver, faults)
    for fault in faults:
        print(fault, file=sys.stderr)
    if faults:
        sys.exit(f"stability: {solver} is to be finite and bounded in every case")
    print(f"stability: {solver} is finite and bounded in every case, and no process died")


if __name__ == "__main__":
    main()
