"""Shared by the checks of the arm64-linux build: paths, running under qemu, skipping.

Every check is called as: check_….py BUILD_FOLDER SOURCE_FOLDER ARM64_ROOT"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

SKIP = 77
BUILD, SOURCE, ROOT = (pathlib.Path(a) for a in sys.argv[1:4])
HOST_COMMAND = pathlib.Path(os.environ.get("CLOTHBENCH_HOST_COMMAND", SOURCE / "build" / "release" / "clothbench"))
LIBRARIES = ROOT / "usr" / "lib" / "aarch64-linux-gnu"


def skip(why):
    """Skips the check; fails it instead if scripts/arm64.sh states, by CLOTHBENCH_NO_SKIPS, that nothing is missing."""
    complete = os.environ.get("CLOTHBENCH_NO_SKIPS") == "1"
    print("FAIL, cannot be skipped here:" if complete else "SKIPPED:", why)
    sys.exit(1 if complete else SKIP)


def qemu(*command):
    """The command line that runs an arm64 program with the arm64 libraries and lavapipe."""
    driver = next((ROOT / "usr/share/vulkan/icd.d").glob("lvp_icd*.json"))
    path = f"{LIBRARIES}:{ROOT}/lib/aarch64-linux-gnu:{BUILD}/stubs"
    return ["qemu-aarch64-static", "-L", str(ROOT), "-E", f"LD_LIBRARY_PATH={path}", "-E", f"VK_ICD_FILENAMES={driver}",
            # Unoptimised shaders: the compiler, which is emulated too, takes longer than the frames.
            "-E", "GALLIVM_PERF=nopt",
            # Under qemu-user a program cannot start itself again as a worker process.
            "-E", "CLOTHBENCH_IN_PROCESS=1",
            *map(str, command)]


def run(command, **options):
    done = subprocess.run([str(c) for c in command], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, **options)
    return done.returncode, done.stdout


def must(command, **options):
    code, text = run(command, **options)
    if code != 0:
        sys.exit(f"exit code {code}: {' '.join(map(str, command))}\n{text}")
    return text


class Folder(tempfile.TemporaryDirectory):
    """A temporary folder that goes when the check ends."""
    def __enter__(self):
        return pathlib.Path(self.name)
