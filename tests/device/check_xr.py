"""Live sessions on arm64 on the null runtime: by the command, and by the activity; what they recorded replays here."""
import json

import h5py
import numpy as np

from device import *

MANIFEST = sys.argv[4]
WORDS = ["xr", "paper/capsule-sweep", "--frames", "24", "--set", "cloth.grid=[9,7]"]
MESH = ["xr", "validation/hang-mesh", "--frames", "6", "--set", 'cloth.mesh={"drawn":{"size_m":[1,1],"cells":6}}']
TOLERANCE = 1e-6  # of the cloth's width, as for positions (check_positions.py)


def environment(folder):
    # Without rendering: Debian's lavapipe for arm64 crashes under qemu with any drawing.
    return {**os.environ, "CLOTHBENCH_ASSETS": "procedural", "FAKE_ASSETS": str(BUILD / "packed-assets"), "XR_RUNTIME_JSON": MANIFEST,
            "CLOTHBENCH_NULL_XR": f"blind=1,log={folder}/runtime.json"}


def told(folder, **expected):
    log = json.loads((folder / "runtime.json").read_text())
    assert log["faults"] == [], log
    assert all(log[k] == v for k, v in expected.items()), (log, expected)
    return log


def replays(live, folder):
    """The session's CBOR file becomes HDF5 here, and its scenario runs here to the same positions."""
    must([HOST_COMMAND, "import", live])
    with h5py.File(next(live.glob("*.h5"))) as f:
        end, periods = f["xr/final_position_m"][:], f["xr/periods"][1:]
    assert set(periods) == {1}, periods
    must([HOST_COMMAND, "run", live / "scenario/scenario.json", "--trials", "0", "--out", folder / "replay"])
    with h5py.File(next((folder / "replay").glob("*.h5"))) as f:
        here = f["trajectory/position"][:]
    difference = float(np.max(np.abs(here[-1] - end)))
    assert np.max(np.abs(here[-1] - here[0])) > 1e-3, "nothing moved"
    assert difference <= TOLERANCE, difference
    return difference


with Folder() as top:
    for name, words, frames in (("command", WORDS, 24), ("mesh", MESH, 6)):
        folder = top / name
        folder.mkdir()
        text = must(qemu(BUILD / "clothbench", *words, "--out", folder / "live"), env=environment(folder))
        assert f"{frames} frames: ok" in text, text
        told(folder, rate_hz=72, android=False)
        print(f"ok: the command, {words[1]}; replayed here to {replays(folder / 'live', folder):.1e} of the width")

    folder = top / "activity"
    (folder / "files").mkdir(parents=True)
    (folder / "internal").mkdir()
    text = must(qemu(BUILD / "fake_host", BUILD / "libclothbench_quest.so", folder / "files", folder / "internal", " ".join([*WORDS, "--out", "runs/live"]),
                     "create", "resume", "finish", "pause", "destroy"), env=environment(folder), timeout=600)
    assert [l for l in text.splitlines() if ": RESULT " in l][-1].endswith("RESULT PASS"), text
    told(folder, android=True)
    print(f"ok: the activity; replayed here to {replays(folder / 'files/runs/live', folder):.1e} of the width")
