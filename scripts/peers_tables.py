#!/usr/bin/env python3
"""The tables of solvers/plugin/PEERS.md, in Markdown.

    scripts/peers_tables.py hang PEER_TIME [--sizes 32,64,128] [--seeds 5] PLUGIN.so[,setting=value…]…
    scripts/peers_tables.py contact CLOTHBENCH [--scenes contact/box,…] SOLVER[,setting=value…]…

hang: thread CPU time of a frame [ms] and greatest stretch of the last second [%] of `validation/hang`, measured by peer_time
(solvers/plugin/peer_time.cpp, built beside each plugin): medians over seeds, with the lowest and the highest in brackets.

contact: for each solver and scene the distance at which it holds the cloth [mm], the greatest length of the contour along which
the cloth passes through colliders [m], the greatest depth [mm] and the share of vertices that went through [%]. "unsupported"
where the solver cannot run the scene.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

def run(clothbench, solver, scene, out):
    """Summary of a run without trials; None where the solver cannot run the scene."""
    import h5py  # not for `hang`, which reads no files

    name, *settings = solver.split(",")
    command = [clothbench, "run", scene, "--solver", name, "--trials", "0", "--out", out]
    for setting in settings:
        command += ["--set", "solver." + setting]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    (file,) = list(pathlib.Path(out).glob("*.h5")) or sys.exit(done.stdout)
    with h5py.File(file) as f:
        outcome = dict(f["outcome"].attrs)
        if outcome["status"] == "unsupported":
            return None
        if outcome["status"] != "ok":
            sys.exit(f"{solver} on {scene}: {outcome['status']} {outcome['message']}")
        summary = dict(f["summary"].attrs)
        summary["margins"] = [m["margin_m"] for m in (json.loads(f["header_json"][0])["plan"] or {}).get("contact_margins", [])]
        return summary


def measured(peer_time, plugin, size, seed):
    """CPU time of a frame [ms] and greatest stretch [%]."""
    library, *settings = plugin.split(",")
    command = [peer_time, library, str(size), str(seed), *settings]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        sys.exit(done.stderr)
    return [float(x) for x in done.stdout.split()]


def spread(values, digits):
    return f"{statistics.median(values):.{digits}g} ({min(values):.{digits}g}–{max(values):.{digits}g})"


def label(solver):
    name, *settings = solver.split(",")
    return " ".join([pathlib.Path(name).stem.replace("libclothbench_", ""), *settings])


def hang(a):
    sizes = [int(n) for n in a.sizes.split(",")]
    print("| solver | " + " | ".join(f"{n}²: ms | {n}²: stretch %" for n in sizes) + " |")
    print("|---|" + "--:|" * (2 * len(sizes)))
    for solver in a.solver:
        cells = []
        for size in sizes:
            found = [measured(a.program, solver, size, seed) for seed in range(a.seeds)]
            cells += [spread(list(column), 2) for column in zip(*found)]
        print(f"| {label(solver)} | " + " | ".join(cells) + " |", flush=True)


def contact(a):
    scenes = a.scenes.split(",")
    print("| solver | holds at | " + " | ".join(scenes) + " |")
    print("|---|--:|" + "--:|" * len(scenes))
    for solver in a.solver:
        cells, margins = [], set()
        for scene in scenes:
            with tempfile.TemporaryDirectory() as out:
                found = run(a.program, solver, scene, out)
            if found is None:
                cells.append("unsupported")
                continue
            margins.update(round(1000 * m, 3) for m in found["margins"])
            numbers = (found["contact_length_max_m"], 1000 * found["depth_max_m"], 100 * found["tunnelled_fraction_max"])
            cells.append(", ".join("–" if x != x else f"{x:.2g}{unit}" for x, unit in zip(numbers, (" m", " mm", " %"))))
        held = " to ".join(f"{m:g}" for m in sorted({min(margins), max(margins)})) if margins else "–"
        print(f"| {label(solver)} | {held} mm | " + " | ".join(cells) + " |", flush=True)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("table", choices=("hang", "contact"))
    arguments.add_argument("program", help="peer_time or clothbench")
    arguments.add_argument("solver", nargs="+")
    arguments.add_argument("--sizes", default="32,64,128")
    arguments.add_argument("--scenes", default="contact/sphere,contact/box,contact/open-sheet,paper/desk-flat-high,paper/capsule-sweep")
    arguments.add_argument("--seeds", type=int, default=5)
    a = arguments.parse_args()
    os.environ["CLOTHBENCH_JOBS"] = "1"
    {"hang": hang, "contact": contact}[a.table](a)


if __name__ == "__main__":
    main()
