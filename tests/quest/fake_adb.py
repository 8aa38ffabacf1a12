#!/usr/bin/python3 -IS
"""An adb with a headset behind it that exists on paper: prints what recorded tools print, and stores the commands that it gets.

$FAKE_ADB names a folder: plan.json says what goes wrong, world.json what the headset's state is, calls.log what was asked.
Formats: `adb devices -l`, dumpsys and df of Android 14; ovrgpuprofiler, VrApi and OVR Metrics as Meta's documentation and
public logs of Quest 2 and 3 show them.
"""
import fcntl
import json
import os
import sys
import time

HOME = os.environ["FAKE_ADB"]
PLAN = json.load(open(os.path.join(HOME, "plan.json"), encoding="utf-8"))
TICK = 0.1  # of counters and log; a headset's is 1 s
VRAPI = (
    "FPS={fps}/{hz},Prd=38ms,Tear=0,Early=0,Stale=0,Stale2/5/10/max=0/0/0/0,VSnc=1,Lat=-1,Fov=0,CPU4/GPU={cpu}/{gpu},1171/{mhz}MHz,OC=FF,"
    "TA=0/0/0,SP=N/N/N,Mem=2092MHz,Free=2975MB,PLS={pls},Temp=32.2C/0.0C,TW=1.25ms,App=4.49ms,GD=0.00ms,CPU&GPU=12.96ms,LCnt=2(DR72,LM2),"
    "GPU%=0.43,CPU%=0.37(W0.50),DSF=1.00"
)
METRICS = [
    "Clocks / Second",
    "GPU % Bus Busy",
    "% Vertex Fetch Stall",
    "% Texture Fetch Stall",
    "L1 Texture Cache Miss Per Pixel",
    "% Texture L1 Miss",
    "% Texture L2 Miss",
    "% Stalled on System Memory",
    "Pre-clipped Polygons/Second",
    "% Prims Trivially Rejected",
    "% Prims Clipped",
    "Read Total (Bytes/sec)",
    "Write Total (Bytes/sec)",
]


class World:
    """world.json under a lock: commands run side by side."""

    def __enter__(self):
        self._lock = open(os.path.join(HOME, "lock"), "w")
        fcntl.flock(self._lock, fcntl.LOCK_EX)
        path = os.path.join(HOME, "world.json")
        self.state = (
            json.load(open(path, encoding="utf-8"))
            if os.path.exists(path)
            else {
                "props": dict(PLAN.get("props", {})),
                "started": None,
                "stopped": None,
                "csv": None,
                "csv_end": None,
                "worn": False,
            }
        )
        return self.state

    def __exit__(self, *_):
        path = os.path.join(HOME, "world.json")
        with open(path + ".tmp", "w", encoding="utf-8") as out:
            json.dump(self.state, out)
        os.replace(path + ".tmp", path)
        self._lock.close()


def clock():
    return time.time() + PLAN.get("clock_ahead_s", 0)


def unplugged(world):
    gap = PLAN.get("unplugged")  # [from, to] seconds after the app's start; to null: for the rest of the run
    if not gap or world["started"] is None:
        return False
    if os.path.exists(os.path.join(HOME, "plugged-in")):
        return False
    since = clock() - world["started"]
    return since >= gap[0] and (gap[1] is None or since < gap[1])


def die(text, code=1):
    sys.stderr.write(text + "\n")
    sys.exit(code)


def say(text):
    sys.stdout.buffer.write((text + "\n").replace("\n", PLAN.get("line_end", "\n")).encode())
    sys.stdout.flush()


def app_state(world):
    """running, ended or gone."""
    if world["started"] is None or world["stopped"] is not None:
        return "gone"
    since = clock() - world["started"]
    if PLAN.get("crash_after_s") is not None and since >= PLAN["crash_after_s"]:
        return "gone"
    return "running" if since < PLAN.get("run_s", 1.5) else "ended"


def now_values(world):
    since = clock() - (world["started"] or clock())
    moved = PLAN.get("moves_after_s") is not None and since >= PLAN["moves_after_s"]
    values = {"fps": 72, "hz": 72, "cpu": 4, "gpu": 4, "mhz": 545, "pls": 0, "tenths": 312}
    values.update(PLAN.get("moves_to", {}) if moved else {})
    return values


