#!/usr/bin/python3 -IS
"""An adb with a simulated headset: prints what recorded tools print, and stores the commands that it gets.

$FAKE_ADB names a folder: plan.json says what goes wrong, world.json what the headset's state is, calls.log what was asked.
Formats: `adb devices -l` of Android 14; ovrgpuprofiler and VrApi as Meta's documentation and public logs of Quest 2 and 3 show them.
"""
import base64
import json
import os
import subprocess
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from protobuf import message  # noqa: E402

HOME = os.environ["FAKE_ADB"]
PLAN = json.load(open(os.path.join(HOME, "plan.json"), encoding="utf-8"))
TICK_S = 0.05  # of counters and log; a headset's is 1 s
VRAPI = ("FPS=72/72,Prd=38ms,Tear=0,Early=0,Stale=0,Stale2/5/10/max=0/0/0/0,VSnc=1,Lat=-1,Fov=0,CPU4/GPU=4/{gpu},1171/{mhz}MHz,OC=FF,TA=0/0/0,"
         "SP=N/N/N,Mem=2092MHz,Free=2975MB,PLS=0,Temp=32.2C/0.0C,TW=1.25ms,App=4.49ms,GD=0.00ms,CPU&GPU=12.96ms,LCnt=2(DR72,LM2),GPU%=0.43,CPU%=0.37(W0.50),DSF=1.00,"
         "CFL=19.79/21.54,ICFLp95=20.94,LD=0,SF=1.00,LP=0,DVFS=0")
COUNTERS = {"Clocks / Second": 427468384.0, "GPU % Bus Busy": 40.0, "Read Total (Bytes/sec)": 2.8e9, "Write Total (Bytes/sec)": 1.9e9}
PATH = os.path.join(HOME, "world.json")


def world():
    return json.load(open(PATH, encoding="utf-8")) if os.path.exists(PATH) else {"props": PLAN["props"], "started": None, "stopped": None, "worn": False}


def change(**values):
    with open(PATH + ".tmp", "w", encoding="utf-8") as out:
        json.dump({**world(), **values}, out)
    os.replace(PATH + ".tmp", PATH)


def clock():
    return time.time() + PLAN.get("clock_ahead_s", 0)


def die(text, code=1):
    sys.stderr.write(text + "\n")
    sys.exit(code)


def since_start():
    started = world()["started"]
    return -1 if started is None else clock() - started


def leave_if_unplugged():
    if since_start() >= PLAN.get("unplugged_after_s", 1e9):
        die("adb: device '1WMHH000000000' not found")


def running():
    return world()["stopped"] is None and 0 <= since_start() < min(PLAN.get("crash_after_s", 1e9), PLAN["run_s"])


def logcat(words):
    if "-b" in words:
        return print("F libc    : Fatal signal 11 (SIGSEGV), code 1, fault addr 0x10 in tid 4242 (clothbench)")
    reported, announced = False, False
    print(f"--------- beginning of main\n     {clock() - 100:.3f}  4000  4001 I clothbench: RESULT FAIL", flush=True)
    while True:
        leave_if_unplugged()
        moved = since_start() >= PLAN.get("moves_after_s", 1e9)
        if not announced and since_start() >= PLAN.get("announces_after_s", 1e9):
            print(f"     {clock():.3f}  2817  3566 I XrPerformanceManager: perfmgr: SetClockLevels: Apply pending clock request change: 4,4 -> 4,2")
            announced = True
        if PLAN.get("vrapi", True) and since_start() < PLAN.get("log_ends_after_s", 1e9):
            print(f"     {clock():.3f}  4242  4250 I VrApi   : " + VRAPI.format(**({"gpu": 2, "mhz": 456} if moved else {"gpu": 4, "mhz": 545})))
        if not reported and since_start() >= PLAN["run_s"]:
            print(f"     {clock():.3f}  4242  4251 I clothbench: RESULT {PLAN.get('result', 'PASS')}")
            reported = True
        sys.stdout.flush()
        time.sleep(TICK_S)


def profiler(words):
    if not PLAN.get("profiler", True):
        die("/system/bin/sh: ovrgpuprofiler: inaccessible or not found", 127)
    if words == "-m":
        return print(f"{len(COUNTERS)} metrics supported:\n" + "\n".join(f"{k}\t{name}" for k, name in enumerate(COUNTERS, 1)))
    names = [list(COUNTERS)[int(k) - 1] for k in words[len("-r"):].strip('"').split(",")]
    while True:
        leave_if_unplugged()
        sys.stdout.buffer.write("".join(f"{name:<43}:   {COUNTERS[name]:.3f}\r\r\n" for name in names).encode() + b"\r\r\n")
        sys.stdout.flush()
        time.sleep(TICK_S)


def specs():
    return message(*((1, message((1, at), (2, name.encode()))) for at, name in enumerate(COUNTERS, 100)))


