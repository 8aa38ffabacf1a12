"""usage: check_console.py CLOTHBENCH SOURCE: output for people and for programs: a live line only on a terminal, JSON and examples
for every command."""
import fcntl
import json
import os
import pty
import re
import select
import shutil
import struct
import subprocess
import sys
import tempfile
import termios
import unittest

CLOTHBENCH, SOURCE = sys.argv[1:3]
RUN = ["run", "paper/gravity", "--solver", "ballistic", "--set", "cloth.grid=[8,8]", "--set", "time.duration_s=1"]
COLUMNS = 60


class Console(unittest.TestCase):
    def setUp(self):
        self.home = tempfile.mkdtemp(prefix="clothbench-console-")
        self.addCleanup(shutil.rmtree, self.home, ignore_errors=True)
        self.out = os.path.join(self.home, "out")
        self.environment = dict(os.environ, CLOTHBENCH_SCENARIOS=os.path.join(SOURCE, "scenarios"), TERM="xterm")

    def piped(self, *words):
        done = subprocess.run([CLOTHBENCH, *words], env=self.environment, capture_output=True, text=True, check=False, cwd=self.home)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout, done.stderr

    def on_terminal(self, *words, **environment):
        """stdout, stderr and exit code of a command whose output streams are terminals."""
        ends = [pty.openpty() for _ in range(2)]
        for ours, _ in ends:
            fcntl.ioctl(ours, termios.TIOCSWINSZ, struct.pack("HHHH", 24, COLUMNS, 0, 0))
        process = subprocess.Popen(
            [CLOTHBENCH, *words], env=dict(self.environment, **environment), stdout=ends[0][1], stderr=ends[1][1], cwd=self.home
        )
        for _, theirs in ends:
            os.close(theirs)
        text = {ours: b"" for ours, _ in ends}
        open_ends = set(text)
        while open_ends:
            for ours in select.select(list(open_ends), [], [], 60)[0]:
                try:
                    chunk = os.read(ours, 65536)
                except OSError:  # the other end is closed
                    chunk = b""
                text[ours] += chunk
                if not chunk:
                    open_ends.discard(ours)
                    os.close(ours)
        return [text[ours].decode() for ours, _ in ends] + [process.wait()]

    def test_a_live_line_that_fits_and_goes_away(self):
        study = ["study", "table3", "--quick", "--trials", "1", "--solver", "ballistic", "--solver", "bullet-soft"]
        _, errors, code = self.on_terminal(*study, "--out", self.out)
        self.assertEqual(code, 0, errors)
        lines = [line.rstrip() for line in errors.split("\r")]
        self.assertTrue(any(re.match(r"\[\d+/\d+\] \S+", line) for line in lines), lines)
        self.assertTrue(any(re.search(r"about \d+ (s|min) left$", line) for line in lines), lines)
        self.assertLess(max(map(len, lines)), COLUMNS)
        self.assertEqual(lines[-1], "", "the live line is cleared at the end")
        self.assertEqual(self.piped(*study, "--out", self.out + "-2")[1], "")

    def test_lists_and_help_fit_the_width(self):
        self.environment["COLUMNS"] = str(COLUMNS)
        lists = ["solvers", "features", "scenarios", "studies", "metrics", "scalars", "assets", "terms"]
        for words in [["list", what] for what in lists] + [["plan", "paper/gravity", "--solver", "ballistic"], ["--help"]] + [[command, "--help"] for command in self.commands()]:
            with self.subTest(words=words):
                lines = self.piped(*words)[0].split("\nEx")[0].splitlines()
                # Words, and option names with their values, are not broken.
                long = [line for line in lines if len(line) > COLUMNS and " " in line.strip() and not line.startswith("  -")]
                self.assertEqual(long, [])

    def commands(self):
        help_text, _ = self.piped("--help")
        self.assertIn("Example", help_text)
        return re.findall(r"^  ([a-z]+)  ", help_text[help_text.index("Subcommands:") :], re.MULTILINE)

    def test_every_command_has_an_example_and_speaks_json(self):
        self.piped(*RUN, "--solver", "bullet-soft", "--trials", "3", "--out", self.out)
        baseline = os.path.join(self.home, "baseline.json")
        self.piped("check", self.out, "--baseline", baseline, "--update")
        with open(os.path.join(self.home, "tiny.json"), "w", encoding="utf-8") as text:
            with open(os.path.join(SOURCE, "scenarios", "paper", "gravity.json"), encoding="utf-8") as given:
                json.dump(dict(json.load(given), name="tiny"), text)
        ballistic = next(os.path.join(self.out, name) for name in sorted(os.listdir(self.out)) if "ballistic" in name and name.endswith(".h5"))
        asked = {
            "list": ["features"],
            "validate": ["tiny.json"],
            "plan": ["paper/gravity", "--solver", "ballistic"],
            "run": RUN[1:] + ["--out", self.out + "-2"],
            "study": ["table3", "--quick", "--list-jobs"],
            "report": [self.out, "-o", self.out + "-report"],
            "import": [self.out],
            "check": [self.out, "--baseline", baseline],
            "compare": [self.out, self.out],
            "render": [ballistic, "--frames", "0", "--size", "200x200", "-o", self.out + "-pictures"],
            "conformance": ["ballistic", "--scene", "paper/gravity", "--no-whole"],
        }
        for command in self.commands():
            with self.subTest(command=command):
                self.assertRegex(self.piped(command, "--help")[0], "Examples?:")
                if command == "xr":  # needs a runtime; tests/xr covers it
                    continue
                self.assertIsNotNone(json.loads(self.piped(command, "--json", *asked[command])[0]))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