def devices():
    say("List of devices attached")
    for serial, state, model in PLAN.get("devices", [["1WMHH000000000", "device", "Quest_3"]]):
        say(f"{serial}         {state} usb:1-2 product:eureka model:{model} device:eureka transport_id:1")


def dumpsys(world, what):
    v = now_values(world)
    if what == "battery":
        say(
            f"Current Battery Service state:\n  AC powered: false\n  USB powered: true\n  Wireless powered: false\n  status: 2\n"
            f"  present: true\n  level: {PLAN.get('level', 84)}\n  scale: 100\n  temperature: {PLAN.get('tenths', v['tenths'])}\n  technology: Li-ion"
        )
    else:
        say(f"IsStatusOverride: false\nThermal Status: {PLAN.get('thermal', 0)}\nCached temperatures:")


def profiler(words):
    if not PLAN.get("profiler", True):
        die("/system/bin/sh: ovrgpuprofiler: inaccessible or not found", 127)
    names = [n for n in METRICS if n not in PLAN.get("missing_metrics", [])]
    if words == "-m":
        return say(f"{len(names)} metrics supported:\n" + "\n".join(f"{k}\t{n}" for k, n in enumerate(names, 1)))
    asked = [int(k) for k in words[len("-r") :].strip('"').split(",")]
    for second in range(10**6):
        with World() as world:
            if unplugged(world):
                sys.exit(255)
        for k in asked:
            name = names[k - 1]
            # Read 2.8 GB/s with a peak of 3.5 every fifth sample, write 1.9.
            value = {
                "Read Total (Bytes/sec)": 3.5e9 if second % 5 == 4 else 2.8e9,
                "Write Total (Bytes/sec)": 1.9e9,
            }.get(name, 427468384.0)
            sys.stdout.buffer.write(f"{name:<43}:   {value:.3f}\r\r\n".encode())
        sys.stdout.buffer.write(b"\r\r\n")
        sys.stdout.flush()
        time.sleep(TICK)


def logcat(words):
    if "-b" in words:
        return say(
            "F libc    : Fatal signal 11 (SIGSEGV), code 1, fault addr 0x10 in tid 4242 (clothbench)"
            if PLAN.get("crash_after_s") is not None
            else ""
        )
    since = words[words.index("-T") + 1]
    position = clock() if since == "1" else float(since)
    told = False
    say("--------- beginning of main")
    if since == "1":
        say(f"     {position - 100:.3f}  4000  4001 I clothbench: RESULT FAIL /an/older/run")
    while True:
        with World() as world:
            if unplugged(world):
                sys.exit(255)
            v = now_values(world)
            state, started = app_state(world), world["started"]
        now = clock()
        if PLAN.get("vrapi", True):
            say(f"     {now:.3f}  4242  4250 I VrApi   : " + VRAPI.format(**v))
            say(
                f"     {now:.3f}  4242  4250 D VrApi   : VrApi::isWifiConnected exception: Make sure a permission is set"
            )
        if state == "ended" and not told and started is not None:
            end = started + PLAN.get("run_s", 1.5)
            if end >= position:
                say(f"     {end:.3f}  4242  4251 I clothbench: RESULT {PLAN.get('result', 'PASS')} {PLAN['runs']}")
            told = True
        time.sleep(TICK)


def metrics_file(world):
    """What OVR Metrics would have written: a row a tick, the last one torn."""
    head = (
        "Time Stamp,available_memory_MB,battery_temperature_celcius,power_level_state,cpu_level,gpu_level,cpu_frequency_MHz,"
        "gpu_frequency_MHz,average_frame_rate,display_refresh_rate,stale_frame_count"
    )
    rows = int(((world["csv_end"] or clock()) - world["csv"]) / TICK)
    lines = [head] + [
        f"{int(1000 * TICK * (k + 1))},2900,31.2,0,4,4,1171,545,72,72,0" + (",segment_0" if k == 3 else "")
        for k in range(rows)
    ]
    return "\r\n".join(lines) + "\r\n" + f"{int(1000 * TICK * (rows + 1))},2900,31"


