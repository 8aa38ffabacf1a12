"""usage: check_command.py CLOTHBENCH EXAMPLE LIBRARIES SOURCE: plugins through the command."""
import json
import os
import shutil
import signal
import subprocess
import time

import h5py

from command import CLOTHBENCH, EXAMPLE, SOURCE, PluginTest, main

SMALL = ["--set", "cloth.grid=[8,8]", "--set", "cloth.sides=single"]


class Plugin(PluginTest):
    def stored(self, name):
        with h5py.File(os.path.join(self.out, name + ".h5")) as f:
            outcome = dict(f["outcome"].attrs)
            return outcome, dict(f["summary"].attrs), json.loads(f["header_json"][0])

    def faulty(self, fault="NONE"):
        return self.library(f"faulty_{fault}")

    # --- a correct plugin

    def test_a_run(self):
        words = ["run", "paper/gravity", "--solver", "plugin:" + EXAMPLE, *SMALL, "--trials", "2", "--out", self.out]
        self.assertEqual(self.command(*words), 0, self.text)
        outcome, summary, header = self.stored("gravity__example-xpbd__default")
        self.assertEqual(outcome["status"], "ok")
        # Without free_fall_m the exact fall is used, from which the plugin always differs by half a substep.
        self.assertLess(summary["free_fall_error"], 0.5 / 72 / 20 / 0.25)
        self.assertGreater(summary["free_fall_error"], 0)
        self.assertGreater(summary["fps_median"], 0)
        self.assertEqual([s["name"] for s in header["stages"]], ["integrate", "edges", "bending"])
        self.assertEqual(header["settings"], {"substeps": 20})

    def test_it_is_held_to_the_free_fall_that_it_states(self):
        self.assertEqual(self.command("run", "paper/gravity", "--solver", self.faulty(), *SMALL, "--out", self.out), 0, self.text)
        self.assertEqual(self.stored("gravity__faulty__default")[1]["free_fall_error"], 0)

    def test_an_exact_answer(self):
        words = ["run", "validation/hang-elastic", "--solver", "plugin:" + EXAMPLE, "--trials", "0", "--out", self.out]
        self.assertEqual(self.command(*words, "--set", "solver.substeps=64"), 0, self.text)
        outcome, summary, _ = self.stored("hang-elastic__example-xpbd__substeps=64")
        self.assertEqual(outcome["status"], "ok")
        self.assertLess(summary["stretch_mean_last_second"], 0.01)

    def test_settings_plan_and_what_it_cannot_do(self):
        self.assertEqual(self.command("plan", "paper/gravity", "--solver", "plugin:" + EXAMPLE), 0)
        self.assertIn("bending", self.text)
        words = ["run", "paper/gravity", "--solver", "plugin:" + EXAMPLE, "--set", "solver.substep=5", "--out", self.out]
        self.assertEqual(self.command(*words), 2)
        self.assertIn("substeps", self.text)
        self.command("run", "paper/capsule-sweep", "--solver", "plugin:" + EXAMPLE, *SMALL, "--out", self.out)
        self.assertEqual(self.stored("capsule-sweep__example-xpbd__default")[0]["status"], "unsupported")

    def test_it_says_how_far_off_it_holds_the_cloth(self):
        two = 'colliders=[{"type":"sphere","center_m":[0,0,0],"radius_m":0.1},{"type":"box","center_m":[0,-1,0],"size_m":[1,1,1]}]'
        words = ["plan", "contact/sphere", "--set", two]
        (plan,) = self.rows(*words, "--solver", self.faulty(), code=0)
        self.assertEqual([m["margin_m"] for m in plan["contact_margins"]], [0.03, 0.004])
        self.assertEqual(self.command(*words, "--solver", self.faulty()), 0, self.text)
        self.assertIn("0.03", self.text)
        run = ["run", "contact/sphere", "--solver", self.faulty(), "--trials", "0", "--set", two, "--out", self.out]
        self.assertEqual(self.command(*run), 0, self.text)
        self.assertEqual(self.stored("sphere-drop__faulty__default")[2]["plan"]["contact_margins"], plan["contact_margins"])

    def test_it_joins_studies(self):
        words = ["study", "table3", "--quick", "--trials", "1", "--solver", "plugin:" + EXAMPLE, "--solver", "ballistic"]
        self.assertEqual(self.command(*words, "--out", self.out), 0, self.text)
        with open(os.path.join(self.out, "study.json"), encoding="utf-8") as text:
            runs = json.load(text)["runs"]
        self.assertTrue(any("example-xpbd" in c for c in runs) and any("ballistic" in c for c in runs))
        self.assertIn("example-xpbd", self.text)

    # --- faulty plugins

    def test_a_motion_that_no_law_allows_fails_in_run_and_study(self):
        run = ["run", "paper/gravity", *SMALL, "--trials", "0", "--solver", "plugin:" + EXAMPLE, "--out", self.out]
        study = ["study", "table3", "--quick", "--trials", "1", "--out", self.out + "-study"]
        for words, others in ((run, ["pass"]), (study, [])):
            runs = self.rows(*words, "--solver", self.faulty())["runs"]
            self.assertEqual([r["verdict"] for r in runs if r["solver"] != "faulty"], others)
            wrong = [(r["verdict"], "mean_force (dynamic) " in r["outcome"]["expect"]) for r in runs if r["solver"] == "faulty"]
            self.assertEqual(set(wrong), {("fail", True)})

    def test_what_is_refused(self):
        text = os.path.join(self.home, "text.so")
        with open(text, "w", encoding="utf-8") as out:
            out.write("no library")
        for solver, word in (
            (self.faulty("VERSION"), "version 99"),
            (self.faulty("SCENE_SIZE"), "its ClothbenchScene has"),
            (self.faulty("EDGE_SIZE"), "its ClothbenchEdge has"),
            (self.faulty("NO_SYMBOL"), "has no function clothbench_plugin"),
            (self.faulty("NO_STEP"), "step: missing"),
            (self.faulty("NAME"), '"ballistic" is already a solver of clothbench'),
            (self.faulty("BITS"), "expected bits of known features only"),
            (self.faulty("CRASHES_ON_LOAD"), "crashes when it is loaded: signal 11"),
            (self.faulty("ENDS_ON_LOAD"), "ends the program when it is loaded"),
            ("plugin:" + text, "cannot be loaded"),
            ("plugin:nothing.so", "No such file"),
        ):
            self.assertEqual(self.command("run", "paper/gravity", "--solver", solver, "--out", self.out), 2, self.text)
            self.assertIn(word, self.text)

    def both(self, *more, **environment):
        return self.command("run", "paper/gravity", "--solver", self.faulty(), "--solver", "ballistic", *SMALL, "--out", self.out, *more, **environment)

    def positions(self, name):
        with h5py.File(os.path.join(self.out, name + ".h5")) as f:
            return f["trajectory/position"][:]

    def test_a_crash_is_a_row_with_the_frames_before_it(self):
        self.both()
        whole = self.positions("gravity__faulty__default")
        shutil.rmtree(self.out)
        for where, fault, frames in (("accuracy", "crash:5", 5), ("trial 1 of 1", "crash:365", len(whole))):
            self.assertEqual(self.both(FAULT=fault), 1, self.text)
            outcome = self.stored("gravity__faulty__default")[0]
            self.assertEqual((outcome["status"], outcome["class"]), ("crashed", "F3"))
            self.assertIn("signal 11", outcome["message"])
            self.assertIn(where, outcome["message"])
            self.assertTrue((self.positions("gravity__faulty__default") == whole[:frames]).all())
            self.assertEqual(self.stored("gravity__ballistic__default")[0]["status"], "ok")
            self.assertIn("crashed", self.text)
            self.assertIn("1 runs ok, 0 unsupported, 1 failed", self.text)
            self.assertEqual([f for f in os.listdir(self.out) if not f.endswith((".h5", ".xdmf", ".json"))], [])
            shutil.rmtree(self.out)

    def test_what_a_plugin_prints_is_no_part_of_the_summary(self):
        solver = self.faulty()
        for words in (
            ["run", "paper/gravity", "--solver", solver, *SMALL, "--trials", "1", "--out", self.out],
            ["--in-process", "run", "paper/gravity", "--solver", solver, *SMALL, "--out", os.path.join(self.home, "second")],
            ["plan", "paper/gravity", "--solver", solver],
            ["conformance", solver, "--scene", "paper/gravity", "--no-whole"],
            ["run", "no-such-scene", "--solver", solver],
        ):
            env = dict(os.environ, CHATTER="1", CLOTHBENCH_SCENARIOS=os.path.join(SOURCE, "scenarios"))
            process = subprocess.run([CLOTHBENCH, "--json", *words], env=env, cwd=self.home, capture_output=True, text=True, timeout=120)
            json.loads(process.stdout)
            self.assertNotIn("prints", process.stdout)
            self.assertIn("prints", process.stderr)

    # --- commands other than run and study: a crash is a result, and results of other solvers are kept

    def test_a_crash_is_an_answer_of_plan(self):
        words = ["plan", "paper/gravity", "--solver", self.faulty(), "--solver", "ballistic"]
        bad, good = self.rows(*words, code=1, FAULT="create")
        self.assertEqual((bad["status"], good["status"]), ("crashed", "ok"))
        self.assertIn("signal 11", bad["message"])
        self.assertEqual([r["status"] for r in self.rows(*words, code=0)], ["ok", "ok"])
        self.assertEqual([r["status"] for r in self.rows(*words, code=1, FAULT="load")], ["error", "ok"])

    def test_a_crash_a_hang_and_an_exit_are_answers_of_conformance(self):
        words = ["conformance", self.faulty(), "ballistic", "--scene", "conformance/sheet", "--no-whole"]
        for fault, message in (("crash:5", "signal 11"), ("hang:5", "killed after 1"), ("exit:5", "exit status 0")):
            bad, good = self.rows(*words, code=1, FAULT=fault, CLOTHBENCH_SOLVER_LIMIT_S="1")
            self.assertEqual((bad["status"], good["status"]), ("FAIL", "pass"))
            self.assertIn(message, bad["faults"][0])

    def test_interrupted_and_resumed(self):
        process = self.start("run", "paper/gravity", "--solver", self.faulty(), "--solver", "ballistic", *SMALL, "--out", self.out, FAULT="hang:20")
        for _ in range(400):
            if os.path.exists(os.path.join(self.out, "gravity__faulty__default.part")):
                break
            time.sleep(0.05)
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)  # the plugin hangs: its process is killed
        self.text, _ = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, self.text)
        self.assertEqual(self.both("--resume"), 0, self.text)
        self.assertEqual(self.stored("gravity__faulty__default")[0]["status"], "ok")


if __name__ == "__main__":
    main()
