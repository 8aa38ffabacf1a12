"""usage: check_roots.py CMAKE SOURCE: a wrong folder of an engine stops configuring, with its path and the file missing there."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

CMAKE, SOURCE = sys.argv[1:3]
ENGINES = {
    "nvcloth": ("NVCLOTH_ROOT", "NvCloth/include/NvCloth/Factory.h"),
    "jolt": ("JOLT_ROOT", "Build/CMakeLists.txt"),
}


class Roots(unittest.TestCase):
    def setUp(self):
        self.home = tempfile.mkdtemp(prefix="clothbench-peers-")
        self.addCleanup(shutil.rmtree, self.home, ignore_errors=True)

    def configure(self, engine, *words):
        done = subprocess.run(
            [CMAKE, "-S", os.path.join(SOURCE, "solvers", "plugin", engine), "-B", os.path.join(self.home, engine), *words],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        )
        self.text = " ".join(done.stdout.split())  # CMake breaks lines
        return done.returncode

    def test_a_folder_that_is_not_the_engines(self):
        for engine, (variable, file) in ENGINES.items():
            root = os.path.join(self.home, "nothing")
            self.assertNotEqual(self.configure(engine, f"-D{variable}={root}"), 0, self.text)
            self.assertIn(f"{variable}={root}: expected the file {root}/{file}", self.text)

    def test_no_folder(self):
        for engine, (variable, _) in ENGINES.items():
            self.assertNotEqual(self.configure(engine), 0, self.text)
            self.assertIn(f"{variable} is not set", self.text)

    def test_a_folder_that_has_the_first_file_alone(self):
        root = pathlib.Path(self.home, "half")
        first = root / ENGINES["nvcloth"][1]
        first.parent.mkdir(parents=True)
        first.touch()
        self.assertNotEqual(self.configure("nvcloth", f"-DNVCLOTH_ROOT={root}"), 0, self.text)
        self.assertIn(f"{root}/NvCloth/extensions/include/NvClothExt/ClothFabricCooker.h", self.text)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
