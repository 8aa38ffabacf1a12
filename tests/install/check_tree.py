"""usage: check_tree.py CMAKE BUILD SOURCE: the tree that `cmake --install` makes, moved elsewhere."""
import gzip
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

CMAKE, BUILD, SOURCE = sys.argv[1:4]
SMALL = ["--set", "cloth.grid=[8,8]", "--set", "cloth.sides=single", "--set", "time.duration_s=0.25", "--trials", "1"]

# Replaces npm by a script that creates the packages' content without a network.
FAKE_NPM = """#!/bin/sh
set -e
[ "$1" = ci ]
for package in @iwer/sem iwer @webxr-input-profiles/assets; do
  mkdir -p node_modules/$package
  echo '{"version": "1.2.3"}' > node_modules/$package/package.json
done
cd node_modules
mkdir -p @iwer/sem/captures @webxr-input-profiles/assets/dist/profiles/generic-hand iwer/lib/device/configs/hand
for room in living_room meeting_room music_room office_large office_small; do : > @iwer/sem/captures/$room.json; done
for side in left right; do : > @webxr-input-profiles/assets/dist/profiles/generic-hand/$side.glb; done
for pose in relaxed pinch point; do : > iwer/lib/device/configs/hand/$pose.js; done
"""


class Tree(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.home = pathlib.Path(tempfile.mkdtemp(prefix="clothbench-install-"))
        cls.addClassCleanup(shutil.rmtree, cls.home, ignore_errors=True)
        subprocess.run([CMAKE, "--install", BUILD, "--strip", "--prefix", cls.home / "first"], check=True, stdout=subprocess.DEVNULL)
        cls.tree = cls.home / "moved here"
        (cls.home / "first").rename(cls.tree)
        cls.share = cls.tree / "share" / "clothbench"

    def command(self, *words, code=0, **environment):
        # Other tests run concurrently. If they counted as jobs, the report would withhold this run's times.
        env = {k: v for k, v in os.environ.items() if not k.startswith("CLOTHBENCH_")} | {"CLOTHBENCH_JOBS": "1"}
        program = self.tree / "bin" / "clothbench"
        done = subprocess.run([program, *words], env=env | environment, cwd=self.home, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def out(self):
        folder = tempfile.mkdtemp(dir=self.home)
        return os.path.join(folder, "out")

    def test_its_own_scenes_are_read(self):
        file = self.share / "scenarios" / "paper" / "gravity.json"
        given = file.read_text(encoding="utf-8")
        self.addCleanup(file.write_text, given, encoding="utf-8")
        file.write_text(json.dumps(json.loads(given) | {"why": "Changed where it was moved to."}), encoding="utf-8")
        why = {s["name"]: s["why"] for s in json.loads(self.command("list", "scenarios", "--json"))}["paper/gravity"]
        self.assertEqual(why, "Changed where it was moved to.")

    def test_all_scenes_and_studies_are_there(self):
        for kind in ("scenarios", "studies"):
            here = json.loads(self.command("list", kind, "--json"))
            there = json.loads(self.command("list", kind, "--json", CLOTHBENCH_SCENARIOS=os.path.join(SOURCE, "scenarios")))
            self.assertEqual(here, there)
            self.assertGreater(len(here), 3)
        self.command("validate", "validation/hang-mesh")  # uses a file next to the scene
        self.assertTrue((self.share / "scenarios" / "schema" / "scene.schema.json").is_file())

    def test_figures_are_drawn_from_the_tree_alone(self):
        script = self.share / "page" / "figures.cjs"
        if not script.exists() or not shutil.which("node"):
            self.skipTest("no Node, or this build has no page")
        out = self.out()
        self.command("run", "paper/gravity", "--solver", "ballistic", *SMALL, "--out", out)
        self.command("report", out, "-o", out + "-report")
        picture = pathlib.Path(out + "-report", "figures", "fig4.svg").read_text(encoding="utf-8")
        self.assertIn("ballistic", picture)
        again = pathlib.Path(self.out())
        again.mkdir()
        subprocess.run(["node", script, out + "-report/index.html", again], check=True)
        self.assertEqual((again / "fig4.svg").read_text(encoding="utf-8"), picture, "the program and figures.cjs draw the same figure")

    def test_only_a_fitting_version_is_found(self):
        version = re.search(r"clothbench (\d+)\.(\d+)", self.command("--version"))
        major, minor = version.group(1), version.group(2)
        for wanted, found in ((f"{major}.{minor}", True), (str(int(major) + 1), False)):
            folder = pathlib.Path(tempfile.mkdtemp(dir=self.home))
            (folder / "CMakeLists.txt").write_text(
                f"cmake_minimum_required(VERSION 3.16)\nproject(p LANGUAGES NONE)\nfind_package(clothbench {wanted} REQUIRED)\n"
            )
            configure = [CMAKE, "-S", folder, "-B", folder / "b", f"-DCMAKE_PREFIX_PATH={self.tree}"]
            done = subprocess.run(configure, capture_output=True, check=False)
            self.assertEqual(done.returncode == 0, found, done.stderr)

    def test_fetched_assets_lie_with_the_user(self):
        bin_folder = self.home / "bin"
        bin_folder.mkdir()
        (bin_folder / "npm").write_text(FAKE_NPM)
        (bin_folder / "npm").chmod(0o755)
        data = self.home / "data"
        if os.path.isdir(os.path.join(SOURCE, "build", "assets", "node_modules", "iwer")):
            self.skipTest("the source tree has assets, which come first")
        self.assertIn(str(self.share / "scripts" / "fetch-assets.sh"), self.command("list", "assets", XDG_DATA_HOME=str(data)))
        env = os.environ | {"XDG_DATA_HOME": str(data), "PATH": f"{bin_folder}:{os.environ['PATH']}"}
        subprocess.run([self.share / "scripts" / "fetch-assets.sh", "--require-assets"], env=env, check=True, stdout=subprocess.DEVNULL)
        (assets,) = json.loads(self.command("list", "assets", "--json", XDG_DATA_HOME=str(data)))
        self.assertEqual((assets["name"], assets["folder"]), ("npm", str(data / "clothbench" / "assets" / "node_modules")))

    def test_no_file_but_the_program_names_the_source_tree(self):
        for file in self.tree.rglob("*"):
            if not file.is_file() or file.name == "clothbench" and file.parent.name == "bin":
                continue
            raw = file.read_bytes()
            content = gzip.decompress(raw) if file.suffix == ".gz" else raw
            # Complete paths below the tree, because the name of a folder in / is part of many other words.
            self.assertNotRegex(content, rb"(?<![\w.-])" + re.escape(SOURCE.encode()) + rb"/(harness|scenarios|scripts|solvers|build)\b", file)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])
