"""`clothbench xr` on Monado, an independent OpenXR runtime: its simulated headset, without hands and without a display.

usage: check_monado.py COMMAND

Needs Debian 13's packages monado-service, libopenxr1-monado and openxr-layer-corevalidation; exit status 77 without them. Each
session has to draw every frame, OpenXR's core validation layer has to stay silent, and the recording has to replay bit for bit."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

import h5py
import numpy

command = sys.argv[1]
manifest = pathlib.Path("/usr/share/openxr/1/openxr_monado.json")
layer = "XR_APILAYER_LUNARG_core_validation"
layers = [folder / "openxr/1/api_layers/explicit.d" for folder in map(pathlib.Path, ("/usr/share", "/etc", "/usr/local/share"))]
if not shutil.which("monado-service") or not manifest.exists() or not any(f.glob("*core_validation*") for f in layers if f.exists()):
    print("SKIPPED: no Monado or no core validation layer")
    sys.exit(77)

FRAMES = 72
# A grid and a triangle mesh.
SCENES = {"paper/capsule-sweep": [], "garments/sleeve": ["--set", 'cloth.mesh.file="assets/sleeve-small.obj"']}


def check(scene, top, environment):
    """A session of `scene`, what the validation layer says of it, and its replay."""
    findings = top / "validation.txt"
    session = subprocess.run(
        [command, "xr", scene, *SCENES[scene], "--frames", str(FRAMES), "--out", str(top / "live")], text=True, timeout=600,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        env={**environment, "XR_ENABLE_API_LAYERS": layer, "XR_CORE_VALIDATION_EXPORT_TYPE": "text",
             "XR_CORE_VALIDATION_FILE_NAME": str(findings)})
    print(session.stdout)
    assert session.returncode == 0, f"{scene}: exit status {session.returncode}"
    assert "Monado" in session.stdout, "the session does not name Monado as its runtime"
    messages = [line for line in findings.read_text(encoding="utf-8").splitlines() if "VALID_" in line]
    assert any("Core Validation Layer is initialized" in m for m in messages), "the validation layer was not loaded"
    assert all("VALID_DEBUG" in m or "VALID_INFO" in m for m in messages), "\n".join(messages)
    with h5py.File(next((top / "live").glob("*.h5"))) as f:
        live = f["xr/final_position_m"][:]
        assert f["timing/frame_wall_s"].shape == (1, FRAMES), f["timing/frame_wall_s"].shape
    subprocess.run([command, "run", str(top / "live/scenario/scenario.json"), "--trials", "0", "--out", str(top / "replay")], check=True,
                   env=environment, stdout=subprocess.DEVNULL)
    with h5py.File(next((top / "replay").glob("*.h5"))) as f:
        replayed = f["trajectory/position"][-1]
    assert (replayed == live.astype(numpy.float32)).all(), (scene, abs(replayed - live).max())


with tempfile.TemporaryDirectory(prefix="clothbench-monado-") as top:
    top = pathlib.Path(top)
    environment = {**os.environ, "XDG_RUNTIME_DIR": str(top), "XR_RUNTIME_JSON": str(manifest), "XRT_COMPOSITOR_NULL": "1",
                   "CLOTHBENCH_ASSETS": "procedural"}
    with open(top / "service.log", "w", encoding="utf-8") as log:
        # It ends when its standard input does.
        service = subprocess.Popen(["monado-service"], stdin=subprocess.PIPE, stdout=log, stderr=log, env=environment)
    try:
        deadline = time.monotonic() + 60
        while not (top / "monado_comp_ipc").exists():
            assert service.poll() is None and time.monotonic() < deadline, (top / "service.log").read_text(encoding="utf-8")
            time.sleep(0.1)
        for n, scene in enumerate(SCENES):
            (top / str(n)).mkdir()
            check(scene, top / str(n), environment)
    except AssertionError:
        print((top / "service.log").read_text(encoding="utf-8"), file=sys.stderr)
        raise
    finally:
        service.kill()
        service.wait()
print(f"ok: {len(SCENES)} sessions of {FRAMES} frames on Monado, no validation message, the recordings replay bit for bit")
