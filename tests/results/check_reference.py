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


# The stored reports are what renewing makes of them, and the README's table what it takes from them.
run("scripts/renew_reference.py", "--check", *sorted(p.relative_to(root) for p in reference.iterdir() if p.is_dir()))
run("scripts/update_readme.py", "--check")

# Side by side: no time of Bullet beside the GPU solvers' in the report, none in the files.
penetration = (reference / "penetration-h200/report.md").read_text(encoding="utf-8")
rows = [[c.strip() for c in line.split("|")] for line in penetration.splitlines() if line.startswith("| ")]
head = None
seen = 0
for row in rows:
    head = row if row[1] == "scene" else head
    if "wall / GPU [ms]" in head and row is not head and row[2].startswith("bullet"):
        assert row[head.index("wall / GPU [ms]")] == "–", row
        seen += 1
    if "wrong side [samples]" in head and row is not head:
        assert row[head.index("wrong side [samples]")] == "–", row
assert seen >= 20, seen
for name in ("cells", "memory"):
    with open(reference / f"penetration-h200/{name}.csv", encoding="utf-8", newline="") as f:
        for r in csv.DictReader(f):
            if r["solver"].startswith("bullet") and r["status"] == "ok":
                assert not any(r.get(c) for c in ("frame_wall_median_s", "fps_median", "load_s", "wrong_side_samples_max")), (name, r["scene"], r["solver"])
                assert "side by side" in r["withheld"], (name, r["scene"], r["solver"])

# An edge at 12 times its length is kept by no table.
hands_hold = penetration[penetration.index("### Hands hold and pull"):].split("\n### ")[0]
for line in hands_hold.splitlines():
    if line.startswith("| two-hand-stretch") and "| paper |" in line and "mps" in line:
        assert line.rstrip(" |").endswith("broken"), line

# Bytes are computed; nowhere are they called counted and not modelled.
files = subprocess.run(["git", "ls-files"], cwd=root, text=True, capture_output=True).stdout.split("\n") if (root / ".git").exists() else []
files = files or [str(p.relative_to(root)) for top in ("harness", "results", "scripts", "solvers") for p in (root / top).rglob("*") if "node_modules" not in p.parts]
wrong = []
for name in files:
    path = root / name
    if path.suffix in (".md", ".hpp", ".h", ".cpp", ".js", ".mjs", ".py", ".txt", ".svg") and path.is_file() and path.name != "check_reference.py" and path.name != "renew_reference.py":
        text = re.sub(r"\s+", " ", path.read_text(encoding="utf-8", errors="replace"))
        if re.search(r"never modelled|not modelled|[Cc]ounted bytes|[Cc]ounted loads|Bytes are counted,", text):
            wrong.append(name)
assert not wrong, wrong

# The baseline says by which versions it was measured.
cells = json.loads((root / "results/baselines/penetration.json").read_text(encoding="utf-8"))["runs"]
hands = [c for c in cells if c["scene"] == "capsule-sweep"]
assert hands and all(c["metric_versions"] == {"wrong_side_fraction": 2, "wrong_side_samples": 2} for c in hands)
print("ok")
