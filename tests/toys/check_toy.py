#!/usr/bin/env python3
"""A toy in the form of a patch: it applies to this tree and touches few product files (what a documents' script writes is none). With
--build the patched tree is built, and what the registry, the documents and the schema then say of the toy is looked at.

usage: check_toy.py [--build] <patch> <most product files>
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PRODUCT = re.compile(r"\.(cpp|hpp|c|h|in|glsl|comp|vert|frag|js|mjs|py|sh|cmake)$|CMakeLists\.txt$")
LEAN = ["PBD_GPU", "BULLET_BASELINE", "REFERENCE", "PLUGINS", "BENCH", "RENDER", "XR", "PAGE"]
ASIDE = shutil.ignore_patterns("build", ".git", "node_modules", "runs")


def run(*command, **more):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, **more)
    assert done.returncode == 0, f"{' '.join(map(str, command))}:\n{done.stdout[-3000:]}{done.stderr[-3000:]}"
    return done.stdout


def metric(tree, build):
    """A scene may bound the toy, and a run measures it."""
    program = tree / "build/clothbench"
    build()
    run(sys.executable, tree / "scripts/update_metrics.py", program)
    assert '"height_max_m"' in (tree / "scenarios/schema/scene.schema.json").read_text()
    assert "| `height_max_m` |" in (tree / "harness/metrics/REGISTRY.md").read_text()
    build()
    run(sys.executable, tree / "scripts/update_metrics.py", "--check", program)
    scene = json.loads((tree / "scenarios/paper/gravity.json").read_text())
    for bound, verdict in ((100, "pass"), (-100, "fail")):
        scene["expect"] = {"height_max_m": {"at_most": bound}}
        (tree / "scene.json").write_text(json.dumps(scene))
        environment = {**os.environ, "CLOTHBENCH_SCENARIOS": str(tree / "scenarios")}
        told = json.loads(run(program, "run", tree / "scene.json", "--solver", "ballistic", "--out", tree / verdict, "--json", env=environment))
        assert (told["expect_passed"], len(told["expect_failed"])) == ((1, 0) if verdict == "pass" else (0, 1)), told


def needs(tree, scene):
    told = run(tree / "build/clothbench", "--json", "plan", "--solver", "ballistic", scene, env={**os.environ, "CLOTHBENCH_SCENARIOS": str(tree / "scenarios")})
    return json.loads(told)[0]["needs"]


def torus(tree, build):
    """A cloth falls on a ring: a solver has to support it, metrics find the cloth in it, and the result file keeps it."""
    import h5py
    build()
    scene = json.loads((tree / "scenarios/contact/sphere.json").read_text())
    ring = {"type": "torus", "center_m": [0, 0, 0], "radius_m": 0.12, "tube_radius_m": 0.03}
    scene["colliders"] = [ring]
    scene["expect"] = {"contact_length_max_m": {"at_least": 0.5}, "depth_max_m": {"at_least": 0.005, "at_most": 0.031}}
    (tree / "scene.json").write_text(json.dumps(scene))
    assert "torus" in needs(tree, tree / "scene.json")
    environment = {**os.environ, "CLOTHBENCH_SCENARIOS": str(tree / "scenarios")}
    told = json.loads(run(tree / "build/clothbench", "run", tree / "scene.json", "--solver", "ballistic", "--out", tree / "out", "--json", env=environment))
    assert told["runs"][0]["outcome"]["expect"] == "pass" and told["runs"][0]["verdict"] == "ignored", told
    with h5py.File(next((tree / "out").glob("*.h5"))) as f:
        kept = f["colliders/0"].attrs
        assert (kept["shape"], kept["tube_radius_m"]) == ("torus", 0.03), dict(kept)
    scene["colliders"] = [{**ring, "tube_radius_m": 0.5}]
    (tree / "scene.json").write_text(json.dumps(scene))
    wrong = subprocess.run([tree / "build/clothbench", "validate", tree / "scene.json"], capture_output=True, text=True, env=environment)
    assert wrong.returncode == 2 and "/colliders/0/tube_radius_m: expected less than radius_m" in wrong.stdout + wrong.stderr, wrong


def thrown(tree, build):
    """A scene needs the toy or does not, and the table of features has it."""
    build()
    scene = json.loads((tree / "scenarios/validation/free-fall.json").read_text())
    for velocity, needed in (([0, 0, 0], False), ([1, 0, 0], True)):
        scene["cloth"]["initial_velocity_m_per_s"] = velocity
        (tree / "scene.json").write_text(json.dumps(scene))
        assert ("thrown" in needs(tree, tree / "scene.json")) == needed
    row = json.loads(run(tree / "build/clothbench", "--json", "list", "features"))[-1]
    assert (row["name"], row["solvers"]["ballistic"]) == ("thrown", "ignored"), row


def study(tree, build):
    """A file alone: its runs are measured, compared as it says, tabulated, resumed and checked."""
    build()
    program, out = tree / "build/clothbench", tree / "out"
    environment = {**os.environ, "CLOTHBENCH_SCENARIOS": str(tree / "scenarios")}
    command = [program, "--json", "study", "toy", "--out", out]
    told = json.loads(run(*command, env=environment))
    assert (told["ok"], told["failed"]) == (4, 0), told
    assert json.loads(run(*command, "--resume", env=environment))["ok"] == 4
    run(program, "report", out, "-o", tree / "report", env=environment)
    report = (tree / "report/report.md").read_text()
    assert "| gravity-16 | ballistic |" in report and "| ballistic | 2 of 2 | 2 of 2 | 0 (bitwise) |" in report, report
    baseline = tree / "baseline.json"
    run(program, "check", out, "--baseline", baseline, "--update", env=environment)
    run(program, "check", out, "--baseline", baseline, env=environment)


def main():
    arguments = [a for a in sys.argv[1:] if a != "--build"]
    patch, most = pathlib.Path(arguments[0]).resolve(), int(arguments[1])
    touched = re.findall(r"^\+\+\+ b/(.*)$", patch.read_text(), flags=re.M)
    product = [f for f in touched if PRODUCT.search(f)]
    assert touched and len(product) <= most, f"{patch.name} touches {len(product)} product files: {product}"
    with tempfile.TemporaryDirectory(prefix="clothbench-toy-") as folder:
        tree = pathlib.Path(folder) / "tree"
        outside = {**os.environ, "GIT_CEILING_DIRECTORIES": folder}
        if "--build" not in sys.argv:
            tree.mkdir()
            for name in touched:
                if (ROOT / name).exists():
                    (tree / name).parent.mkdir(parents=True, exist_ok=True)
                    shutil.copy(ROOT / name, tree / name)
            run("git", "apply", "--check", patch, cwd=tree, env=outside)
            return
        shutil.copytree(ROOT, tree, ignore=ASIDE)
        run("git", "apply", patch, cwd=tree, env=outside)
        run("cmake", "-S", tree, "-B", tree / "build", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_UNITY_BUILD=ON", "-DBUILD_TESTING=OFF",
            *(f"-DCLOTHBENCH_WITH_{w}=OFF" for w in LEAN))
        # The tree has another name each time; what other builds have compiled is found all the same.
        cached = {**os.environ, "CCACHE_BASEDIR": str(tree), "CCACHE_NOHASHDIR": "1"}
        globals()[patch.stem](tree, lambda: run("cmake", "--build", tree / "build", "--target", "clothbench", env=cached))


if __name__ == "__main__":
    main()
