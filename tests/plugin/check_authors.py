"""usage: check_authors.py CLOTHBENCH EXAMPLE LIBRARIES SOURCE: commands that authors of solvers use."""
import hashlib
import json
import os
import pathlib
import shutil

import h5py

from command import EXAMPLE, SOURCE, PluginTest, main

RULES = {"frames": 12, "max_wall_s": 0.1, "min_frames": 12, "warmup_s": 0}


class Authors(PluginTest):
    def study(self, **more):
        scene = os.path.join(SOURCE, "scenarios", "paper", "gravity.json")
        study = {"name": "small", "why": "A test.", "protocol": "fps", "trials": 1,
                 "scenes": [{"file": scene, "axes": [{"key": "cloth.sides", "values": ["single", "double"], "labels": ["single", "double"]}]}],
                 "solvers": [{"solver": "ballistic"}], "rules": RULES, **more}
        file = os.path.join(self.home, "small.json")
        pathlib.Path(file).write_text(json.dumps(study), encoding="utf-8")
        return file

    def test_two_builds_of_a_plugin_can_be_told_apart(self):
        words = ["run", "paper/gravity", "--solver", "plugin:" + EXAMPLE, "--set", "cloth.grid=[5,5]", "--trials", "0"]
        self.assertEqual(self.command(*words, "--out", self.out), 0, self.text)
        with h5py.File(os.path.join(self.out, "gravity__example-xpbd__default.h5")) as f:
            environment = json.loads(f["header_json"][0])["environment"]
        self.assertEqual(environment["solver_version"], "2")
        plugin = environment["plugin"]
        self.assertEqual(plugin["path"], os.path.realpath(EXAMPLE))
        self.assertEqual(plugin["sha256"], hashlib.sha256(pathlib.Path(EXAMPLE).read_bytes()).hexdigest())
        self.assertIn("XPBD", plugin["summary"])
        report = os.path.join(self.home, "report")
        self.assertEqual(self.command("report", self.out, "-o", report), 0, self.text)
        words = pathlib.Path(report, "report.md").read_text(encoding="utf-8")  # the page has the same notes
        self.assertIn(" is a plugin, version 2", words)
        self.assertIn(plugin["sha256"][:16], words)

    def test_a_misspelt_solver_of_a_study_is_an_error(self):
        file = self.study(solvers=[{"solver": "ballistic"}, {"solver": "bullet-sofd"}])
        self.assertEqual(self.command("study", file, "--out", self.out), 2, self.text)
        self.assertIn('"bullet-sofd"', self.text)
        self.assertIn("nearest known: bullet-soft", self.text)
        file = self.study(solvers=[{"solver": "exampel-xpbd"}])
        self.assertEqual(self.command("study", file, "--out", self.out, CLOTHBENCH_PLUGINS=EXAMPLE), 2, self.text)
        self.assertIn("nearest known: example-xpbd", self.text)

    def test_lists_have_plugins_with_their_settings(self):
        for words, environment in ((["--solver", "plugin:" + EXAMPLE], {}), ([], {"CLOTHBENCH_PLUGINS": EXAMPLE})):
            (mine,) = [r for r in self.rows("list", "solvers", *words, **environment) if r["name"] == "example-xpbd"]
            self.assertTrue(mine["plugin"])
            self.assertEqual([s["name"] for s in mine["settings"]], ["substeps"])
            self.assertEqual(self.command("list", "solvers", *words, **environment), 0)
            self.assertRegex(self.text, "solver.substeps=20 +steps per frame")
            self.assertEqual(self.command("list", "features", *words, **environment), 0)
            self.assertIn("example-xpbd", self.text)

    def test_in_process_there_is_no_child(self):
        words = ["run", "paper/gravity", "--solver", self.library("faulty_NONE"), "--set", "cloth.grid=[5,5]", "--out", self.out]
        self.assertEqual(self.command("--in-process", *words), 0, self.text)
        shutil.rmtree(self.out)
        # The crash happens in the program itself, so a debugger stops at it.
        self.assertEqual(self.command(*words, "--in-process", FAULT="crash:3"), -11, self.text)
        self.assertEqual(self.command("plan", "paper/gravity", "--solver", self.library("faulty_NONE"), "--in-process", FAULT="create"), -11)

    def conform(self, *words, code, **environment):
        return self.rows("conformance", *words, "--limit", "1", code=code, **environment)

    def test_conformance_of_a_plugin(self):
        scenes = ["--scene", "paper/gravity", "--scene", "validation/hang-elastic", "--scene", "contact/sphere"]
        rows = self.conform("plugin:" + EXAMPLE, *scenes, code=0)
        self.assertEqual([r["status"] for r in rows], ["pass", "pass", "skipped"])
        self.assertEqual((rows[0]["cases"], rows[0]["solver"]), (13, "example-xpbd"))
        self.assertGreater(rows[0]["frames_whole"], 6)
        self.assertIn("example-xpbd has no", rows[2]["faults"][0])
        self.assertEqual(self.command("conformance", "plugin:" + EXAMPLE, "--scene", "paper/gravity", "--no-whole"), 0)
        self.assertRegex(self.text, r"pass +example-xpbd paper/gravity: \d+ cases")
        self.assertIn("1 scenes pass, 0 fail, 0 skipped", self.text)
        self.assertEqual([r["status"] for r in self.conform("plugin:" + EXAMPLE, *scenes[4:], code=1)], ["skipped"])  # nothing was tested

    def test_conformance_finds_faults(self):
        scene = ["--scene", "paper/gravity"]
        for fault, word in (("nan:3", "step failed"), ("load", "it was asked to fail")):
            (row,) = self.conform(self.library("faulty_NONE"), *scene, code=1, FAULT=fault)
            self.assertEqual(row["status"], "FAIL")
            self.assertIn(word, " ".join(row["faults"]))
        (row,) = self.conform(self.library("faulty_STRETCHES"), *scene, code=1)
        self.assertIn("stages:", " ".join(row["faults"]))
        # Six frames show no fault, but the whole scene does: after 12 frames attached vertices no longer follow the hands.
        (row,) = self.conform(self.library("faulty_LATE"), "--scene", "paper/two-hand-stretch-0p5mps", code=1)
        self.assertTrue(all(f.startswith("whole scene: ") and "from its hand" in f for f in row["faults"]), row)
        self.assertEqual(self.command("conformance", "ballistic", "--scene", "paper/gravitiy"), 2)
        self.assertIn("nearest known: paper/gravity", self.text)


if __name__ == "__main__":
    main()
