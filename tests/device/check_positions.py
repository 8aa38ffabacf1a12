"""The same runs on arm64 (under qemu, arm64 lavapipe) and on this machine: same positions; the device's CBOR files import."""
import json

import h5py
import numpy as np

from device import *

# Maximum difference of a coordinate, as a fraction of the cloth's width: rounding errors that grow over half a second of motion
# (1.5 s in the sweep). `ballistic` is plain IEEE double. `xpbd` and `paper` are float32 in shaders that no driver has contracted
# so far; the sums of `paper` have no fixed order. Bullet computes square roots and products with SSE here, with NEON there.
TOLERANCE = {"ballistic": 0.0, "bullet-soft": 1e-4, "xpbd": 1e-6, "paper": 1e-5}
# scene, changes to it, solvers
SCENES = [
    ("fall", "paper/gravity", ["--set", "cloth.grid=[16,16]", "--set", "time.duration_s=0.5"], list(TOLERANCE)),
    ("hang", "paper/gravity", ["--set", "cloth.grid=[9,7]", "--set", "time.duration_s=0.5",
                               "--set", 'pins=[{"corners":["u0v0","u1v0"]}]'], list(TOLERANCE)),
    ("sweep", "paper/capsule-sweep", ["--set", "cloth.grid=[9,7]", "--set", "time.duration_s=1.5",
                                       "--set", "cloth.sides=single"], ["xpbd", "paper", "ballistic"]),
]


def positions(folder, name):
    with h5py.File(next(folder.glob(f"*__{name}__default.h5"))) as f:
        assert f["outcome"].attrs["status"] == "ok", (folder, name, f["outcome"].attrs["message"])
        e = json.loads(f["header_json"][0])["environment"]
        return f["trajectory/position"][:], e["gpu"], e["os"], e["shader_compiler"]


failed = False
with Folder() as folder:
    for scene, file, options, names in SCENES:
        solvers = [w for name in names for w in ("--solver", name)]
        arguments = ["run", file, *solvers, *options, "--trials", "1"]
        there, here = folder / scene / "arm64", folder / scene / "host"
        must(qemu(BUILD / "clothbench", *arguments, "--out", there))
        assert not list(there.glob("*.h5")), "the device build has no HDF5"
        must([HOST_COMMAND, "import", there])
        must([HOST_COMMAND, *arguments, "--out", here])
        for name in names:
            tolerance = TOLERANCE[name]
            a, gpu, os_name, compiler = positions(there, name)
            b, _, _, host_compiler = positions(here, name)
            assert os_name.endswith("aarch64"), os_name
            assert compiler == host_compiler, "one compiler's SPIR-V runs on both"
            assert a.shape == b.shape and a.shape[0] > 36, (a.shape, b.shape)
            moved = float(np.max(np.abs(a[-1] - a[0])))
            assert moved > 1e-3, f"{scene} {name}: nothing moved"
            difference = float(np.max(np.abs(a.astype(float) - b.astype(float))))  # the cloth is 1 m wide
            ok = difference <= tolerance
            failed |= not ok
            print(f"{'ok' if ok else 'FAIL'} {scene} {name}: {difference:.2e} of the width, allowed {tolerance:.0e} ({gpu or 'CPU'})")
sys.exit(1 if failed else 0)
