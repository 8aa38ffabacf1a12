"""`clothbench xr` through the system's OpenXR loader on the null runtime: what a user gets, and that it replays.

usage: check_command.py COMMAND MANIFEST"""
import ctypes.util
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy

command, manifest = sys.argv[1:3]
if not ctypes.util.find_library("openxr_loader"):
    print("SKIPPED: no libopenxr_loader (Debian: libopenxr-loader1)")
    sys.exit(77)


def run(*words, **environment):
    done = subprocess.run([command, *map(str, words)], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          env={**os.environ, "XR_RUNTIME_JSON": manifest, "CLOTHBENCH_ASSETS": "procedural", **environment})
    assert done.returncode == 0, f"exit code {done.returncode}: {words}\n{done.stdout}\n{done.stderr}"
    return done.stdout + done.stderr


with tempfile.TemporaryDirectory(prefix="clothbench-xr-") as top:
    top = pathlib.Path(top)
    text = run("xr", "paper/capsule-sweep", "--frames", 30, "--set", "cloth.grid=[12,12]", "--validate", "--out", top / "live",
               CLOTHBENCH_NULL_XR="stalls=20:0.02,META=1")
    assert "null headset on clothbench null runtime 1.0.0" in text, text
    assert "slowest 36.0" in text and "late frames        3.4 %" in text, text
    file = top / "live" / "capsule-sweep-live__xpbd__default.h5"
    with h5py.File(file) as f:
        xr = f["xr"]
        assert xr.attrs["rate_hz"] == 72, dict(xr.attrs)
        assert f["timing/frame_wall_s"].shape == (1, 30) and (f["timing/frame_wall_s"][:] > 0).all()
        assert sorted(set(xr["periods"][1:])) == [1, 2], xr["periods"][:]
        assert xr["frame_s"].dims[0][0].name == "/xr/frame" and xr["frame_s"].attrs["units"] == "s"
        assert abs(f["summary"].attrs["xr_fps_worst"] - 36) < 1e-3
        assert f["colliders/0/capsules"].shape == (31, 19, 7)
        assert f["timing/trial_end_unix_s"][0] > f["timing/trial_start_unix_s"][0] > 1.6e9
        busy = xr["counters/app_gpu_frametime"]
        assert busy.attrs["units"] == "ms" and (numpy.diff(busy) == 0.5).all(), busy[:]
        live = xr["final_position_m"][:]
    run("run", top / "live/scenario/scenario.json", "--trials", 0, "--out", top / "replay")
    with h5py.File(next((top / "replay").glob("*.h5"))) as f:
        replayed = f["trajectory/position"][-1]
    assert (replayed == live.astype(numpy.float32)).all(), abs(replayed - live).max()
    print("ok: a session, its file, its replay")

    told = json.loads(run("--json", "xr", "paper/capsule-sweep", "--frames", 5, "--set", "cloth.grid=[8,8]", "--out", top / "json"))
    assert told["summary"]["xr_frames"] == 5 and told["status"] == "ok", told
    text = run("xr", "paper/desk-flat-low", "--table", "--frames", 3, "--out", top / "table", CLOTHBENCH_NULL_XR="planes=1,blind=1")
    assert "on the user's table" in text, text
    print("ok: as JSON, on a table")
