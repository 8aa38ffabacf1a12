"""usage: check_replay.py LIARS CLOTHBENCH PLUGIN SOURCE: lies fail in every output, and the right motion passes."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

LIARS, CLOTHBENCH, PLUGIN, SOURCE = sys.argv[1:5]
KINDS = ["validation/hang", "sphere"]
LIES = ["the right motion", "pins dropped", "10 m up for a frame", "at rest from frame 20", "two vertices exchanged",
        "5 frames late", "shrunk by 5 %", "double speed", "falls through", "jumps through", "back at the start"]


class Replay(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="clothbench-liars-")
        cls.home = pathlib.Path(cls.temporary.name)
        cls.environment = dict(os.environ, CLOTHBENCH_SCENARIOS=os.path.join(SOURCE, "scenarios"), CLOTHBENCH_ASSETS="procedural", CLOTHBENCH_LIARS=str(cls.home))
        cls.environment.pop("CLOTHBENCH_PLUGINS", None)
        told = cls.command(LIARS, "--seed", "1000", "--motions", str(len(KINDS)), "--solver", "bullet-deformable", "--store", str(cls.home), "--kind", *KINDS)
        trials = [json.loads(line) for line in told.stdout.splitlines()]
        cls.trials = [t for t in trials if t["lie"] in LIES and t["motion"] >= 0]

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def command(cls, *words):
        return subprocess.run(words, env=cls.environment, cwd=cls.home, capture_output=True, text=True, timeout=300)

    def test_the_matrix_is_whole(self):
        for kind in KINDS:
            of = [t for t in self.trials if t["kind"].endswith(kind)]
            self.assertTrue(any(t["right"] for t in of), kind)
            self.assertGreaterEqual(sum(not t["right"] for t in of), 6, kind)

    def judge(self, t, run):
        with self.subTest(scene=t["scene"], lie=t["lie"]):
            expect = run["outcome"]["expect"]
            self.assertEqual(run["verdict"], "pass" if t["right"] else "fail", expect)
            if t["alarms"]:
                self.assertIn(f"{t['worst'][0]} (", expect)

    def test_run(self):
        for t in self.trials:
            done = self.command(CLOTHBENCH, "run", f"{t['scene']}.json", "--solver", "plugin:" + PLUGIN, "--trials", "0", "--json",
                                "--set", f"solver.motion={t['motion']}", "--out", f"run-{t['motion']}")
            self.judge(t, json.loads(done.stdout)["runs"][0])

    def test_study(self):
        scenes = sorted({t["scene"] for t in self.trials})
        study = {
            "name": "lies", "why": "Motions that are wrong, replayed.", "protocol": "penetration", "trials": 1,
            "scenes": [{"file": f"{s}.json", "tags": [s]} for s in scenes],
            "solvers": [{"solver": "plugin:" + PLUGIN, "label": str(t["motion"]), "settings": {"motion": t["motion"]}, "tags": [t["scene"]]} for t in self.trials],
            "rules": {"frames": 1, "max_wall_s": 0, "min_frames": 1, "warmup_s": 0},
        }
        (self.home / "lies.json").write_text(json.dumps(study))
        done = self.command(CLOTHBENCH, "study", "lies.json", "--out", "study", "--json")
        runs = {run["setting"]: run for run in json.loads(done.stdout)["runs"]}
        for t in self.trials:
            self.judge(t, runs[str(t["motion"])])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