def perfetto(command):
    if PLAN["perfetto"] == "old":
        return print("perfetto: unknown option --query-raw")
    if "--query-raw" in command:
        source = message((1, b"gpu.counters.adreno"), (5, specs()))
        return print(base64.encodebytes(message((2, message((1, source), (2, 7))))).decode())
    if PLAN["perfetto"] == "refused":
        die("perfetto: Service error: the data source is in use")
    assert "counter_ids: 102 counter_ids: 103" in command and "--background" in command, command
    change(tracing=clock())
    print(777)


def trace():
    """A sample every 10 ms from the trace's beginning to its end, by a clock that began 1000 s ago."""
    begin, end = world()["tracing"], world()["traced"]
    boot_ns = 1_000_000_000_000
    clocks = message(*((1, message((1, at), (2, t))) for at, t in ((6, boot_ns), (1, int(begin * 1e9)))))
    counters = [(2, message((1, at), (3, value))) for at, value in enumerate(COUNTERS.values(), 100)]
    events = [message((1, message((8, boot_ns + k * 10_000_000), (52, message((1, specs()), *counters))))) for k in range(int((end - begin) * 100))]
    return message((1, message((6, clocks)))) + b"".join(events)


def pull(source, into):
    if source.endswith(".pftrace"):
        if PLAN.get("trace_lost"):
            die(f"adb: error: failed to stat remote object '{source}': Permission denied")
        with open(into, "wb") as out:
            out.write(trace()[:PLAN.get("trace_bytes", 1 << 30)])
        return
    if PLAN.get("pull_fails"):
        die(f"adb: error: cannot write '{into}': No space left on device")
    to = os.path.join(into, os.path.basename(source), *(["one"] if source.endswith("/runs") else []))
    # Raw files of a run that took place while the app was running.
    subprocess.run([PLAN["make_sample"], to, f"{world()['started']:.6f}"], check=True, stdout=subprocess.DEVNULL)
    print(f"{source}: 3 files pulled")


def shell(command):
    words = command.split()
    if "perfetto --" in command:
        perfetto(command) if PLAN.get("perfetto") else die("/system/bin/sh: perfetto: inaccessible or not found", 127)
    elif words[0] == "kill":
        change(traced=clock())
    elif words[0] == "rm":
        change(removed=words[-1])
    elif words[0] == "getprop":
        print({"ro.product.model": "Quest 3", "ro.build.display.id": "UP1A.231005.007.A1"}.get(words[1], world()["props"].get(words[1], "")))
    elif words[0] == "setprop":
        if words[1] in PLAN.get("refused_props", []):
            die(f"Failed to set property '{words[1]}' to '{words[2]}'.")
        change(props={**world()["props"], words[1]: words[2].strip("'")})
    elif words[0] == "date":
        print(f"{clock():.9f}")
    elif words[0] == "pm":
        print("package:/data/app/~~x==/org.clothbench.quest-y==/base.apk" if PLAN.get("installed", True) else "")
    elif words[0] == "pidof":
        print("4242" if running() else "")
    elif words[:2] == ["am", "start"]:
        if PLAN.get("start_fails"):
            return print("Starting: Intent { act=android.intent.action.MAIN }\nError type 3\nError: Activity class does not exist.")
        change(started=clock(), stopped=None, extra=command.split("--es args ")[1])
        print("Starting: Intent { act=android.intent.action.MAIN }\nStatus: ok\nComplete")
    elif words[:2] == ["am", "force-stop"]:
        change(stopped=clock() if world()["started"] else None)
    elif words[:2] == ["am", "broadcast"]:
        change(worn=command.endswith("prox_close"))
    else:
        die(f"/system/bin/sh: {words[0]}: inaccessible or not found", 127)


def hzdb(words):
    """Options and arguments: docs/hzdb.md in meta-quest/agentic-tools. Where it leaves the trace and how it names the process are guesses."""
    assert words[:3] == ["--device", "1WMHH000000000", "perf"], words
    if PLAN["hzdb"] == "refused":
        die("Error: no Perfetto on this device")
    if words[3] == "start":
        change(tracing=clock(), hzdb=words[words.index("--output") + 1])
        return print("PID        777\nOutput     " + world()["hzdb"])
    assert words[3:] == ["stop", "777", world()["hzdb"]], words
    change(traced=clock())
    if PLAN["hzdb"] != "lost":
        with open(world()["hzdb"] + ".pftrace", "wb") as out:
            out.write(trace())


def main():
    words = sys.argv[1:]
    if os.path.basename(sys.argv[0]) == "hzdb":
        return hzdb(words)
    with open(os.path.join(HOME, "calls.log"), "a", encoding="utf-8") as out:
        out.write(json.dumps(words) + "\n")
    if words[0] == "devices":
        return print("List of devices attached\n" + "\n".join(f"{serial}         {state} usb:1-2 product:eureka model:Quest_3 device:eureka transport_id:1"
                                                             for serial, state in PLAN.get("devices", [["1WMHH000000000", "device"]])))
    leave_if_unplugged()
    action, rest = words[2], words[3:]  # after -s SERIAL
    if action == "shell":
        profiler(rest[-1].split(None, 1)[1]) if "ovrgpuprofiler" in rest[-1] else shell(rest[-1])
    else:
        {"logcat": logcat, "pull": lambda w: pull(*w)}[action](rest)


if __name__ == "__main__":
    main()
