#!/usr/bin/env python3
"""Checks what keeps the code easy to read: includes go one way, rooms stay within their lines, one metric group per file, short files and functions, one format.

Prints one line per fault and exits with 1. If there is no fault but a needed program is missing, it exits with 77 (skipped).
"""
import ast
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUDGET = Path(__file__).with_name("lines.txt")

# A room may include rooms before it in this list and the public interface (include/clothbench).
ROOMS = ["base", "assets", "scenario", "truth", "metrics", "results", "runner", "report", "check", "render", "xr", "cli", "android"]
SOLVERS_MAY_INCLUDE = {"base", "clothbench"}
MAX_FILE_LINES, MAX_FUNCTION_LINES = 400, 60
# A table with one row per entry, and a macro that pmccabe takes for a function head.
LONG_ON_PURPOSE = {"clothbench::metrics", "__attribute__"}
CODE = (".cpp", ".hpp", ".h", ".glsl", ".comp", ".js", ".mjs", ".py", ".sh", ".cmake")


def files(*patterns):
    out = subprocess.run(["git", "-C", ROOT, "ls-files", "-z", "--", *patterns], capture_output=True, check=True, text=True).stdout
    return [f for f in out.split("\0") if f and (ROOT / f).exists()]


def lines_of(path):
    return (ROOT / path).read_text(encoding="utf-8").splitlines()


def wrong_includes():
    early = re.search(r"harness/{(.*)}/all", (ROOT / "scripts/common.sh").read_text())[1].split(",")
    yield from (f"scripts/common.sh: {r} contains the page, which npm bundles; build it later" for r in early if ROOMS.index(r) >= ROOMS.index("report"))
    for path in files("harness/*.cpp", "harness/*.hpp", "harness/*.in", "solvers/*.cpp", "solvers/*.hpp"):
        top, room = path.split("/")[:2]
        for line in lines_of(path):
            other = (re.match(r'#include "([^/"]+)/', line) or [0, None])[1]
            if other not in ROOMS:
                continue
            if top == "solvers" and other not in SOLVERS_MAY_INCLUDE:
                yield f"{path}: a solver may include the public interface and base, not {other}"
            elif top == "harness" and room in ROOMS and ROOMS.index(other) > ROOMS.index(room):
                yield f"{path}: {room} may not include {other}, which stands above it"


def rooms_over_budget():
    """Compares scripts/count_lines.sh with lines.txt, which has one row per room: its name and its maximum."""
    counted = subprocess.run([ROOT / "scripts/count_lines.sh"], capture_output=True, check=True, text=True).stdout
    now = {name: int(n) for kind, name, n in map(str.split, counted.splitlines()) if kind != "language"}
    most = {name: int(n) for name, n in (row.split() for row in BUDGET.read_text().splitlines() if row and row[0] != "#")}
    for name in sorted(now.keys() | most.keys()):
        if name not in most or name not in now:
            yield f"{BUDGET.name}: {name}: {'no such room' if name in most else 'a room without a budget'}"
        elif now[name] > most[name]:
            yield f"{name}: {now[name]} lines; at most {most[name]} ({BUDGET.name})"


def misplaced_metrics():
    """A metric group stands in the file of its name in measures/, where CMake finds it."""
    found = [(path, name) for path in files("harness/metrics/*.cpp") for name in re.findall(r"^MetricGroup (\w+)_metrics\(\)", "\n".join(lines_of(path)), flags=re.M)]
    for path, name in found:
        if path != f"harness/metrics/measures/{name}.cpp":
            yield f"{path}: {name}_metrics(): expected in harness/metrics/measures/{name}.cpp"
    if len(found) < 5:
        yield f"harness/metrics: {len(found)} metric groups found; expected at least 5"


def long_files():
    for path in files("harness/*", "solvers/*", "scripts/*"):
        if path.endswith(CODE) and (n := len(lines_of(path))) > MAX_FILE_LINES:
            yield f"{path}: {n} lines; at most {MAX_FILE_LINES}"


def functions():
    """(where, name, lines): C++ by pmccabe, Python by its parser, other code by first and last lines that start in the first column."""
    if shutil.which("pmccabe"):
        sources = files("harness/*.cpp", "harness/*.hpp", "solvers/*.cpp", "solvers/*.hpp")
        out = subprocess.run(["pmccabe", *sources], cwd=ROOT, capture_output=True, text=True, check=False).stdout
        for fields in (row.split("\t") for row in out.splitlines()):  # complexity twice, statements, first line, lines, file(line): name
            yield (*fields[5].split(": ", 1), int(fields[4]))
    for path in files("harness/*.py", "scripts/*.py"):
        for node in ast.walk(ast.parse((ROOT / path).read_text())):
            if isinstance(node, ast.FunctionDef):
                yield f"{path}({node.lineno})", node.name, node.end_lineno - node.lineno + 1
    for path in files("harness/*.js", "harness/*.mjs", "scripts/*.sh", *(f"{top}/*.{kind}" for top in ("harness", "solvers") for kind in ("comp", "frag", "vert", "glsl"))):
        first, name = 0, ""
        for k, line in enumerate(lines_of(path), 1):
            if match := re.match(r"(?:export |async |function\*? )*(?:\w+ )?(\w+)\(.*", line):
                first, name = k, match[1]
            elif line.startswith("}") and first:
                yield f"{path}({first})", name, k - first + 1
                first = 0


def long_functions():
    count = 0
    for where, name, n in functions():
        count += 1
        if n > MAX_FUNCTION_LINES and name not in LONG_ON_PURPOSE:
            yield f"{where}: {name}: {n} lines; at most {MAX_FUNCTION_LINES}"
    if count < 1000:
        yield f"{count} functions found; expected at least 1000"


def unformatted():
    if shutil.which("clang-format-14"):
        out = subprocess.run(["clang-format-14", "--dry-run", *files("*.cpp", "*.hpp", "*.h")], cwd=ROOT, capture_output=True, text=True, check=False).stderr
        for name in sorted({line.split(":")[0] for line in out.splitlines() if "[-Wclang-format-violations]" in line}):
            yield f"{name}: not formatted (clang-format-14 -i {name})"


def main():
    faults = [f for check in (wrong_includes, rooms_over_budget, misplaced_metrics, long_files, long_functions, unformatted) for f in check()]
    missing = [program for program in ("pmccabe", "clang-format-14") if not shutil.which(program)]
    print("\n".join(faults) or (f"skipped: no {', '.join(missing)}" if missing else "includes, lines, metrics, lengths and format: no fault"))
    return 1 if faults else 77 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
