#!/usr/bin/env python3
"""A small report for the tests of the page: of CPU solvers, and of copies of their results with made-up values of a GPU solver.

usage: web_sample.py CLOTHBENCH OUT     writes OUT/runs/<several> and OUT/report
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys

import h5py

command, out = sys.argv[1], pathlib.Path(sys.argv[2])
shutil.rmtree(out, ignore_errors=True)
os.environ["CLOTHBENCH_JOBS"] = "1"  # other tests run at the same time; the times are not used as measurements
solvers = ["--solver", "bullet-soft", "ballistic"]
MADE_UP = {"device_memory_B": 1.234567e6, "read_B_per_frame": 2.345678e6, "write_B_per_frame": 3.456789e5, "bandwidth_read_peak_B_per_s": 4.567891e9, "bandwidth_write_peak_B_per_s": 5.678912e8,
           "bandwidth_window_s": 0.123, "dispatches": 14, "reference_uncertainty": 1e-5, "reference_truth_distance": 2e-6, "reference_order_bdf2": 1.97, "truth_space_error": 1e-4, "reference_spread": 3e-6, "reference_order_xpbd": 0.87}


def clothbench(*arguments):
    result = subprocess.run([command, *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if result.returncode:
        sys.exit(f"clothbench {' '.join(arguments)}: exit {result.returncode}\n{result.stdout[-2000:]}")


def add_gpu(folder, of):
    """Copies some runs of a solver as runs of xpbd that meet every criterion."""
    study, copies = json.loads((folder / "study.json").read_text()), folder.with_name(f"{folder.name}-gpu")
    left_out = ("box", "plane", "open", "capsule", "two-hand", "gravity-8")
    study["runs"] = [name.replace(of, "xpbd") for name in study["runs"] if f"__{of}__" in name and not name.startswith(left_out)]
    copies.mkdir()
    (copies / "study.json").write_text(json.dumps(study))
    for k, name in enumerate(study["runs"]):
        shutil.copy(folder / f"{name.replace('xpbd', of)}.h5", copies / f"{name}.h5")
        with h5py.File(copies / f"{name}.h5", "r+") as f:
            header, values = json.loads(f["header_json"][0]), f["summary"].attrs
            header["environment"].update(gpu="Made-up GPU (no device)", solver_features={"ignores": [], "supports": ["stretch", "friction"], "only_with": [["friction", "sphere"]]})
            f.attrs["solver"], f["header_json"][0], f["outcome"].attrs["expect"] = "xpbd", json.dumps({**header, "solver": "xpbd"}), "pass"
            values.update({n: (k + 1) * v for n, v in MADE_UP.items()} | {n: 1.0 for n in values if n.startswith("expect.")})
            if "timing" in f:
                f["timing/frame_device_s"][:] = 0.25 * f["timing/frame_wall_s"][:]
                values.update(frame_pipelined_median_s=0.8 * values["frame_wall_median_s"], frame_device_median_s=0.25 * values["frame_wall_median_s"], truth_error=0.1 * values.get("truth_error", float("nan")))


runs = out / "runs"
runs.mkdir(parents=True)
clothbench("study", "table3", "--quick", "--trials", "1", *solvers, "--out", str(runs / "table3"))
contact = ["contact/sphere", "contact/box", "contact/plane", "contact/open-sheet", "paper/desk-corner-low", "paper/capsule-sweep", "paper/hand-push", "paper/two-hand-stretch-2mps"]
clothbench("run", *contact, *solvers, "--set", "cloth.grid=[17,13]", "--set", "time.duration_s=0.75", "--out", str(runs / "contact"))
for steps in "1", "4":
    clothbench("run", "validation/free-fall", "--solver", "bullet-soft", "--set", f"solver.substeps={steps}", "--out", str(runs / f"truth-{steps}"))
clothbench("run", "conformance/sheet", "stability/s01-stiffness", "stability/s02-step-fall", *solvers, "--out", str(runs / "more"))
clothbench("study", "contact", "--procedural", "--count", "2", "--solver", "ballistic", "--out", str(runs / "random"))
for folder, solver in ("contact", "ballistic"), ("random", "ballistic"), ("table3", "ballistic"), ("truth-1", "bullet-soft"), ("truth-4", "bullet-soft"):
    add_gpu(runs / folder, solver)
checked, log = [str(runs / "contact-gpu"), "--baseline", str(out / "baseline.json")], out / "log.jsonl"
clothbench("check", *checked, "--update")
clothbench("check", *checked, "--log", str(log))
log.write_text(json.dumps({**json.loads(log.read_text()), "commit": "0123456789"}) + "\n" + log.read_text())
clothbench("report", *map(str, sorted(runs.iterdir())), "-o", str(out / "report"), "--history", str(log))
