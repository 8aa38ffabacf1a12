"""scripts/publish.sh resumes, skips complete studies and refuses mixed sources; the published files have one commit and the stated hashes.
usage: check_publish.py ROOT CLOTHBENCH"""
import csv
import lzma
import os
import pathlib
import re
import subprocess
import sys
import tempfile

root, bench = pathlib.Path(sys.argv[1]), sys.argv[2]
# Replaces clothbench in steps that take long or fail: the limit interrupts the first call of a study.
STUB = """#!/bin/bash
[ "$1" != --version ] || { echo "clothbench 0 (c), sources $SOURCES"; exit; }
[ "$1" != list ] || { echo "$ASSETS"; exit; }
echo "$*" >>"$CALLS"
[ "$1 $2" != 'study hang' ] || exit 5
while [ $# -gt 1 ]; do [ "$1" != --out ] || out=$2; shift; done
if [ ! -d "$out" ]; then mkdir "$out"; trap 'exit 130' INT; sleep 60 & wait; fi
echo data >"$out/a.h5"
exit 1
"""


def call(*words, program=bench, **environment):
    done = subprocess.run([str(root / "scripts/publish.sh"), *map(str, words)], text=True, capture_output=True, env={**os.environ, "CLOTHBENCH": str(program), **environment}, check=False)
    return done.returncode, done.stdout + done.stderr


def verified(folder, list_name):
    done = subprocess.run(["sha256sum", "--quiet", "-c", list_name], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


with tempfile.TemporaryDirectory() as scratch:
    scratch = pathlib.Path(scratch)
    stub, calls, out = scratch / "stub", scratch / "calls", scratch / "out"
    stub.write_text(STUB)
    stub.chmod(0o755)
    table3 = (out, "--table", "quick", "--only", "table3")
    with_stub = {"program": stub, "CALLS": str(calls), "SOURCES": "1", "ASSETS": "npm"}
    code, said = call(*table3, "--limit", 3, **with_stub)
    assert code == 75 and "call again to continue" in said, (code, said)
    code, said = call(*table3, **with_stub)  # rows that crashed (status 1) are results
    assert code == 0 and calls.read_text().splitlines()[-1].endswith("--resume"), (code, said)
    n = len(calls.read_text().splitlines())
    assert call(*table3, **with_stub)[0] == 0 and len(calls.read_text().splitlines()) == n, "a complete study was run again"
    code, said = call(*table3, **{**with_stub, "SOURCES": "2"})
    assert code == 2 and "one state of the sources" in said, (code, said)
    code, said = call(out, "--table", "gpu", "--only", "physics", "--limit", 3, **with_stub)  # the stub's commit is "c"
    assert code == 75 and "--seed 12 --count 300 " in calls.read_text().splitlines()[-1], (code, said)
    code, said = call(out, "--table", "gpu", **{**with_stub, "ASSETS": "procedural   x is missing"})
    assert code == 2 and "rooms and hands are missing" in said, (code, said)
    code, said = call(out, "--table", "quick", "--only", "hang", **with_stub)
    assert code == 5 and "hang: exit status 5" in said, (code, said)
    for words, why in ((["--limit", "x"], "positive whole number"), (["--table", "none"], "expected gpu, software, peers or quick"), (["--only", "none"], "has no such study"), (["--only"], "expected a value"), (["--x"], "expected --table")):
        code, said = call(out, *words, **with_stub)
        assert code == 2 and why in said, (words, code, said)

    # The program itself: one study, and the published files made from it.
    real, to = scratch / "real", scratch / "to"
    code, said = call("--report", real, "--to", to)
    assert code == 2 and "no file \"version\"" in said, (code, said)
    code, said = call(real, "--table", "quick", "--only", "hang")
    assert code == 0, said
    archive = scratch / "all.tar.xz"
    code, said = call("--report", real, "--to", to, "--archive", archive)
    assert code == 0, said
    subprocess.run(["tar", "-C", scratch, "--one-top-level=unpacked", "-xf", archive], check=True)
    verified(scratch / "unpacked", "RESULTS.SHA256")
    verified(to, "SHA256SUMS")
    verified(real, to / "RESULTS.SHA256")
    assert re.fullmatch(r"study\tseconds\tcommand\nhang\t\d+\tclothbench study hang .*\n", (to / "commands.tsv").read_text())
    assert "hang-32" in lzma.open(to / "hang/runs.csv.xz", "rt").read() and "<html" in (to / "index.html").read_text(encoding="utf-8")
    pictures = re.findall(r"!\[.*\]\((.+)\)", (to / "hang/report.md").read_text(encoding="utf-8"))
    assert pictures and all((to / "hang" / name).exists() for name in pictures), pictures
    (to / "hang/report.md").write_text("changed")
    assert subprocess.run(["sha256sum", "--status", "-c", "SHA256SUMS"], cwd=to, capture_output=True, check=False).returncode == 1

for name in ("h200", "h200-later", "h200-contact", "h200-reproduction", "peers"):
    published = root / "results/reference" / name
    verified(published, "SHA256SUMS")
    listed = {line.split(maxsplit=1)[1] for line in (published / "SHA256SUMS").read_text().splitlines()}
    here = {p.relative_to(published).as_posix() for p in published.rglob("*") if p.is_file()} - {"SHA256SUMS"}
    assert listed == here, listed ^ here
    rows = [row for p in published.glob("*/runs.csv.xz") for row in csv.DictReader(lzma.open(p, "rt")) if row["status"] != "missing"]
    states = {(row["git_commit"], row["source_sha256"], row["git_dirty"]) for row in rows}
    assert rows and len(states) == 1 and states.pop()[2] == "false", "expected runs of one commit, without local changes"

size = sum(p.stat().st_size for p in (root / "results/reference/h200").rglob("*") if p.name in ("index.html", "runs.csv.xz"))
assert size <= 6e6, f"page and run tables have {size / 1e6} MB"

# C11 compares with NvCloth's roughness in the published sweep.
runs = list(csv.DictReader(lzma.open(root / "results/reference/h200/penetration/runs.csv.xz", "rt")))
limit = float(re.search(r"kEngineRoughness = ([0-9.]+)", (root / "harness/report/views_reproduction.cpp").read_text(encoding="utf-8"))[1])
engine = next(float(row["roughness_end"]) for row in runs if row["scene"] == "capsule-sweep" and row["solver"] == "nvcloth")
assert abs(limit - engine) < 5e-5, (limit, engine)
print("ok")
