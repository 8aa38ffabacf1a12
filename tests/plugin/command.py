"""Base of the tests that run the command with plugins."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

# The program, the example's library, the folder of the test plugins, the source tree.
CLOTHBENCH, EXAMPLE, LIBRARIES, SOURCE = sys.argv[1:5]


def main():
    unittest.main(argv=sys.argv[:1] + sys.argv[5:])


class PluginTest(unittest.TestCase):
    def setUp(self):
        self.home = tempfile.mkdtemp(prefix="clothbench-plugin-")
        self.addCleanup(shutil.rmtree, self.home, ignore_errors=True)
        self.out = os.path.join(self.home, "out")
        self.log = os.path.join(self.home, "log.txt")

    def library(self, name):
        return "plugin:" + os.path.join(LIBRARIES, name + ".so")

    def start(self, *words, **environment):
        env = {k: v for k, v in os.environ.items() if k != "CLOTHBENCH_PLUGINS"}
        env |= {"CLOTHBENCH_SCENARIOS": os.path.join(SOURCE, "scenarios"), "LOG": self.log, **environment}
        return subprocess.Popen([CLOTHBENCH, *words], env=env, cwd=self.home, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def command(self, *words, **environment):
        process = self.start(*words, **environment)
        self.text, _ = process.communicate(timeout=180)
        return process.returncode

    def rows(self, *words, code=0, **environment):
        """The JSON that the command prints; text on standard error may come before and after it."""
        self.assertEqual(self.command("--json", *words, **environment), code, self.text)
        starts = [k for k in (self.text.find(s) for s in ("[\n", "{\n", "[]")) if k >= 0]
        return json.JSONDecoder().raw_decode(self.text[min(starts) :])[0]
