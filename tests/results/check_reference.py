"""What is published holds nothing that must not be printed: times that were not taken alone, values by an older version of a
metric's rule, verdicts by other bounds than the scenes', bytes called counted."""
import csv
import json
import pathlib
import re
import subprocess
import sys

root = pathlib.Path(sys.argv[1])
reference = root / "results/reference"


def run(*command, code=0):
    done = subprocess.run([sys.executable, *map(str, command)], cwd=root, text=True, capture_output=True)
    assert done.returncode == code, (command, done.stdout, done.stderr)


# The README's table is what its script takes from the stored reports.
run("scripts/update_readme.py", "--check")

# Bytes are computed; nowhere are they called counted and not modelled.
files = subprocess.run(["git", "ls-files"], cwd=root, text=True, capture_output=True).stdout.split("\n") if (root / ".git").exists() else []
files = files or [str(p.relative_to(root)) for top in ("harness", "results", "scripts", "solvers") for p in (root / top).rglob("*") if "node_modules" not in p.parts]
wrong = []
for name in files:
    path = root / name
    if path.suffix in (".md", ".hpp", ".h", ".cpp", ".js", ".mjs", ".py", ".txt", ".svg") and path.is_file() and path.name != "check_reference.py":
        text = re.sub(r"\s+", " ", path.read_text(encoding="utf-8", errors="replace"))
        if re.search(r"never modelled|not modelled|[Cc]ounted bytes|[Cc]ounted loads|Bytes are counted,", text):
            wrong.append(name)
assert not wrong, wrong

# The baseline says by which versions it was measured.
cells = json.loads((root / "results/baselines/penetration.json").read_text(encoding="utf-8"))["runs"]
hands = [c for c in cells if c["scene"] == "capsule-sweep"]
assert hands and all(c["metric_versions"]["wrong_side_samples"] == 3 and c["metric_versions"]["contact_length_m"] == 3 for c in hands)
print("ok")
