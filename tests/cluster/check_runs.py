"""usage: check_runs.py CLOTHBENCH: `study --list-jobs` and `--job`: parts of a study, run in separate processes, complete it."""
import json
import os
import subprocess
import sys
import tempfile

CLOTHBENCH = sys.argv[1]
STUDY = ["study", "table3", "--quick", "--trials", "1", "--solver", "ballistic"]


def command(*words, code=0):
    done = subprocess.run([CLOTHBENCH, *words], capture_output=True, text=True, check=False)
    assert done.returncode == code, (words, done.returncode, done.stdout, done.stderr)
    return done.stdout + done.stderr


with tempfile.TemporaryDirectory() as home:
    listed = [line.split("\t") for line in command(*STUDY, "--list-jobs").splitlines()]
    names = [name for _, name in listed]
    assert [int(k) for k, _ in listed] == list(range(len(names))) and len(names) >= 3, listed
    assert json.loads(command(*STUDY, "--list-jobs", "--json")) == names
    assert not os.listdir(home)

    out = os.path.join(home, "run")
    made = json.loads(command("--json", *STUDY, "--out", out, "--job", "1"))
    done = {f[:-3] for f in os.listdir(out) if f.endswith(".h5")}
    assert done == {names[1]} and made["ok"] == len(made["runs"]) == 1 and made["runs"][0]["summary"], (done, made)
    with open(os.path.join(out, "study.json"), encoding="utf-8") as text:
        assert json.load(text)["runs"] == names, "study.json lists all runs"
    # Two concurrent processes compute the other runs; one process begins with a run that exists already.
    parts = [subprocess.Popen([CLOTHBENCH, *STUDY, "--out", out, "--job", c]) for c in (f"{names[0]},1", f"2-{len(names) - 1}")]
    assert [p.wait() for p in parts] == [0, 0]
    assert {f[:-3] for f in os.listdir(out) if f.endswith(".h5")} == set(names)
    assert not [f for f in os.listdir(out) if f.endswith(".part")]
    assert "planned, not run" not in command("report", out, "-o", os.path.join(home, "report"))

    for wrong in (str(len(names)), "x", "2-1", "", "1-", "-1"):
        refused = command(*STUDY, "--out", out, "--job=" + wrong, code=2)
        assert f"numbers from 0 to {len(names) - 1}" in refused or wrong == "", wrong
    assert "--out" in command(*STUDY, "--job", "0", code=2)
    apart = ["study", "stability", "--quick", "--solver", "ballistic"]
    jobs = json.loads(command(*apart, "--list-jobs", "--json"))
    out_apart = os.path.join(home, "apart")
    parts = [subprocess.Popen([CLOTHBENCH, *apart, "--out", out_apart, "--job", k]) for k in ("0", "1-2")]
    assert [p.wait() for p in parts] == [0, 0]
    assert {f[:-3] for f in os.listdir(out_apart) if f.endswith(".h5")} == set(jobs[:3])
print("runs in parts: as expected")
