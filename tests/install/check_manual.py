"""usage: check_manual.py CLOTHBENCH SOURCE: the manual page names every command, option and environment variable."""
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

CLOTHBENCH, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])
# A program tells these to itself, or they are other programs'.
OTHERS = {"HOME", "PATH", "TERM", "XDG_CACHE_HOME", "XDG_DATA_HOME"}


def said(*words):
    return subprocess.run([CLOTHBENCH, *words], capture_output=True, text=True, check=True).stdout


def variables():
    """Those that the sources read: by name, or by a constant."""
    out, shared = set(), {}
    for file in (SOURCE / "harness" / "base").glob("*.hpp"):
        shared |= dict(re.findall(r'constexpr char (k\w+)\[\] = "(\w+)"', file.read_text(encoding="utf-8")))
    for folder in ("harness", "solvers"):
        for file in (SOURCE / folder).rglob("*.[ch]pp"):
            text = file.read_text(encoding="utf-8")
            names = shared | dict(re.findall(r'constexpr char (k\w+)\[\] = "(\w+)"', text))
            for word in re.findall(r"getenv\(([^)]*)\)", text):
                if not word.endswith(".variable"):
                    out.add(word.strip('"') if word.startswith('"') else names[word])
    folders = (SOURCE / "harness" / "base" / "data_folder.hpp").read_text(encoding="utf-8")
    return out | set(re.findall(r'"(CLOTHBENCH_\w+)"', folders))


class Manual(unittest.TestCase):
    def setUp(self):
        self.roff = said("manual")
        self.page = self.roff.replace("\\-", "-")

    def test_every_command_and_option(self):
        help_text = said("--help")
        commands = re.findall(r"^  ([a-z]+)  ", help_text[help_text.index("Subcommands:") :], re.MULTILINE)
        self.assertGreater(len(commands), 10)
        sections = {s.split("\n", 1)[0]: s for s in re.split(r"^\.SS ", self.page, flags=re.MULTILINE)[1:]}
        self.assertEqual(list(sections), commands)
        for command in commands:
            options = re.findall(r"^  (?:-\w,)?(--[\w-]+)", said(command, "--help"), re.MULTILINE)
            self.assertIn("--help", options)
            for option in options:
                self.assertRegex(sections[command], rf"(?m)^\\fB.*{option}\b", command)

    def test_every_variable(self):
        known = variables()
        self.assertLessEqual({"CLOTHBENCH_SCENARIOS", "CLOTHBENCH_ASSETS", "CLOTHBENCH_PLUGINS", "NO_COLOR"}, known)
        told = set(re.findall(r"^\\fB(\w+)\\fP$", self.page[self.page.index(".SH ENVIRONMENT") :], re.MULTILINE))
        self.assertEqual(told, known - OTHERS)

    def test_every_locale_can_show_it(self):
        self.assertTrue(self.roff.isascii(), [line for line in self.roff.splitlines() if not line.isascii()])

    def test_groff_has_no_complaint(self):
        if shutil.which("groff") is None:
            self.skipTest("no groff")
        done = subprocess.run(
            ["groff", "-man", "-Tutf8", "-ww", "-z", "-k"], input=self.roff, capture_output=True, text=True, check=False
        )
        self.assertEqual((done.returncode, done.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
