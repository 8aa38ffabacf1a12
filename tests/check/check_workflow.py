"""Checks the workflow file for users: its YAML, its shell, and that what it calls is there.

usage: check_workflow.py WORKFLOW.yml CLOTHBENCH SOURCE_FOLDER
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import yaml


def add_solver(script, env, source):
    """Runs the step that adds the solver on a copy of solvers/CMakeLists.txt."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        (folder / env["SOLVER_FOLDER"]).mkdir()
        (folder / env["SOLVER_FOLDER"] / "CMakeLists.txt").write_text("")
        solvers = folder / "clothbench" / "solvers"
        solvers.mkdir(parents=True)
        (solvers / "CMakeLists.txt").write_text((source / "solvers/CMakeLists.txt").read_text())
        github_env = folder / "env"
        subprocess.run(["bash", "-e", "-o", "pipefail", "-c", script], cwd=folder, check=True,
                       env=os.environ | env | {"GITHUB_ENV": str(github_env)})
        name = env["SOLVER_FOLDER"]
        assert (solvers / name / "CMakeLists.txt").exists()
        lines = (solvers / "CMakeLists.txt").read_text().splitlines()
        last = max(i for i, line in enumerate(lines) if line.startswith("clothbench_add_solver("))
        assert lines[last] == f"clothbench_add_solver({name})", lines[last]
        assert lines.index("configure_file(registry.cpp.in registry.cpp @ONLY)") > last
        option = "CLOTHBENCH_WITH_" + name.replace("-", "_").upper()
        assert github_env.read_text() == f"SOLVER_OPTION=-D{option}=ON\n", github_env.read_text()


def check_kinds(steps):
    """What a plugin needs not be built at every push; what is compiled in is."""
    by_name = {s.get("name", s.get("uses")): s for s in steps}
    order = [s.get("name", s.get("uses")) for s in steps]
    plugin = "startsWith(env.SOLVER, 'plugin:')"
    assert by_name["actions/cache@v4"]["if"] == by_name["Build the plugin"]["if"] == plugin
    assert by_name["Add the solver"]["if"] == "${{ !%s }}" % plugin
    assert by_name["Package"]["if"] == "steps.package.outputs.cache-hit != 'true'" and by_name["actions/cache@v4"]["id"] == "package"
    names = ["actions/cache@v4", "Add the solver", "Package", "Install", "Build the plugin", "Study", "Check"]
    assert [name for name in order if name in names] == names, order
    made = re.search(r"-B \.\./(\w+)", by_name["Package"]["run"]).group(1)  # from clothbench/
    assert made == by_name["actions/cache@v4"]["with"]["path"] and f"./{made}/clothbench_*.deb" in by_name["Install"]["run"]


def main():
    workflow, clothbench, source = pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3])
    y = yaml.safe_load(workflow.read_text(encoding="utf-8"))
    assert set(y) == {"name", True, "env", "jobs"}, set(y)  # YAML 1.1 reads the key `on` as true
    job = y["jobs"]["check"]
    assert job["container"] == "debian:12" and job["defaults"]["run"]["shell"] == "bash"
    commands = 0
    for step in job["steps"]:
        assert ("run" in step) != ("uses" in step), step
        if "uses" in step:
            assert re.fullmatch(r"[\w-]+/[\w-]+@v\d+", step["uses"]), step["uses"]
            continue
        script = step["run"]
        subprocess.run(["bash", "-n", "-c", script], check=True)
        for path in re.findall(r"\bscripts/[\w./-]+", script):
            assert os.access(source / path, os.X_OK), path
        for preset in re.findall(r"--preset (\w+)", script):
            presets = json.loads((source / "CMakePresets.json").read_text())
            assert preset in [p["name"] for p in presets["configurePresets"]], preset
        for line in script.replace("\\\n", " ").splitlines():
            if not line.strip().startswith("clothbench "):
                continue
            commands += 1
            verb = line.split()[1]
            help_text = subprocess.run([clothbench, verb, "--help"], check=True, capture_output=True, text=True).stdout
            for flag in re.findall(r"--[a-z-]+", line):
                assert re.search(flag + r"\b", help_text), f"{verb} has no {flag}"
    assert commands == 2, commands
    check_kinds(job["steps"])
    add_solver(next(s["run"] for s in job["steps"] if s.get("name") == "Add the solver"), y["env"], source)


if __name__ == "__main__":
    main()
