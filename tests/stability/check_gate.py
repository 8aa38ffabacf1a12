"""usage: check_gate.py SOURCE CLOTHBENCH: the gates of scripts/test.sh pass what is right and nothing else."""
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SOURCE, CLOTHBENCH = pathlib.Path(sys.argv[1]), sys.argv[2]
CELLS = [{"scene": f"{case.lower()}-x", "solver": solver, "setting": "default", "status": "ok", "stability_grade": "0", "class": "ok", "failed_frame": "", "message": "a, b"}
         for case in ("S01", "S24", "S26") for solver in ("xpbd", "paper")]
COLUMNS = ["message", "class", "stability_grade", "status", "setting", "solver", "scene"]


def write(path, rows, columns=None):
    with path.open("w", newline="", encoding="utf-8") as f:
        out = csv.DictWriter(f, columns or list(rows[0]), extrasaction="ignore")
        out.writeheader()
        out.writerows(rows)


class Gate(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.home = pathlib.Path(self.temporary.name)
        self.runs = self.home / "runs.csv"
        self.summary = self.home / "summary.json"
        write(self.runs, CELLS)
        self.summary.write_text(json.dumps({"stable": 6, "crashed": 0}))

    def tearDown(self):
        self.temporary.cleanup()

    def gate(self):
        done = subprocess.run([sys.executable, SOURCE / "scripts/check_stability.py", self.summary, self.home], capture_output=True, text=True, check=False)
        return done.returncode, done.stderr

    def fails_for(self, reason):
        code, text = self.gate()
        self.assertNotEqual(code, 0, reason)
        self.assertIn(reason, text)

    def test_what_is_right_passes(self):
        self.assertEqual(self.gate(), (0, ""))
        # Another solver may be as bad as it likes, and columns may move.
        runs = [dict(r, stability_grade="2", **{"class": "F0"}) if r["solver"] == "paper" else r for r in CELLS]
        write(self.runs, runs, COLUMNS)
        self.assertEqual(self.gate(), (0, ""))

    def test_a_run_out_of_bounds_fails_wherever_its_column_stands(self):
        for klass in ("F0", "F1", "F2"):
            runs = [dict(r, stability_grade="2", **{"class": klass}) if r == CELLS[0] else r for r in CELLS]
            for columns in (None, COLUMNS):
                write(self.runs, runs, columns)
                self.fails_for(klass)

    def test_what_is_not_there_fails(self):
        write(self.runs, [r for r in CELLS if r["solver"] != "xpbd"])
        self.fails_for("no run of xpbd")
        write(self.runs, [dict(r, status="unsupported", stability_grade="") if r["solver"] == "xpbd" else r for r in CELLS])
        self.fails_for("no run of xpbd")
        write(self.runs, [dict(r, status="missing", stability_grade="") if r == CELLS[1] else r for r in CELLS])
        self.fails_for("planned, not run")
        write(self.runs, [], list(CELLS[0]))
        self.fails_for("no run of xpbd")
        write(self.runs, CELLS, [c for c in CELLS[0] if c != "class"])
        self.fails_for("KeyError: 'class'")
        self.runs.unlink()
        self.fails_for("runs.csv")

    def test_a_process_that_died_fails(self):
        for text in ('{"crashed": 1}', "{}", "", "[]", '{"crashed": "0"}', '{"crashed": null}'):
            self.summary.write_text(text)
            self.assertNotEqual(self.gate()[0], 0, text)
        self.summary.unlink()
        self.fails_for("summary.json")

    def test_no_baseline_is_a_failure_of_the_penetration_gate(self):
        """The function of scripts/test.sh in a folder without the baseline; the study, which takes minutes, is left out, the check is run."""
        release = self.home / "build" / "release"
        release.mkdir(parents=True)
        program = release / "clothbench"
        program.write_text(f'#!/bin/sh\n[ "$1" = study ] || exec "{CLOTHBENCH}" "$@"\n')
        program.chmod(0o755)
        function = 'eval "$(sed -n "/^against_baseline()/,/^}/p" "$0")"; declare -F against_baseline >/dev/null || exit 9; against_baseline penetration'
        done = subprocess.run(["bash", "-c", function, SOURCE / "scripts" / "test.sh"], cwd=self.home, env=dict(os.environ), capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertIn("results/baselines/penetration.json", done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
