"""The activity's library under a fake Android: arguments, life-cycle orders, results, resuming after a kill."""
import contextlib
import json
import time

from device import *

ARGS = "study small.json --out runs/small"
STUDY = {
    "name": "small", "why": "A test.", "protocol": "fps",
    "scenes": [{"file": "paper/gravity.json", "axes": [{"key": "cloth.grid", "values": [[8, 8], [9, 7]], "labels": ["8", "9x7"]}]}],
    "solvers": [{"solver": "ballistic"}, {"solver": "xpbd"}], "trials": 3,
    "rules": {"frames": 24, "max_wall_s": 1, "min_frames": 12, "warmup_s": 0.05}, "drop_frames": 12, "accuracy_duration_s": 0.2}


def host(folder, args, *steps):
    return qemu(BUILD / "fake_host", BUILD / "libclothbench_quest.so", folder / "files", folder / "internal", args, *steps)


def fresh(parent, name):
    folder = parent / name
    (folder / "files").mkdir(parents=True)
    (folder / "internal").mkdir()
    # Scenes are named relative to the study's own folder.
    study = json.loads(json.dumps(STUDY))
    study["scenes"][0]["file"] = str(folder / "internal/packed/scenarios/paper/gravity.json")
    (folder / "files" / "small.json").write_text(json.dumps(study))
    return folder


def result_of(text):
    lines = [l for l in text.splitlines() if l.startswith("I clothbench: ")]
    assert lines and lines[-1].startswith("I clothbench: RESULT "), f"the last line is not the result:\n{text}"
    assert sum(": RESULT " in l for l in lines) == 1, text
    return lines[-1].split()[3]


def trials(out):
    """Trials in each file: the beginnings of their CBOR items, an object with the key "trial"."""
    counted = {}
    for p in [*out.glob("*.part"), *out.glob("*.cbor")]:
        with contextlib.suppress(FileNotFoundError):  # renamed meanwhile, because its run ended
            counted[p.name] = p.read_bytes().count(b"\xa1\x65trial")
    return counted


def done(folder):
    return sum(sum(trials(out).values()) for out in folder.glob("files/runs/*"))


with Folder() as top:
    environment = {**os.environ, "FAKE_ASSETS": str(BUILD / "packed-assets")}
    call = lambda command: must(command, env=environment, timeout=600)

    # One life cycle without disturbances; arguments come from an intent extra.
    f = fresh(top, "plain")
    verdict, out = result_of(text := call(host(f, ARGS, "create", "resume", "finish", "pause", "destroy"))), f / "files/runs/small"
    assert verdict == "PASS", text
    assert "runs ok" in text, "what the command prints stands in the log:\n" + text
    assert len(trials(out)) == 4 and set(trials(out).values()) == {3}, trials(out)
    assert len(must([HOST_COMMAND, "import", out]).split()) == 4

    # A command that fails.
    f = fresh(top, "wrong")
    verdict = result_of(text := call(host(f, "run no-such-scene", "create", "resume", "finish", "destroy")))
    assert verdict == "FAIL" and "no-such-scene: no such file" in text, text

    # Paused and resumed; destroyed during a run; created again in the same process.
    f = fresh(top, "lives")
    text = call(host(f, ARGS, "create", "resume", "150", "pause", "100", "resume", "200", "destroy", "result"))
    result_of(text)
    assert "paused" in text, text
    text = call(host(f, ARGS + " --resume", "create", "pause", "destroy", "result", "create", "resume", "finish", "pause", "resume", "destroy"))
    assert text.count(": RESULT ") == 2 and text.rstrip().splitlines()[-1].startswith("I clothbench: RESULT PASS"), text

    # Killed at several times; with --resume it completes.
    f = fresh(top, "killed")
    for least, more in ((1, ""), (2, " --resume"), (7, " --resume")):  # trials finished before the kill
        child = subprocess.Popen(host(f, ARGS + more, "create", "resume", "finish", "destroy"), env=environment,
                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while done(f) < least and child.poll() is None:
            time.sleep(0.01)
        child.kill()
        child.wait()
    verdict = result_of(text := call(host(f, ARGS + " --resume", "create", "resume", "finish", "destroy")))
    assert verdict == "PASS" and set(trials(f / "files/runs/small").values()) == {3}, text

    # Damaged assets also give a RESULT line.
    f = fresh(top, "damaged")
    shutil.copytree(BUILD / "packed-assets", f / "packed")
    (f / "packed/scenarios/paper/gravity.json").write_text("{}")
    environment["FAKE_ASSETS"] = str(f / "packed")
    verdict = result_of(text := call(host(f, ARGS, "create", "finish", "destroy")))
    assert verdict == "FAIL" and "gravity.json" in text, text