def pull(source, into):
    name = os.path.basename(source.rstrip("/"))
    if PLAN.get("pull_fails") and PLAN["pull_fails"] in source:
        die(f"adb: error: cannot write '{into}/{name}': No space left on device")
    if name == "session.json":
        if not PLAN.get("session", True):
            die(f"adb: error: failed to stat remote object '{source}': No such file or directory")
        text = json.dumps({"commands": [{"line": "study table3", "state": "pass", "out": PLAN["runs"]}]})
    elif name.endswith(".csv"):
        with World() as world:
            text = metrics_file(world)
    else:
        with World() as world:
            started = world["started"]
        import subprocess  # not at the top: adb is started some fifty times a run

        # Raw files of a run that was under way while the app was.
        subprocess.run(
            [PLAN["make_sample"], os.path.join(into, name), f"{started:.6f}"], check=True, stdout=subprocess.DEVNULL
        )
        return say(f"{source}: 3 files pulled")
    with open(os.path.join(into, name), "w", encoding="utf-8", newline="") as out:
        out.write(text)
    say(f"{source}: 1 file pulled")


def shell(world, command):
    words = command.split()
    if words[0] == "getprop":
        known = {
            "ro.product.model": PLAN.get("model", "Quest 3"),
            "ro.build.version.release": "14",
            "ro.build.display.id": "UP1A.231005.007.A1",
            "ro.build.version.incremental": "51503180125000520",
        }
        say(known.get(words[1], world["props"].get(words[1], "")))
    elif words[0] == "setprop":
        if words[1] in PLAN.get("stubborn_props", []):
            return die(f"Failed to set property '{words[1]}' to '{words[2]}'.")
        world["props"][words[1]] = words[2].strip("'\"")
    elif words[0] == "dumpsys":
        dumpsys(world, words[1])
    elif words[0] == "df":
        say(
            f"Filesystem     1K-blocks     Used Available Use% Mounted on\n/dev/fuse      117000000 1 {PLAN.get('free_kB', 60000000)}  9% /storage/emulated"
        )
    elif words[0] == "date":
        say(f"{clock():.9f}")
    elif words[0] == "pm":
        say("package:/data/app/~~x==/org.clothbench.quest-y==/base.apk" if PLAN.get("installed", True) else "")
    elif words[0] == "pidof":
        say("4242" if app_state(world) == "running" else "")
    elif words[0] == "ls":
        say(
            "com.old.app_20260101.csv"
            + ("\norg.clothbench.quest_now.csv" if world["csv"] and PLAN.get("metrics_tool", True) else "")
        )
    elif words[:2] == ["am", "start"]:
        if PLAN.get("start_fails"):
            return say(
                "Starting: Intent { act=android.intent.action.MAIN }\nError type 3\nError: Activity class does not exist."
            )
        world.update(started=clock(), stopped=None, extra=command.split("--es args ")[1])
        say("Starting: Intent { act=android.intent.action.MAIN }\nStatus: ok\nComplete")
    elif words[:2] == ["am", "force-stop"]:
        world["stopped"] = clock() if world["started"] is not None else None
    elif words[:2] == ["am", "broadcast"]:
        if "ENABLE_CSV" in command:
            world["csv"] = clock()
        if "DISABLE_CSV" in command:
            world["csv_end"] = clock()
        if "prox_close" in command or "automation_disable" in command:
            world["worn"] = "prox_close" in command
        say("Broadcasting: Intent\nBroadcast completed: result=0")
    else:
        die(f"/system/bin/sh: {words[0]}: inaccessible or not found", 127)


def main():
    words = sys.argv[1:]
    with open(os.path.join(HOME, "calls.log"), "a", encoding="utf-8") as out:
        out.write(json.dumps(words) + "\n")
    serial = None
    if words[0] == "-s":
        serial, words = words[1], words[2:]
    if words[0] == "devices":
        return devices()
    with World() as world:
        gone = unplugged(world)
    if gone:
        die(f"adb: device '{serial}' not found")
    if words[0] == "get-state":
        say("device")
    elif words[0] == "install":
        die(f"adb: failed to install {words[-1]}: Failure [INSTALL_FAILED_INSUFFICIENT_STORAGE]") if PLAN.get(
            "install_fails"
        ) else say("Success")
    elif words[0] == "logcat":
        logcat(words[1:])
    elif words[0] == "pull":
        pull(words[1], words[2])
    elif words[0] == "shell" and "ovrgpuprofiler" in words[-1]:
        profiler(words[-1].split(None, 1)[1])
    elif words[0] == "shell":
        with World() as world:
            shell(world, words[-1])
    else:
        die(f"adb: unknown command {words[0]}")


if __name__ == "__main__":
    main()
