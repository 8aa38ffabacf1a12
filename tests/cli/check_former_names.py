"""usage: check_former_names.py CLOTHBENCH FOLDER: files and commands in the words of version 0.1 (FOLDER was written by it) are read, with
one notice that has the word of today, and a new word alone changes no hash and fails no check."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

CLOTHBENCH, FOLDER = sys.argv[1:3]


class FormerNames(unittest.TestCase):
    def setUp(self):
        self.home = tempfile.mkdtemp(prefix="clothbench-former-")
        self.addCleanup(shutil.rmtree, self.home, ignore_errors=True)
        self.files = os.path.join(self.home, "files")
        shutil.copytree(FOLDER, self.files)

    def run_command(self, *words, code=0):
        done = subprocess.run([CLOTHBENCH, *words], capture_output=True, text=True, check=False, cwd=self.files)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout, done.stderr

    def noticed(self, stderr, former, current):
        self.assertEqual(stderr.count(f'"{former}" is now called "{current}"'), 1, stderr)

    def test_a_scene_has_the_hash_that_it_had(self):
        with open(os.path.join(self.files, "baseline.json")) as f:
            before = json.load(f)["cells"][0]["scenario_sha256"]
        for former, text in ((True, None), (False, '"case"')):
            if text:
                with open(os.path.join(self.files, "scene.json")) as f:
                    scene = f.read()
                with open(os.path.join(self.files, "scene.json"), "w") as f:
                    f.write(scene.replace('"card"', text))
            out, err = self.run_command("--json", "run", "scene.json", "--solver", "ballistic", "--out", f"run-{former}")
            self.assertIn(before[:12], subprocess.run(["grep", "-aho", before, "-r", f"run-{former}"], capture_output=True, text=True,
                          check=False, cwd=self.files).stdout)
            if former:
                self.noticed(err, "card", "case")
            else:
                self.assertNotIn("notice", err)

    def test_an_interrupted_run_is_finished(self):
        _, err = self.run_command("study", "study.json", "--solver", "bullet-soft", "--out", "interrupted", "--resume")
        self.noticed(err, "cell_limit_s", "run_limit_s")
        self.assertIn("old-swing__bullet-soft__default.h5", os.listdir(os.path.join(self.files, "interrupted")))

    def test_results_are_reported_in_words_of_today(self):
        self.run_command("report", "results", "-o", "report")
        with open(os.path.join(self.files, "report", "runs.csv")) as f:
            text = f.read()
        self.assertIn("fail: stretch_max", text)
        self.assertNotIn("broken", text)
        self.assertNotIn("kept", text)

    def test_commands_and_options(self):
        _, err = self.run_command("study", "study.json", "--list-cells")
        self.noticed(err, "--list-cells", "--list-runs")
        _, err = self.run_command("study", "study.json", "--cell", "0", "--out", "one")
        self.noticed(err, "--cell", "--run")
        _, err = self.run_command("study", "study.json", "--cell=0", "--no-cards", "--out", "two")
        self.noticed(err, "--cell", "--run")
        self.noticed(err, "--no-cards", "--no-moduli")
        _, err = self.run_command("card", "--help")
        self.noticed(err, "card", "moduli")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
